#!/usr/bin/python3
"""The documentation does what it says: every command of README.md and docs is run, and prints what stands below it.

    commands_test.py PAGE...       runs the commands of these pages, one after the other, each page in a folder of its own
    commands_test.py --table       no command is left out but by tests/docs/commands.toml, no row of that is for nothing, and the
                                   program has the commands and flags that the pages name (--tests FOLDER: and ctest, run
                                   there, the tests that the table names)
    commands_test.py --pages       lists the pages
    --full                         (or ARMWRIGHT_DOCS_FULL=1) runs commands as they stand, however dear: hours
    --times                        prints what each took
    --keep FOLDER                  works there, and leaves it

$ARMWRIGHT names another program than build/release/bin/armwright."""

import argparse
import os
import pathlib
import re
import sys
import tempfile
import time

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import reliability_test  # noqa: E402
from commands import markdown, session, table  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[2]
TABLE = pathlib.Path(__file__).resolve().with_name("commands.toml")


def list_pages():
    """README.md and docs, relative to the repository; templates are no pages."""
    pages = [path for path in sorted((ROOT / "docs").rglob("*.md")) if not path.name.endswith(".template.md")]
    return ["README.md"] + [str(path.relative_to(ROOT)) for path in pages]


def list_commands(page, blocks):
    return [command for block in blocks if block.language in ("console", "sh") for command in markdown.split_commands(page, block)]


def is_first_page(page):
    """README.md and the tutorials: what new users type."""
    return page == "README.md" or page.startswith("docs/tutorials/")


def try_command(command, row, page, run, program, full):
    """What is wrong with a command; None if nothing is."""
    fault = program.find_fault(command.text)
    if fault:
        return fault
    run_text = table.apply_row(row, page, command.text, full)
    if run_text is None:
        return None
    outcome = run.run(run_text)
    expected = row.exit_code if row else 0
    as_it_stands = row is None or not row.changes() or (full and not row.always)
    # Few simulations may find nothing good, and many of a long run may not either: that is no fault of a page that shows no result.
    may_find_nothing = not as_it_stands or (full and command.output is None)
    if is_first_page(page) and command.text.startswith("armwright optimize"):
        may_find_nothing = False  # a beginner's run ends with a design that fails no test case and beats the start
    if command.output and "armwright: error:" in command.output and outcome.code in (2, 4, 5):
        expected = outcome.code  # it is refused, as the page says
    if outcome.code != expected and not (may_find_nothing and outcome.is_good()):
        return f"ended with exit code {outcome.code}, not {expected}; it printed\n{outcome.output}{outcome.errors}"
    if command.output is None or (row is not None and not row.compare and not as_it_stands):
        return None
    # Progress and messages go to standard error; a page that shows one of these shows them all.
    printed = outcome.errors + outcome.output if re.search(r"^armwright: ", command.output, re.M) else outcome.output
    shown = command.output
    if not as_it_stands or not session.has_avx2():
        shown, printed = markdown.loosen(shown), markdown.loosen(printed)
    difference = markdown.find_difference(shown, printed)
    return difference and f"{difference}\nof all that it prints:\n{printed}"


def try_page(page, rows, program, full=False, keep=None, say=lambda text: None):
    """What is wrong with a page: texts."""
    blocks = markdown.read_blocks(page, (ROOT / page).read_text())
    faults = []
    with tempfile.TemporaryDirectory(prefix="armwright-docs-") as folder:
        run = session.Session((keep or pathlib.Path(folder)) / page.replace("/", "-"), program.path, ROOT, full)
        for path in rows.links(page):
            run.link(path)
        for command in rows.before(page):
            row = rows.find(page, command)
            begin = time.monotonic()
            outcome = run.run(table.apply_row(row, page, command, full))
            say(f"{time.monotonic() - begin:7.2f} s  {page}: before: {command[:90]}")
            if not outcome.is_good():
                return [f"{page}: what goes before it, '{command}', ended with exit code {outcome.code}:\n{outcome.errors}"]
        for block in blocks:
            if block.language not in ("console", "sh"):
                begin = time.monotonic()
                fault = run.try_block(block)
                say(f"{time.monotonic() - begin:7.2f} s  {page}:{block.line}: ({block.language} {block.argument})")
                if fault:
                    faults.append(f"{page}:{block.line}: {block.language}: {fault}")
                continue
            for command in markdown.split_commands(page, block):
                row = rows.find(page, markdown.strip_comment(command.text))
                begin = time.monotonic()
                fault = try_command(command, row, page, run, program, full)
                say(f"{time.monotonic() - begin:7.2f} s  {page}:{command.line}: {command.text.splitlines()[0][:90]}")
                if fault:
                    faults.append(f"{page}:{command.line}: {command.text}\n{fault}")
        run.close()
    return faults


def find_table_faults(pages, rows, program, tests):
    """What is wrong with the table, and with words in the pages' text that look like commands."""
    faults = []
    for page in pages:
        text = (ROOT / page).read_text()
        blocks = markdown.read_blocks(page, text)
        for command in rows.before(page):
            rows.find(page, command)
        for command in list_commands(page, blocks):
            row = rows.find(page, markdown.strip_comment(command.text))
            fault = program.find_fault(command.text)
            if fault:
                faults.append(f"{page}:{command.line}: {fault}")
            if row is None and "armwright" not in command.text and re.match(r"(sudo|apt|mpirun|qsub|sbatch|git)\b", command.text):
                faults.append(f"{page}:{command.line}: '{command.text}' needs a row in tests/docs/commands.toml")
        prose = [block.text for block in blocks if block.language == "text"] + re.findall(r"`(armwright [^`]*)`", text)
        faults += [f"{page}: {fault}, in: {words}" for words in prose for fault in [program.find_fault(words)] if fault]
    faults += [f"{row.place}: no page has such a command" for row in rows.rows if not row.used]
    faults += [f"commands.toml: there is no page {name}" for name in rows.pages if name not in pages]
    if tests is not None:
        faults += [f"{row.place}: there is no test {name}" for row in rows.rows for name in row.tests if name not in tests]
    return faults


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pages", nargs="*")
    for flag in ("--table", "--full", "--times"):
        parser.add_argument(flag, action="store_true")
    parser.add_argument("--pages", action="store_true", dest="list")
    parser.add_argument("--tests", metavar="FOLDER")
    parser.add_argument("--keep", type=pathlib.Path)
    options = parser.parse_args()
    if options.list:
        print("\n".join(list_pages()))
        return 0
    full = options.full or os.environ.get("ARMWRIGHT_DOCS_FULL") == "1"
    say = (lambda text: print(text, flush=True)) if options.times else (lambda text: None)
    faults = []
    try:
        program = session.Program(session.find_program())
        rows = table.Table(TABLE)
        if options.table:
            faults += find_table_faults(list_pages(), rows, program, {reliability_test.plain(name) for name in reliability_test.list_tests("ctest", options.tests)} if options.tests else None)
        for page in options.pages:
            faults += try_page(page, rows, program, full, options.keep, say)
    except markdown.Failure as failure:
        faults.append(str(failure))
    print("\n\n".join(faults) or "the documentation does what it says")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
