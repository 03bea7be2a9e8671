"""What a page of the documentation holds to be tried: its code blocks, and the commands in them.

The convention (docs/contributing.md has it for authors):

    ```console            a session: `$ command`, and below it what the command prints
    ```sh                 commands alone
    ```toml NAME.toml     a file that the page makes (any language): it is there for the commands below it
    ```toml problem=q1    a part of a problem's file, which begins where q1 ends; `study`: of a study's plan
    ```text               anything else

In what a command prints, a line `...` stands for any number of lines and ... within a line for any characters."""

import dataclasses
import re
import subprocess

LANGUAGES = ("console", "sh", "toml", "text", "cpp", "c", "python", "pycon", "json", "cmake", "xml", "csv", "yaml")
# What commands of the documentation begin with; in pages that scripts write they stand indented, without a language.
PROGRAMS = re.compile(r"(armwright|mpirun\S*|cmake|scripts/\w+|build/release/bin/\w+) ?")


class Failure(Exception):
    """What is wrong with a page or the table of commands."""


@dataclasses.dataclass
class Block:
    line: int  # of its first line of text, from 1
    language: str
    argument: str  # what stands behind the language
    text: str


@dataclasses.dataclass
class Command:
    line: int
    text: str  # as bash reads it; may be of several lines
    output: str | None  # what the page shows; None: nothing is said of it


def read_blocks(name, text):
    """The code blocks of a page in order. Indented ones hold commands in pages that scripts write, which say so at their top."""
    written_by_script = text.startswith("<!-- Written by ")
    lines = text.split("\n")
    blocks = []
    index = 0
    while index < len(lines):
        fence = re.match(r"( *)```+(\S*) *(.*?)\s*$", lines[index])
        if fence:
            end = next((i for i in range(index + 1, len(lines)) if lines[i].strip() == "```"), None)
            if end is None:
                raise Failure(f"{name}:{index + 1}: this code block has no end")
            blocks.append(make_block(name, index + 2, fence[2], fence[3], lines[index + 1:end], len(fence[1])))
            index = end + 1
            continue
        if lines[index].startswith("    ") and (index == 0 or not lines[index - 1].strip()):
            end = index
            while end < len(lines) and (lines[end].startswith("    ") or not lines[end].strip()):
                end += 1
            language = "sh" if PROGRAMS.match(lines[index].strip()) else "text"
            if not written_by_script:
                raise Failure(f"{name}:{index + 1}: a code block by indentation; write ```{language} instead")
            blocks.append(make_block(name, index + 1, language, "", lines[index:end], 4))
            index = end
            continue
        index += 1
    return blocks


def make_block(name, line, language, argument, lines, indent):
    if language not in LANGUAGES:
        raise Failure(f"{name}:{line - 1}: a code block in '{language}'; it has to be one of {', '.join(LANGUAGES)}")
    return Block(line, language, argument, "\n".join(text[indent:] for text in lines).rstrip() + "\n")


def is_complete(text):
    """Whether bash has all of a command: no quote, loop, pipe or document is open."""
    if text.rstrip("\n").endswith("\\"):
        return False
    found = subprocess.run(["bash", "-n"], input=text, capture_output=True, text=True, check=False)
    return found.returncode == 0 and "here-document" not in found.stderr


def split_commands(name, block):
    """The commands of a block, with what they print in sessions."""
    commands = []
    lines = block.text.rstrip("\n").split("\n")
    index = 0
    while index < len(lines):
        line = block.line + index
        if not lines[index].strip() or lines[index].lstrip().startswith("#"):
            index += 1
            continue
        if block.language == "console" and not lines[index].startswith("$ "):
            raise Failure(f"{name}:{line}: a session begins with '$ '")
        text = lines[index].removeprefix("$ ") if block.language == "console" else lines[index]
        index += 1
        while not is_complete(text + "\n"):
            if index == len(lines):
                raise Failure(f"{name}:{line}: bash cannot read this command: {text}")
            text += "\n" + lines[index].removeprefix("> " if block.language == "console" else "")
            index += 1
        output = None
        if block.language == "console":
            begin = index
            while index < len(lines) and not lines[index].startswith("$ "):
                index += 1
            output = "\n".join(lines[begin:index]).strip("\n") if any(map(str.strip, lines[begin:index])) else None
        commands.append(Command(line, text, output))
    return commands


def strip_comment(text):
    """A command without its comment and its line breaks, as the table has it."""
    lines = [re.sub(r"(^|\s)#\s.*$", "", line) for line in text.replace("\\\n", " ").split("\n")]
    return re.sub(r" +", " ", "\n".join(line.rstrip() for line in lines)).strip()


def loosen(text):
    """A text without its numbers and its layout, for commands that are run with fewer simulations than the page's."""
    numbers = re.sub(r"(?<![A-Za-z_\d])-?\d[\d.]*(?:[eE][-+]?\d+)?|(?<= )(?:-|inf)(?= |$)", "0", text, flags=re.M)
    return re.sub(r"[ \t]+", " ", numbers)


def make_pattern(line):
    return ".*?".join(re.escape(part) for part in line.rstrip().split("..."))


def find_difference(shown, printed):
    """None if a command prints what the page shows; else the first line of the page that it does not print, and what stands there instead.

    Lines are compared without blanks at their ends, empty lines only where the page has them."""
    wanted, got = shown.split("\n"), [line.rstrip() for line in printed.strip("\n").split("\n")]
    position, anywhere = 0, False
    for line in wanted:
        if line.strip() == "...":
            anywhere = True
            continue
        pattern = make_pattern(line)
        places = range(position, len(got)) if anywhere else range(position, min(position + 1, len(got)))
        found = next((place for place in places if re.fullmatch(pattern, got[place])), None)
        if found is None:
            there = got[position] if position < len(got) else "(the end)"
            return f"the page shows\n    {line}\nand the command prints\n    {there}"
        position, anywhere = found + 1, False
    if position < len(got) and not anywhere and any(got[position:]):
        return f"the command goes on where the page's output ends:\n    {got[position]}"
    return None
