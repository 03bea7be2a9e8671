"""A page's commands, one after the other in a folder of their own, as somebody runs them who reads the page."""

import dataclasses
import json
import os
import pathlib
import re
import signal
import subprocess
import sys
import tomllib

from . import markdown

TIMEOUT_S = 120  # of one command; the slowest on the shared machines of CI took 8
FULL_TIMEOUT_S = 3600
# Code of a plugin's class, put where it belongs. Only its syntax and types are looked at.
CLASS = """#include "armwright/plugin.hpp"
namespace plugin = armwright::plugin;
class Page {{
 public:
{}
}};
"""
# Python of a page runs in one interpreter, as in a notebook; sessions with >>> are compared by doctest.
PYTHON = """
import doctest, json, sys, traceback
names = {"__name__": "__main__"}
for line in sys.stdin:
    block = json.loads(line)
    try:
        if block["language"] == "pycon":
            test = doctest.DocTestParser().get_doctest(block["text"], names, block["place"], None, 0)
            found = []
            failed = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS).run(test, out=found.append, clear_globs=False).failed
            names.update(test.globs)
            answer = "".join(found) if failed else ""
        else:
            exec(compile(block["text"], block["place"], "exec"), names)
            answer = ""
    except BaseException:
        answer = traceback.format_exc()
    print(json.dumps({"answer": answer}), file=sys.__stderr__, flush=True)
"""


@dataclasses.dataclass
class Outcome:
    output: str
    errors: str  # standard error, progress included
    code: int | None  # None: it took too long

    def is_good(self):
        """Whether a command that only prepares something has done so; that a simulated case failed (3) is no fault of the text."""
        return self.code in (0, 3)


class Session:
    def __init__(self, folder, program, sources, full=False):
        self.folder = pathlib.Path(folder)
        self.program = pathlib.Path(program)
        self.sources = pathlib.Path(sources)
        self.timeout_s = FULL_TIMEOUT_S if full else TIMEOUT_S
        self.state = self.folder / ".session"
        self.work = self.folder / "work"
        self.work.mkdir(parents=True)
        (self.folder / "home").mkdir()
        self.state.write_text(f"cd '{self.work}'\n")
        self.python = None
        # The pages show what machines with AVX2 print; one with more takes no more here, and no variable of the caller's counts.
        kept = {key: os.environ[key] for key in ("PATH", "LD_LIBRARY_PATH", "PYTHONPATH", "LSAN_OPTIONS") if key in os.environ}
        self.environment = kept | {
            "PATH": f"{self.program.parent}:/usr/bin:/bin:{kept['PATH']}", "HOME": str(self.folder / "home"), "LC_ALL": "C.UTF-8",
            "ARMWRIGHT_SIMD": "avx2", "ARMWRIGHT_JOBS": "1", "TERM": "dumb", "PYTHONDONTWRITEBYTECODE": "1",
            "CMAKE_PREFIX_PATH": os.environ.get("ARMWRIGHT_PREFIX", "")}

    def link(self, path):
        """Makes a link to a part of the repository, at the place where a clone has it. What the pages name build/release is the build of the
        tested program, whatever its preset."""
        target = self.sources / path
        if path == "build":
            path, target = "build/release", self.program.parent.parent
        place = self.work / path
        place.parent.mkdir(parents=True, exist_ok=True)
        place.symlink_to(target)

    def run(self, command):
        """What becomes of a command, where the last one left off."""
        script = (f"source '{self.state}'\ntrap '{{ code=$?; export -p; printf \"cd %q\\n\" \"$PWD\"; }} > \"{self.state}\"; exit $code' EXIT\n"
                  f"set -o pipefail\n{command}\n")
        process = subprocess.Popen(["bash", "-c", script], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                   errors="replace", env=self.environment, start_new_session=True)
        try:
            return Outcome(*process.communicate(timeout=self.timeout_s), process.returncode)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            output, messages = process.communicate()
            return Outcome(output, f"{messages}\n(killed after {self.timeout_s} s)", None)

    def where(self):
        """The folder that the next command runs in."""
        return pathlib.Path(subprocess.run(["bash", "-c", f"source '{self.state}'; pwd"], capture_output=True, text=True, check=True).stdout.strip())

    def try_block(self, block):
        """What is wrong with a block that is no command; None if nothing is."""
        name = block.argument.split(" ")[0]
        if "." in name and "=" not in name:
            place = self.where() / name
            place.parent.mkdir(parents=True, exist_ok=True)
            place.write_text(block.text)
            return None
        trial = getattr(self, f"try_{block.language}", None)
        return trial(block) if trial else None

    def try_toml(self, block):
        try:
            keys = tomllib.loads(block.text)
        except tomllib.TOMLDecodeError as error:
            return f"this is no TOML: {error}"
        kind, _, base = block.argument.partition("=")
        if kind not in ("problem", "study"):
            return "write ```toml problem=BASE, ```toml study, or ```toml FILE.toml, so that it can be tried"
        defaults = {"problem": {"extends": base or "q2-e6"}, "study": {"problems": ["q2-e6"], "optimizers": ["ga"], "replicates": 2, "budget": 500}}[kind]
        if "problem" in keys:
            defaults.pop("problems")
        if "optimizer" in keys:
            defaults.pop("optimizers")
        missing = "".join(f"{key} = {json.dumps(value)}\n" for key, value in defaults.items() if key not in keys and "extends" not in keys)
        file = self.where() / "fragment.toml"
        file.write_text(missing + block.text)
        outcome = self.run("armwright evaluate start --problem fragment.toml --cases 1 --quiet" if kind == "problem"
                           else "armwright compare fragment.toml --dry-run --quiet --engine articulated")
        file.unlink()
        return None if outcome.is_good() else outcome.errors

    def try_cpp(self, block):
        return self.compile_only("c++", ["-std=c++20"], CLASS.format(block.text) if block.argument == "class" else block.text)

    def try_c(self, block):
        if block.argument == "header":
            lines = (self.sources / "include/armwright/plugin.h").read_text().split("\n")
            unknown = [line for line in block.text.strip("\n").split("\n") if line not in lines]
            return f"not in armwright/plugin.h: {unknown[0]}" if unknown else None
        return self.compile_only("c", ["-std=c99"], block.text)

    def compile_only(self, language, flags, text):
        found = subprocess.run(["g++" if language == "c++" else "gcc", "-x", language, "-fsyntax-only", *flags, "-I", str(self.sources / "include"), "-"],
                               input=text, capture_output=True, text=True, check=False)
        return None if found.returncode == 0 else found.stderr

    def try_json(self, block):
        try:
            json.loads(block.text)
            return None
        except json.JSONDecodeError as error:
            return f"this is no JSON: {error}"

    def try_python(self, block):
        if self.python is None:
            self.python = subprocess.Popen(["/usr/bin/python3", "-c", PYTHON], cwd=self.where(), env=self.environment, text=True, stdin=subprocess.PIPE,
                                           stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        self.python.stdin.write(json.dumps({"language": block.language, "text": block.text, "place": f"line {block.line}"}) + "\n")
        self.python.stdin.flush()
        said = ""
        for line in self.python.stderr:
            if line.startswith('{"answer"'):
                return (said + json.loads(line)["answer"]) or None if json.loads(line)["answer"] else None
            said += line
        return f"the interpreter has ended: {said}"

    try_pycon = try_python

    def close(self):
        if self.python is not None:
            self.python.stdin.close()
            self.python.wait()
            self.python.stderr.close()


def has_avx2():
    """Whether this machine can print the very digits of the pages."""
    return bool(re.search(r"^flags\s*:.*\bavx2\b", pathlib.Path("/proc/cpuinfo").read_text(), re.M))


class Program:
    """What the program says of its own subcommands and flags."""

    def __init__(self, path):
        self.path = str(path)
        self.texts = {}
        self.names = set(re.findall(r"^  ([a-z-]+) {3,}", self.help(), re.M))

    def help(self, *command):
        if command not in self.texts:
            self.texts[command] = subprocess.run([self.path, *command, "--help"], capture_output=True, text=True, check=True).stdout
        return self.texts[command]

    def find_fault(self, command):
        """What the program does not know of the words of a command; None if it knows them all. Prose may end a command anywhere."""
        for called in re.findall(r"(?:^|[\s(`'\"])armwright ((?:[^|;&\n]|\\\n)*)", command):
            words = markdown.strip_comment(called).replace("\n", " ").split()
            if not words or words[0].startswith("-"):
                continue
            if words[0] not in self.names:
                if re.fullmatch(r"[a-z][a-z-]*", words[0]):
                    return f"armwright has no command '{words[0]}'"
                continue
            known = self.help(words[0])
            if words[0] == "testset" and len(words) > 1:
                known += self.help(*words[:2])
            for word in words[1:]:
                flag = re.match(r"--[a-z][a-z-]*|-[a-z]$", word)
                if flag and not re.search(rf"(?<![\w-]){re.escape(flag[0])}(?![\w-])", known):
                    return f"armwright {words[0]} has no flag {flag[0]}"
        return None


def find_program():
    root = pathlib.Path(__file__).resolve().parents[3]
    path = pathlib.Path(os.environ.get("ARMWRIGHT", root / "build/release/bin/armwright"))
    if not path.is_file():
        sys.exit(f"there is no program {path}; build it, or name it in ARMWRIGHT")
    return path.resolve()
