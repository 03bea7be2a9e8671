"""Run by ctest: scripts/check-commits names each fault of a message with its commit, and passes good messages and merges."""
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "scripts/check-commits"
GOOD = "Robots have two arms\n\nOne arm cannot hold and turn a part.\n"
NAMES = {f"GIT_{role}_{key}": value for role in ("AUTHOR", "COMMITTER") for key, value in (("NAME", "A"), ("EMAIL", "a@example.org"))}


class CheckCommits(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)
        self.git("init", "--quiet", "--initial-branch=main")
        self.base = self.commit("A first line from before the rule, which nobody has to change any more today.")

    def git(self, *words, text=None):
        environment = {**os.environ, **NAMES, "GIT_CONFIG_GLOBAL": os.devnull, "GIT_CONFIG_NOSYSTEM": "1"}
        done = subprocess.run(["git", "-C", self.root, *words], input=text, env=environment, capture_output=True, text=True, check=True)
        return done.stdout.strip()

    def commit(self, message):
        self.git("commit", "--quiet", "--allow-empty", "--allow-empty-message", "--cleanup=verbatim", "--file=-", text=message)
        return self.git("rev-parse", "HEAD")

    def run_script(self, *words):
        words = words or ("--base", self.base)
        done = subprocess.run([sys.executable, SCRIPT, "--root", self.root, *words], capture_output=True, text=True, check=False)
        return done.returncode, done.stdout + done.stderr

    def expect_fault(self, message, fault):
        commit = self.commit(message)
        self.commit(GOOD)
        code, output = self.run_script()
        self.assertEqual(code, 1, output)
        self.assertIn(f'{commit[:10]} "{message.splitlines()[0] if message else ""}": {fault}', output)
        self.assertIn("1 of 2 commits", output)

    def test_passes_good_messages_up_to_the_limit(self):
        self.commit(GOOD)
        self.commit("x" * 72 + "\n\nThe reason is here.\n\nSigned-off-by: A <a@example.org>\n")
        code, output = self.run_script()
        self.assertEqual(code, 0, output)
        self.assertIn("the messages of 2 commits are good", output)

    def test_finds_a_first_line_that_is_too_long(self):
        self.expect_fault("x" * 73 + "\n\nThe reason.\n", "the first line has 73 characters; shorten it to at most 72")

    def test_finds_an_empty_message(self):
        self.expect_fault("", "the first line is empty")

    def test_finds_a_dot_at_the_end(self):
        self.expect_fault("Robots walk.\n\nThe reason.\n", "the first line ends with a dot; remove it")

    def test_finds_a_missing_blank_line(self):
        self.expect_fault("Robots walk\nThe reason.\n", "the second line is not blank")

    def test_finds_a_missing_body(self):
        self.expect_fault("Robots walk\n", "there is no body")

    def test_takes_no_trailer_for_a_body(self):
        self.expect_fault("Robots walk\n\nSigned-off-by: A <a@example.org>\n", "there is no body")

    def test_lets_merges_be(self):
        self.git("checkout", "--quiet", "-b", "other")
        self.commit(GOOD)
        self.git("checkout", "--quiet", "main")
        self.git("merge", "--quiet", "--no-ff", "--message", "Merge branch 'other' of a repository with a very long name indeed, on one line.", "other")
        code, output = self.run_script()
        self.assertEqual(code, 0, output)
        self.assertIn("the messages of 1 commits are good", output)

    def test_says_that_the_first_commit_is_missing_and_checks_the_rest(self):
        code, output = self.run_script("--base", "0" * 40)
        self.assertEqual(code, 1, output)
        self.assertIn("this clone lacks the commit 0000000", output)
        self.assertIn(self.base[:10], output)

    def test_says_that_there_is_no_repository(self):
        with tempfile.TemporaryDirectory() as folder:
            code, output = self.run_script("--root", folder)
        self.assertEqual(code, 0, output)
        self.assertIn("is not a git repository", output)


unittest.main()
