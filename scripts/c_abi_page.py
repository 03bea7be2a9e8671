#!/usr/bin/env python3
"""Writes the reference page of the C interface of plugins, in Markdown, to standard output. The page has every declaration of
include/armwright/plugin.h with its comment. scripts/docs calls this script."""
import pathlib
import re
import sys

HEADER = pathlib.Path(__file__).resolve().parent.parent / "include" / "armwright" / "plugin.h"

# A comment. The declaration after it ends at the next blank line outside braces.
COMMENT = re.compile(r"/\*(.*?)\*/\n", re.S)


def read_comment(text):
    """Returns the text of a comment. Lines that are indented by four blanks stay a block of code."""
    lines = [re.sub(r"^\s*\* ?", "", line).rstrip() for line in text.split("\n")]
    return "\n".join(line.lstrip() if not line.startswith("    ") else line for line in lines).strip()


def split_declarations(code):
    """Returns (comment, declaration) for each top-level comment that has a declaration after it."""
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
    if match := re.match(r"static inline \w+ (\w+)\(", declaration):
        return f"`{match.group(1)}()`"
    if declaration.startswith("enum"):
        names = re.findall(r"\bARMWRIGHT_\w+(?= =)", declaration)
        return f"`{names[0]}` to `{names[-1]}`"
    return f"`{re.search(r'#define (ARMWRIGHT_[A-Z_]+)', declaration).group(1)}`"


def make_page(header):
    introduction, rest = header.split("#ifndef ARMWRIGHT_PLUGIN_H", 1)
    rest = re.sub(r'#ifdef __cplusplus\n(extern "C" \{|\})\n#endif\n', "", rest)
    rest = re.sub(r"#if defined\(__cplusplus\).*\n(#pragma.*\n)+#endif\n", "", rest)  # instructions for compilers
    version = re.search(r"#define ARMWRIGHT_PLUGIN_ABI (\d+)u", rest).group(1)
    text = (
        "<!-- Written by scripts/docs from include/armwright/plugin.h: change that, not this file. -->\n"
        f"# The C interface of plugins, version {version}\n\n"
        f"{read_comment(introduction.strip()[2:-2])}\n\n"
        "The header is `armwright/plugin.h`. [Plugins](../plugins.md) explains how to write a plugin from the beginning, and `plugins/hooke_jeeves` "
        "is a complete plugin in C. [The plugin protocol](../plugin-protocol.md) is the corresponding interface for plugins that are programs.\n"
    )
    for comment, declaration in split_declarations(rest):
        if not declaration.strip():
            continue
        text += f"\n## {make_title(declaration)}\n\n{comment}\n\n```c header\n{declaration}\n```\n"
    return text


if __name__ == "__main__":
    sys.stdout.write(make_page(HEADER.read_text(encoding="utf-8")))
