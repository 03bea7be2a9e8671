#!/usr/bin/env python3
"""Writes the reference of the C interface of plugins, in Markdown, from the header that plugins are built against: every declaration of
include/armwright/plugin.h with what the header says of it. scripts/docs calls it."""
import pathlib
import re
import sys

HEADER = pathlib.Path(__file__).resolve().parent.parent / "include" / "armwright" / "plugin.h"

# A comment, and the declaration behind it up to the next blank line outside braces.
COMMENT = re.compile(r"/\*(.*?)\*/\n", re.S)


def read_comment(text):
    """The prose of a comment; what is indented in it by four blanks stays a block of code."""
    lines = [re.sub(r"^\s*\* ?", "", line).rstrip() for line in text.split("\n")]
    return "\n".join(line.lstrip() if not line.startswith("    ") else line for line in lines).strip()


def split_declarations(code):
    """(comment, declaration) for each top-level comment that has a declaration behind it."""
    parts = []
    position = 0
    while match := COMMENT.search(code, position):
        end = match.end()
        depth = 0
        lines = []
        for line in code[end:].split("\n"):
            if not line.strip() and depth == 0:
                break
            depth += line.count("{") - line.count("}")
            lines.append(line)
        declaration = "\n".join(lines)
        parts.append((read_comment(match.group(1)), declaration))
        position = end + len(declaration)
    return parts


def make_title(declaration):
    if match := re.match(r"struct (\w+)", declaration):
        return f"`struct {match.group(1)}`"
    if declaration.startswith("enum"):
        names = re.findall(r"\bARMWRIGHT_\w+(?= =)", declaration)
        return f"`{names[0]}` to `{names[-1]}`"
    return f"`{re.search(r'#define (ARMWRIGHT_[A-Z_]+)', declaration).group(1)}`"


def make_page(header):
    introduction, rest = header.split("#ifndef ARMWRIGHT_PLUGIN_H", 1)
    rest = re.sub(r'#ifdef __cplusplus\n(extern "C" \{|\})\n#endif\n', "", rest)
    rest = re.sub(r"#if defined\(__cplusplus\).*\n(#pragma.*\n)+#endif\n", "", rest)  # how compilers are to take it
    version = re.search(r"#define ARMWRIGHT_PLUGIN_ABI (\d+)u", rest).group(1)
    text = (
        "<!-- Written by scripts/docs from include/armwright/plugin.h: change that, not this file. -->\n"
        f"# The C interface of plugins, version {version}\n\n"
        f"{read_comment(introduction.strip()[2:-2])}\n\n"
        "The header is `armwright/plugin.h`; [plugins](../plugins.md) begins from nothing, and `plugins/hooke_jeeves` is a complete "
        "one in C. The same for programs of their own is [the plugin protocol](../plugin-protocol.md).\n"
    )
    for comment, declaration in split_declarations(rest):
        if not declaration.strip():
            continue
        text += f"\n## {make_title(declaration)}\n\n{comment}\n\n```c header\n{declaration}\n```\n"
    return text


if __name__ == "__main__":
    sys.stdout.write(make_page(HEADER.read_text(encoding="utf-8")))
