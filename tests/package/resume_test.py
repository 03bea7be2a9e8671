"""Run by plugins.cmake: kills runs of a user's own problem, several times each, and resumes them.

    resume_test.py PROGRAM LIBRARY ARMWRIGHT WORK_DIR

PROGRAM uses armwright as a library, LIBRARY is a problem that ARMWRIGHT optimizes. The result must have the same bytes as that of a run
without a kill, for each optimizer and number of threads.
"""
import os
import shutil
import signal
import subprocess
import sys
import time

PROGRAM, LIBRARY, ARMWRIGHT, WORK_DIR = sys.argv[1:5]
KILLS = 5
COMPARED = ["result.json", "convergence.csv"]


def read(folder, name):
    with open(os.path.join(folder, name), "rb") as file:
        return file.read()


def measure(folder):
    try:
        return os.path.getsize(os.path.join(folder, "journal"))
    except FileNotFoundError:
        return 0


def kill_when_grown(words, folder, bytes_more):
    """Starts the program and kills it when the journal has grown. Returns whether it was still running."""
    before = measure(folder)
    process = subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    while process.poll() is None and measure(folder) < before + bytes_more:
        time.sleep(0.001)
    process.kill()
    return process.wait() == -signal.SIGKILL


def make_command(kind, folder, optimizer, threads):
    if kind == "program":
        return [PROGRAM, folder, optimizer, threads]
    return [ARMWRIGHT, "optimize", LIBRARY, "--optimizer", optimizer, "--budget", "2000", "--jobs", threads, "--out", folder, "--quiet"]


def check(kind, optimizer, threads):
    whole, killed = (os.path.join(WORK_DIR, f"{name}-{kind}-{optimizer}") for name in ["whole", "killed"])
    for folder in [whole, killed]:
        shutil.rmtree(folder, ignore_errors=True)
    subprocess.run(make_command(kind, whole, optimizer, "1"), check=True)
    words = make_command(kind, killed, optimizer, threads)
    kills = sum(kill_when_grown(words, killed, measure(whole) // (KILLS + 3)) for _ in range(KILLS))
    if kills == 0:
        sys.exit(f"{kind}, {optimizer}: the program had always ended before it was killed")
    subprocess.run(words, check=True)
    for name in COMPARED:
        if read(whole, name) != read(killed, name):
            sys.exit(f"{kind}, {optimizer}: after {kills} kills, {name} has other bytes: compare {whole} and {killed}")
    print(f"{kind}, {optimizer}, {threads} threads: the same bytes after {kills} kills")


for case in [("cmaes", "2"), ("ga", "1"), ("pagmo:de", "2"), ("random", "1")]:
    check("program", *case)
    check("library", *case)
