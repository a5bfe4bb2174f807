#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: 2026 The Pursuit authors
"""Turns text files into C strings, or writes what a renderer would get of a shader, for validation.

embed.py c OUT.c LIMITS FILE...            one array shader_NAME_STAGE[] a file, and shader_limits[]
embed.py glsl OUT VERSION LIMITS FILE DEFINE...  the whole text of one variant
embed.py text OUT.c HEADER FILE...         one array NAME_ENDING[] a file, declared in HEADER
"""
import os
import sys

PRECISION = "precision highp float;\nprecision highp int;\nprecision highp sampler2D;\nprecision highp usampler2D;\n"


def read(path):
    """The text of a file, with #include "x" replaced by the text of x; line numbers are not kept."""
    lines = []
    for line in open(path, encoding="utf-8"):
        if line.startswith("#include"):
            lines.append(read(os.path.join(os.path.dirname(path), line.split('"')[1])))
        else:
            lines.append(line)
    return "".join(lines)


def literal(text):
    rows = text.replace("\\", "\\\\").replace('"', '\\"').split("\n")
    return "\n".join(f'\t"{row}\\n"' for row in rows if row.strip())


def write_c(out, limits, files):
    with open(out, "w", encoding="utf-8") as c:
        c.write("/* SPDX-License-Identifier: MIT */\n/* Made by shaders/embed.py. */\n")
        c.write('#include "shaders/shaders.h"\n')
        for name, path in [("limits", limits)] + [(os.path.basename(f).replace(".", "_"), f) for f in files]:
            c.write(f"\nconst char shader_{name}[] =\n{literal(read(path))};\n")


def write_text(out, header, files):
    with open(out, "w", encoding="utf-8") as c:
        c.write("/* SPDX-License-Identifier: MIT */\n/* Made by shaders/embed.py. */\n")
        c.write(f'#include "{header}"\n')
        for path in files:
            name = os.path.basename(path).replace(".", "_")
            with open(path, encoding="utf-8") as text:
                c.write(f"\nconst char {name}[] =\n{literal(text.read())};\n")


def write_glsl(out, version, limits, path, defines):
    with open(out, "w", encoding="utf-8") as glsl:
        glsl.write(f"#version {version}\n")
        if version.endswith("es"):
            glsl.write(PRECISION)
        glsl.write("".join(f"#define {define}\n" for define in defines if define))
        glsl.write(read(limits) + read(path))


if sys.argv[1] == "c":
    write_c(sys.argv[2], sys.argv[3], sys.argv[4:])
elif sys.argv[1] == "text":
    write_text(sys.argv[2], sys.argv[3], sys.argv[4:])
else:
    write_glsl(sys.argv[2], sys.argv[3], sys.argv[4], sys.argv[5], sys.argv[6:])
