# SPDX-License-Identifier: MIT
"""Makes what is read beside the programs out of what they say about themselves, so that no option is listed twice.

usage: pages.py man TEMPLATE.scd PURSUIT PURSUITD     an scdoc page: @VERBS@ and @OPTIONS@ in the template are filled
       pages.py roff SCDOC PAGE.scd                   what scdoc makes of it, without what mandoc -Tlint complains of
       pages.py verb TEMPLATE.scd VERB PURSUIT PURSUITD   the page of a verb
       pages.py bash|zsh|fish PURSUIT PURSUITD        a completion script
       pages.py links PAGE.md HEADER                  a page of the top folder as it is installed, beside those of docs/;
                                                      HEADER: where pursuit.h is from there
"""
import re
import subprocess
import sys
import textwrap


def ask(program, *arguments):
    result = subprocess.run([program, *arguments], capture_output=True, text=True, check=True)
    return [line.split("\t") for line in result.stdout.splitlines()]


class Command:
    """A verb of pursuit, or pursuitd: `options` are (name, value, choices, help, range, default)."""

    def __init__(self, name, help_text, related, lines):
        self.name, self.help, self.related = name, help_text, related
        self.options = [line[1:7] for line in lines if line[0] == "option"]
        self.texts = {kind: [line[1] for line in lines if line[0] == kind]
                      for kind in ("usage", "summary", "status", "example")}

    def names(self):
        """Every way to write an option, with its choices and help: a flag that can be taken back has two."""
        for name, value, choices, text, _, _ in self.options:
            bare = name.replace("[no-]", "")
            yield "--" + bare, value, choices.split(",") if choices else [], text
            if bare != name:
                yield "--no-" + bare, "", [], text


def verbs_of(pursuit, only=None):
    return [Command(name, text, related.split(), ask(pursuit, name, "--print-options"))
            for name, text, related in ask(pursuit, "--print-verbs") if only in (None, name)]


def commands(pursuit, pursuitd):
    return verbs_of(pursuit), Command("pursuitd", "the daemon", [], ask(pursuitd, "--print-options"))


# ---- man pages ----


def escape(text):
    return re.sub(r"([\\*_`])", r"\\\1", text)


def man_option(option):
    name, value, choices, text, values, default = option
    lines = [f"*--{escape(name)}*" + (f" _{escape(value)}_" if value else "")]
    detail = [part for part in (values or choices.replace(",", ", "), f"default {default}" if default else "") if part]
    text = text[0].upper() + text[1:] if re.match(r"[a-z]+(?: |$)", text) else text
    text += "" if text.endswith(".") else "."
    lines.append("\t" + escape(text) + (f" ({escape('; '.join(detail))})" if detail else ""))
    return "\n".join(lines) + "\n"


SOCKET = """*PURSUIT_SOCKET*
	Path of the daemon's socket. Else _$XDG_RUNTIME_DIR/pursuit/socket_ and, where no daemon answers there, that of the
	machine, _/run/pursuit/socket_.
"""
NO_COLOR = """*NO_COLOR*
	Where it is set and not empty nothing is coloured; elsewhere only a terminal is.
"""


def man_line(verb):
    return f"*{escape(verb.name)}*\n\t{escape(verb.help[0].upper() + verb.help[1:])}. *pursuit-{escape(verb.name)}*(1)\n"


def fill(template, values):
    with open(template, encoding="utf-8") as file:
        text = file.read()
    return re.sub(r"@([A-Z]+)@", lambda found: values[found.group(1)], text)


def man(template, pursuit, pursuitd):
    verbs, daemon = commands(pursuit, pursuitd)
    return fill(template, {"OPTIONS": "\n".join(man_option(option) for option in daemon.options),
                           "VERBS": "\n".join(man_line(verb) for verb in verbs),
                           "SEE": ", ".join(f"*pursuit-{escape(verb.name)}*(1)" for verb in verbs)})


def man_verb(template, name, pursuit, _pursuitd):
    verb = verbs_of(pursuit, name)[0]
    has_socket = any(option[0] == "socket" for option in verb.options)
    pages = [f"pursuit-{other}" for other in verb.related]
    help_row = ("help", "", "", "show what this page says, shortly", "", "")
    return fill(template, {
        "PAGE": f"pursuit-{verb.name}",
        "VERB": escape(verb.name),
        "HELP": escape(verb.help),
        "USAGE": escape(" ".join(verb.texts["usage"])),
        "SUMMARY": escape(" ".join(verb.texts["summary"])),
        "OPTIONS": "\n".join(man_option(option) for option in [*verb.options, help_row]),
        "EXAMPLES": "\n".join(line.removeprefix("  ") for line in verb.texts["example"]),
        "STATUS": escape(" ".join(verb.texts["status"])),
        "ENVIRONMENT": (SOCKET if has_socket else "") + NO_COLOR,
        "SEE": ", ".join(f"*{escape(page)}*(1)" for page in ["pursuit", *pages, "pursuitd"]),
    })


def roff(scdoc, page):
    """Empty paragraphs go, lines that are read anew are short, and the title is as titles of pages are."""
    with open(page, encoding="utf-8") as source:
        made = subprocess.run([scdoc], stdin=source, capture_output=True, text=True, check=True).stdout.splitlines()
    lines, as_written = [], False
    for line in (line.rstrip() for line in made):
        as_written = line == ".nf" or (as_written and line != ".fi")
        if not as_written and line.startswith((".SH", ".SS", ".RE", ".P")):
            while lines and lines[-1] == ".P":
                lines.pop()
        if line == ".P" and lines and lines[-1].startswith((".SH", ".SS", ".TH")):
            continue
        if line.startswith(".TH"):
            line = line.split('"')
            line[1] = line[1].upper()
            line = '"'.join(line)
        whole = as_written or line.startswith(".")
        # a line must not begin with what roff takes for a command
        lines += [line] if whole else textwrap.wrap(re.sub(r" (?=[.'])", "\0", line), 78, break_long_words=False,
                                                    break_on_hyphens=False) or [line]
    return "\n".join(line.replace("\0", " ") for line in lines) + "\n"


def links(page, header):
    """In the tree the pages lie in docs/ and examples in client/; installed, all of them lie in one folder."""
    with open(page, encoding="utf-8") as source:
        text = source.read()
    for here, there in (("docs/", ""), ("client/examples", "examples"), ("client/pursuit.h", header)):
        text = text.replace("](" + here, "](" + there)
    return text


# ---- completions ----


def settings_of(daemon):
    """Name, values where they are a list, and help of each setting."""
    for name, _, choices, text, _, _ in daemon.options:
        bare = name.replace("[no-]", "")
        yield bare, ["yes", "no"] if bare != name else choices.split(",") if choices else [], text


def subcommands_of(verb):
    """The first words of a usage like "[list | show NAME]"."""
    usage = " ".join(verb.texts["usage"])
    return re.findall(r"(?:^\[|\| )([a-z-]+)", usage) if usage.startswith("[") and " | " in usage else []


def bash_settings(daemon):
    """A function that completes NAME=VALUE; the shell has made three words of that."""
    names = " ".join(name for name, _, _ in settings_of(daemon))
    cases = "\n".join(f"\t\t{name}) COMPREPLY=($(compgen -W '{' '.join(values)}' -- \"$word\")) ;;"
                      for name, values, _ in settings_of(daemon) if values)
    return (f"_pursuit_names='{names}'\n_pursuit_setting() {{\n"
            "\tlocal word=$1 name=\n"
            "\tif [[ $word == = ]]; then name=$2 word=; elif [[ $2 == = ]]; then name=${COMP_WORDS[COMP_CWORD-2]}; fi\n"
            "\tif [[ -z $name ]]; then\n\t\tcompopt -o nospace 2>/dev/null\n"
            "\t\tCOMPREPLY=($(compgen -S = -W \"$_pursuit_names\" -- \"$word\"))\n\t\treturn\n\tfi\n"
            f"\tcase $name in\n{cases}\n\t\t*) COMPREPLY=($(compgen -f -- \"$word\")) ;;\n\tesac\n}}")


def bash_words(command):
    """What completes a word that is no option."""
    if command.name == "get":
        return 'COMPREPLY=($(compgen -W "$_pursuit_names" -- "$word"))'
    if command.name == "set":
        return '_pursuit_setting "$word" "$last"'
    if subcommands_of(command):
        names = " ".join(subcommands_of(command))
        return (f"if [[ $COMP_CWORD == 2 ]]; then COMPREPLY=($(compgen -W '{names}' -- \"$word\")); "
                "elif [[ $COMP_CWORD -gt 3 && ${COMP_WORDS[2]} == *set ]]; then _pursuit_setting \"$word\" \"$last\"; fi")
    return 'COMPREPLY=($(compgen -f -- "$word"))'


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
                f"else {bash_words(command)}; fi\n")

    out = ["# bash completion of pursuit and pursuitd; made from their own option tables", bash_settings(daemon)]
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


def zsh_settings(daemon):
    names = " ".join(name for name, _, _ in settings_of(daemon))
    cases = "\n".join(f"\t\t{name}) compadd -- {' '.join(values)} ;;" for name, values, _ in settings_of(daemon) if values)
    return (f"_pursuit_setting() {{\n\tlocal -a names=({names})\n"
            "\tif ! compset -P '*='; then\n\t\tcompadd -S = -- $names\n\t\treturn\n\tfi\n"
            f"\tcase ${{IPREFIX%=}} in\n{cases}\n\t\t*) _files ;;\n\tesac\n}}")


def zsh_words(command, daemon):
    if command.name == "get":
        return [quote(f"*:setting:({' '.join(name for name, _, _ in settings_of(daemon))})")]
    if command.name == "set":
        return [quote("*:setting:_pursuit_setting")]
    if subcommands_of(command):
        return [quote(f"1:what:({' '.join(subcommands_of(command))})"), quote("2:application: "),
                quote("*:setting:_pursuit_setting")]
    return [quote("*:file:_files")]


def zsh(verbs, daemon):
    def arguments(command):
        lines = []
        for name, value, choices, text in command.names():
            text = re.sub(r"[][:\\]", r"\\\g<0>", text)
            action = f":{value}:({' '.join(choices)})" if choices else f":{value}:_files" if value else ""
            lines.append(quote(f"{name}[{text}]{action}"))
        return " \\\n\t\t".join(["_arguments", *lines, "'--help[show help]'", *zsh_words(command, daemon)])

    out = ["#compdef pursuit pursuitd", "# made from their own option tables", zsh_settings(daemon)]
    described = " ".join(quote(f"{verb.name}:{verb.help}") for verb in verbs)
    out.append("if [[ $service == pursuitd ]]; then\n\t" + arguments(daemon) + "\n\treturn\nfi")
    out.append(f"if (( CURRENT == 2 )); then\n\tlocal -a verbs=({described})\n\t_describe verb verbs\n\treturn\nfi")
    out.append("local verb=$words[2]\nshift words\n(( CURRENT-- ))\ncase $verb in")
    out += [f"\t{verb.name})\n\t\t{arguments(verb)} ;;" for verb in verbs]
    out.append("esac")
    return "\n".join(out) + "\n"


def fish_words(verb, daemon):
    """Settings with their values, and what a verb can do."""
    seen = f"complete -c pursuit -n '__fish_seen_subcommand_from {verb.name}"
    if verb.name == "get":
        return [f"{seen}' -f -a {name} -d {quote(text)}" for name, _, text in settings_of(daemon)]
    if verb.name == "set":  # of profile, too
        return [f"{seen}' -f -a {quote(word)} -d {quote(text)}" for name, values, text in settings_of(daemon)
                for word in [name + "=" + value for value in values] or [name + "="]]
    names = " ".join(subcommands_of(verb))
    return [f"{seen}; and not __fish_seen_subcommand_from {names}' -f -a {quote(names)}"] if names else []


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
    for verb in verbs:
        out += fish_words(verb, daemon)
    return "\n".join(out) + "\n"


def main():
    kind, programs = sys.argv[1], sys.argv[-2:]
    if kind == "roff":
        sys.stdout.write(roff(sys.argv[2], sys.argv[3]))
        return
    if kind == "links":
        sys.stdout.write(links(sys.argv[2], sys.argv[3]))
    elif kind == "man":
        sys.stdout.write(man(sys.argv[2], *programs))
    elif kind == "verb":
        sys.stdout.write(man_verb(sys.argv[2], sys.argv[3], *programs))
    else:
        sys.stdout.write({"bash": bash, "zsh": zsh, "fish": fish}[kind](*commands(*programs)))


if __name__ == "__main__":
    main()
