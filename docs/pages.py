# SPDX-License-Identifier: MIT
"""Makes what is read beside the programs out of what they say about themselves, so that no option is listed twice.

usage: pages.py man TEMPLATE.scd PURSUIT PURSUITD     an scdoc page: @VERBS@ and @OPTIONS@ in the template are filled
       pages.py bash|zsh|fish PURSUIT PURSUITD        a completion script
"""
import re
import subprocess
import sys


def ask(program, *arguments):
    result = subprocess.run([program, *arguments], capture_output=True, text=True, check=True)
    return [line.split("\t") for line in result.stdout.splitlines()]


class Command:
    """A verb of pursuit, or pursuitd: `options` are (name, value, choices, help, range, default)."""

    def __init__(self, name, help_text, lines):
        self.name, self.help = name, help_text
        self.options = [line[1:7] for line in lines if line[0] == "option"]
        self.texts = {kind: [line[1] for line in lines if line[0] == kind] for kind in ("usage", "summary", "example")}

    def names(self):
        """Every way to write an option, with its choices and help: a flag that can be taken back has two."""
        for name, value, choices, text, _, _ in self.options:
            bare = name.replace("[no-]", "")
            yield "--" + bare, value, choices.split(",") if choices else [], text
            if bare != name:
                yield "--no-" + bare, "", [], text


def commands(pursuit, pursuitd):
    verbs = [Command(name, text, ask(pursuit, name, "--print-options")) for name, text in ask(pursuit, "--print-verbs")]
    return verbs, Command("pursuitd", "the daemon", ask(pursuitd, "--print-options"))


# ---- man pages ----


def escape(text):
    return re.sub(r"([\\*_`])", r"\\\1", text)


def man_option(option):
    name, value, choices, text, values, default = option
    lines = [f"*--{escape(name)}*" + (f" _{escape(value)}_" if value else "")]
    detail = [part for part in (values or choices.replace(",", ", "), f"default {default}" if default else "") if part]
    text = text[0].upper() + text[1:] if text else ""
    text += "" if text.endswith(".") else "."
    lines.append("\t" + escape(text) + (f" ({escape('; '.join(detail))})" if detail else ""))
    return "\n".join(lines) + "\n"


def man_verb(verb):
    parts = [f"## pursuit {escape(verb.name)} {escape(' '.join(verb.texts['usage']))}", "",
             escape(" ".join(verb.texts["summary"])), ""]
    parts += [man_option(option) for option in verb.options]
    if verb.texts["example"]:
        parts += ["Examples:", "", "```", *verb.texts["example"], "```", ""]
    return "\n".join(parts)


def man(template, pursuit, pursuitd):
    verbs, daemon = commands(pursuit, pursuitd)
    with open(template, encoding="utf-8") as file:
        text = file.read()
    text = text.replace("@OPTIONS@", "\n".join(man_option(option) for option in daemon.options))
    return text.replace("@VERBS@", "\n".join(man_verb(verb) for verb in verbs))


# ---- completions ----


def bash(verbs, daemon):
    def cases(command):
        lines = []
        for name, _, choices, _ in command.names():
            if choices:
                lines.append(f"\t\t{name}) COMPREPLY=($(compgen -W '{' '.join(choices)}' -- \"$word\")); return ;;")
        return "\n".join(lines)

    def body(command):
        names = " ".join(name for name, _, _, _ in command.names()) + " --help"
        return (f"\tcase \"$last\" in\n{cases(command)}\n\t\t*) ;;\n\tesac\n"
                f"\tif [[ $word == -* ]]; then COMPREPLY=($(compgen -W '{names}' -- \"$word\")); "
                "else COMPREPLY=($(compgen -f -- \"$word\")); fi\n")

    out = ["# bash completion of pursuit and pursuitd; made from their own option tables"]
    for command in [*verbs, daemon]:
        out.append(f"_pursuit_{command.name.replace('-', '_')}() {{\n\tlocal word=$1 last=$2\n{body(command)}}}")
    names = " ".join(verb.name for verb in verbs)
    known = "|".join(verb.name for verb in verbs)
    out.append("_pursuit() {\n\tlocal word=${COMP_WORDS[COMP_CWORD]} last=${COMP_WORDS[COMP_CWORD-1]}\n"
               f"\tif [[ $COMP_CWORD == 1 ]]; then COMPREPLY=($(compgen -W '{names} --help --version' -- \"$word\")); return; fi\n"
               f"\tcase ${{COMP_WORDS[1]}} in\n\t\t{known}) _pursuit_${{COMP_WORDS[1]//-/_}} \"$word\" \"$last\" ;;\n\tesac\n}}")
    out.append("_pursuitd() {\n\t_pursuit_pursuitd \"${COMP_WORDS[COMP_CWORD]}\" \"${COMP_WORDS[COMP_CWORD-1]}\"\n}")
    out.append("complete -o filenames -F _pursuit pursuit\ncomplete -o filenames -F _pursuitd pursuitd")
    return "\n".join(out) + "\n"


def quote(text):
    return "'" + text.replace("'", "'\\''") + "'"


def zsh(verbs, daemon):
    def arguments(command):
        lines = []
        for name, value, choices, text in command.names():
            text = re.sub(r"[][:\\]", r"\\\g<0>", text)
            action = f":{value}:({' '.join(choices)})" if choices else f":{value}:_files" if value else ""
            lines.append(quote(f"{name}[{text}]{action}"))
        return " \\\n\t\t".join(["_arguments", *lines, "'--help[show help]'", "'*:file:_files'"])

    out = ["#compdef pursuit pursuitd", "# made from their own option tables"]
    described = " ".join(quote(f"{verb.name}:{verb.help}") for verb in verbs)
    out.append("if [[ $service == pursuitd ]]; then\n\t" + arguments(daemon) + "\n\treturn\nfi")
    out.append(f"if (( CURRENT == 2 )); then\n\tlocal -a verbs=({described})\n\t_describe verb verbs\n\treturn\nfi")
    out.append("local verb=$words[2]\nshift words\n(( CURRENT-- ))\ncase $verb in")
    out += [f"\t{verb.name})\n\t\t{arguments(verb)} ;;" for verb in verbs]
    out.append("esac")
    return "\n".join(out) + "\n"


def fish(verbs, daemon):
    out = ["# fish completion of pursuit and pursuitd; made from their own option tables",
           "complete -c pursuit -n __fish_use_subcommand -f"]
    for verb in verbs:
        out.append(f"complete -c pursuit -n __fish_use_subcommand -a {verb.name} -d {quote(verb.help)}")
    for command, condition in [*((verb, f"-c pursuit -n '__fish_seen_subcommand_from {verb.name}'") for verb in verbs),
                               (daemon, "-c pursuitd")]:
        for name, value, choices, text in command.names():
            takes = f" -x -a {quote(' '.join(choices))}" if choices else " -r" if value else ""
            out.append(f"complete {condition} -l {name[2:]}{takes} -d {quote(text)}")
    return "\n".join(out) + "\n"


def main():
    kind, programs = sys.argv[1], sys.argv[-2:]
    if kind == "man":
        sys.stdout.write(man(sys.argv[2], *programs))
    else:
        sys.stdout.write({"bash": bash, "zsh": zsh, "fish": fish}[kind](*commands(*programs)))


if __name__ == "__main__":
    main()
