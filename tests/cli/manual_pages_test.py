"""Run by ctest: man formats every manual page without a warning and finds its name.

    manual_pages_test.py PROGRAM
"""
import glob
import os
import subprocess
import sys
import tempfile

ENVIRONMENT = dict(os.environ, LC_ALL="C.UTF-8", MANROFFSEQ="", MANWIDTH="80")


def run(*words):
    return subprocess.run(words, env=ENVIRONMENT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False)


def check(page, failures):
    # These are the calls of Debian's lintian.
    formatted = run("man", "--warnings", "-E", "UTF-8", "-l", "-Tutf8", "-Z", page)
    if formatted.returncode != 0 or formatted.stderr:
        failures.append(f"{page}: man says\n{formatted.stderr}")
    name = os.path.basename(page)[: -len(".1")]
    found = run("lexgrog", page)
    if found.returncode != 0 or f'"{name} - ' not in found.stdout:
        failures.append(f"{page}: lexgrog says {found.stdout}{found.stderr}")
    # The shown text can be typed: flags have two plain dashes, and quotes are straight.
    text = run("man", "-E", "UTF-8", "-l", "-P", "cat", page).stdout
    for wrong in "\u2010\u2212\u2018\u2019\u201c\u201d":
        if wrong in text:
            failures.append(f"{page}: has {wrong!r}, which nobody can type")
    if "--help" not in text:
        failures.append(f"{page}: does not name --help")


def main():
    failures = []
    with tempfile.TemporaryDirectory() as folder:
        run(sys.argv[1], "manual", "--format", "man", "--out", folder)
        pages = sorted(glob.glob(folder + "/*.1"))
        if len(pages) < 20:
            failures.append(f"only {len(pages)} pages were written")
        for page in pages:
            check(page, failures)
    if failures:
        sys.exit("\n".join(failures))
    print(f"{len(pages)} pages")


main()
