"""Run by ctest: types into a real bash on a terminal, presses TAB and checks the line that results.

    completion_test.py PROGRAM CONFIGS

It runs with and without the package bash-completion, which only changes how bash finds the script.
"""
import os
import pty
import re
import select
import subprocess
import sys
import tempfile
import time

PROGRAM, CONFIGS = sys.argv[1:3]
BASH_COMPLETION = "/usr/share/bash-completion/bash_completion"
TIMEOUT_S = 30  # for a busy machine; normally an answer takes less than 0.1 s
LONGEST_CALL_S = 0.1  # the processor time that one TAB may cost

# The typed text before TAB, and the line after it. A blank at the end means that the word is complete.
CASES = [
    ("armwright opt", "armwright optimize "),
    ("armwright check-pl", "armwright check-plugin "),
    ("armwright testset ex", "armwright testset export "),
    ("armwright manual testset has", "armwright manual testset hash "),
    ("armwright optimize q1-compl", "armwright optimize q1-complex "),
    ("armwright optimize q1-complex --judg", "armwright optimize q1-complex --judging-engine "),
    ("armwright optimize --engine art", "armwright optimize --engine articulated "),
    ("armwright optimize --engine=art", "armwright optimize --engine=articulated "),
    ("armwright optimize --precision fl", "armwright optimize --precision float "),
    # Readline breaks words at the colon.
    ("armwright optimize -o nlopt:bob", "armwright optimize -o nlopt:bobyqa "),
    ("armwright optimize -o nlo", "armwright optimize -o nlopt:"),
    ("armwright optimize --optimizer=nlopt:bob", "armwright optimize --optimizer=nlopt:bobyqa "),
    ("armwright optimize -o multistart:nlopt:bob", "armwright optimize -o multistart:nlopt:bobyqa "),
    ("armwright compare --optimizers ga,nlopt:bob", "armwright compare --optimizers ga,nlopt:bobyqa "),
    ("armwright list optimizers nlopt:bob", "armwright list optimizers nlopt:bobyqa "),
    ("armwright list rob", "armwright list robots "),
    ("armwright optimize --robot irb4600_40", "armwright optimize --robot irb4600_40_255 "),
    ("armwright evaluate table-a10 --problem q2-e", "armwright evaluate table-a10 --problem q2-e"),
    ("armwright compare --preset smo", "armwright compare --preset smoke "),
    ("armwright export runs --format ros", "armwright export runs --format ros2-control "),
    ("armwright report ru", "armwright report runs/"),
    ("armwright show runs/a", r"armwright show runs/a\ run/"),
    ("armwright optimize my-pr", "armwright optimize my-problem.toml "),
    ("armwright optimize --out ru", "armwright optimize --out runs/"),
    ("armwright merge runs ru", "armwright merge runs runs/"),
    ("armwright merge runs runs ru", "armwright merge runs runs runs/"),
    ("armwright optimize --seed ru", "armwright optimize --seed ru"),  # a number, no file
    ("armwright reproduce --out --js", "armwright reproduce --out --json "),  # without its value
    ("armwright completion ", "armwright completion bash "),
    ("./program opt", "./program opt"),  # another one
]


class Shell:
    """An interactive bash that shows its line when Ctrl-G is pressed."""

    def __init__(self, folder, set_up):
        environment = dict(os.environ, PATH=os.path.dirname(PROGRAM) + ":/usr/bin:/bin", ARMWRIGHT_CONFIGS=CONFIGS,
                           TERM="dumb", HISTFILE="", INPUTRC="/dev/null", LC_ALL="C.UTF-8",
                           XDG_DATA_HOME=os.path.join(folder, "data"))
        self.process, self.terminal = pty.fork()
        if self.process == 0:
            os.chdir(os.path.join(folder, "home"))
            os.execve("/bin/bash", ["bash", "--norc", "--noprofile", "-i"], environment)
        # On a narrow terminal, bash would scroll a long line.
        self.send("stty cols 1000 -echo; PS1=; bind 'set bell-style none'; bind 'set enable-bracketed-paste off'; "
                  "bind 'set page-completions off'; bind -x '\"\\C-g\": printf \"<line>%s</line>\" \"$READLINE_LINE\"'; "
                  + set_up + "; echo re''ady\n")
        self.expect(r"ready")

    def send(self, text):
        os.write(self.terminal, text.encode())

    def expect(self, pattern):
        seen, end = "", time.monotonic() + TIMEOUT_S
        while time.monotonic() < end:
            if select.select([self.terminal], [], [], 0.2)[0]:
                seen += os.read(self.terminal, 4096).decode()
                found = re.search(pattern, seen, re.DOTALL)
                if found:
                    return found
        raise AssertionError(f"no {pattern!r} came from bash within {TIMEOUT_S} s, but {seen!r}")

    def complete(self, line):
        self.send(line + "\t\x07")
        completed = self.expect(r"<line>(.*)</line>")[1]
        self.send("\x15")  # clears the line
        return completed

    def end(self):
        os.close(self.terminal)
        os.waitpid(self.process, 0)


def check_with(folder, name, set_up, failures):
    shell = Shell(folder, set_up)
    for typed, expected in CASES:
        completed = shell.complete(typed)
        if completed != expected:
            failures.append(f"{name}: {typed!r} became {completed!r} instead of {expected!r}")
    shell.end()
    print(f"{name}: {len(CASES)} lines")


def check_cost(failures):
    """Checks the processor time of the calls of one TAB. It takes the least of three, as other processes use the machine, too."""
    for kind in ["problems", "optimizers", "robots", "engines", "designs", "studies"]:
        costs = []
        for _ in range(3):
            before = os.times()
            subprocess.run([PROGRAM, "list", kind, "--names"], stdout=subprocess.DEVNULL, check=True)
            after = os.times()
            costs.append(after.children_user + after.children_system - before.children_user - before.children_system)
        print(f"list {kind} --names: {min(costs):.3f} s")
        if min(costs) > LONGEST_CALL_S:
            failures.append(f"'list {kind} --names' takes {min(costs):.3f} s, too long for a TAB")


def main():
    failures = []
    with tempfile.TemporaryDirectory() as folder:
        for path in ["home/runs/a run", "data/bash-completion/completions"]:
            os.makedirs(os.path.join(folder, path))
        open(os.path.join(folder, "home/my-problem.toml"), "w").close()
        script = os.path.join(folder, "data/bash-completion/completions/armwright")
        with open(script, "wb") as file:
            file.write(subprocess.run([PROGRAM, "completion", "bash"], stdout=subprocess.PIPE, check=True).stdout)
        subprocess.run(["bash", "-n", script], check=True)
        check_with(folder, "bash alone", f"source '{script}'", failures)
        # Some users remove these characters, for names of hosts and packages.
        check_with(folder, "':' breaks no words", f"source '{script}'; COMP_WORDBREAKS=${{COMP_WORDBREAKS//:}}", failures)
        if os.path.exists(BASH_COMPLETION):
            check_with(folder, "with bash-completion", f"source {BASH_COMPLETION}", failures)
        else:
            print("with bash-completion: left out, as that package is not here")
    check_cost(failures)
    if failures:
        sys.exit("\n".join(failures))


main()
