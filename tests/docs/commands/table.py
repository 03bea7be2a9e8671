"""tests/docs/commands.toml: which commands of the documentation are run otherwise than they stand there, and why."""

import fnmatch
import re
import tomllib

from . import markdown

PAGE_KEYS = {"name", "before", "link"}
ROW_KEYS = {"page", "match", "add", "instead", "only_parsed", "always", "compare", "exit_code", "tests", "why"}


class Row:
    """One row: the commands that `match` (a regular expression for all of a command without its comment) finds on the pages `page`.

    add          flags that it gets, in the place of the same ones if it has any
    instead      what is run in its place (\\1: the first group of `match`)
    only_parsed  it is not run: it can be read, and the program has its subcommand and flags
    always       the same in the full mode, in which commands otherwise run as they stand
    compare      false: what it prints then is another text than the page's (else it is the same but for numbers)
    exit_code    what it ends with, if not 0
    tests        ctest's names of tests that run it or its like"""

    def __init__(self, values, number):
        self.place = f"commands.toml, row {number} ({values.get('match')})"
        unknown = values.keys() - ROW_KEYS
        if unknown or "match" not in values:
            raise markdown.Failure(f"{self.place}: {', '.join(unknown) or 'no match'}; known: {', '.join(sorted(ROW_KEYS))}")
        kinds = [key for key in ("add", "instead", "only_parsed") if key in values]
        if len(kinds) > 1 or (not kinds and "exit_code" not in values):
            raise markdown.Failure(f"{self.place}: it needs one of add, instead, only_parsed, or exit_code")
        if kinds and not values.get("why"):
            raise markdown.Failure(f"{self.place}: why is the command not run as it stands?")
        self.pages = values.get("page", "*")
        self.pattern = re.compile(values["match"], re.S)
        self.add = values.get("add")
        self.instead = values.get("instead")
        self.only_parsed = values.get("only_parsed", False)
        self.always = values.get("always", False)
        self.compare = values.get("compare", True)
        self.exit_code = values.get("exit_code", 0)
        self.tests = values.get("tests", [])
        self.used = False

    def find(self, page, command):
        return self.pattern.fullmatch(command) if fnmatch.fnmatch(page, self.pages) else None

    def changes(self):
        return self.only_parsed or self.add is not None or self.instead is not None


class Table:
    def __init__(self, path):
        values = tomllib.loads(path.read_text())
        self.rows = [Row(row, number) for number, row in enumerate(values.pop("command", []), 1)]
        self.pages = {}
        for page in values.pop("page", []):
            if page.keys() - PAGE_KEYS or "name" not in page:
                raise markdown.Failure(f"commands.toml: a page has {', '.join(sorted(PAGE_KEYS))}, not {', '.join(page)}")
            self.pages[page["name"]] = page
        if values:
            raise markdown.Failure(f"commands.toml: unknown tables {', '.join(values)}")

    def find(self, page, command):
        """The first row for a command, or None: it is run as it stands."""
        for row in self.rows:
            if row.find(page, command):
                row.used = True
                return row
        return None

    def before(self, page):
        """What a reader of this page has done already: commands."""
        return self.pages.get(page, {}).get("before", [])

    def links(self, page):
        """What of the repository its commands need where they run, as in a clone of it."""
        return self.pages.get(page, {}).get("link", [])


def apply_row(row, page, command, full):
    """What is run for a command, None if nothing is."""
    if row is None or (full and not row.always):
        return command
    if row.only_parsed:
        return None
    plain = markdown.strip_comment(command)
    if row.instead is not None:
        return row.find(page, plain).expand(row.instead)
    return plain if row.add is None else add_flags(plain, row.add)


def add_flags(command, flags):
    """A command with these flags (--name value, or --set key=value) instead of those of the same name that it has."""
    for name, value in re.findall(r"(--[a-z-]+) (\S+)", flags):
        key = re.escape(value.split("=")[0] + "=") if name == "--set" else ""
        command = re.sub(rf" {name} {key}\S+", "", command)
    return f"{command} {flags}"
