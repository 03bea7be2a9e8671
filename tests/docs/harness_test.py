"""The harness of commands_test.py itself: what it takes out of pages, and that it notices what is wrong."""

import pathlib
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from commands import markdown, session, table  # noqa: E402


def take(text, name="page.md"):
    return [command for block in markdown.read_blocks(name, text) for command in markdown.split_commands(name, block)]


def make_table(text):
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "commands.toml"
        path.write_text(text)
        return table.Table(path)


class MarkdownTest(unittest.TestCase):
    def refuse(self, text, message):
        with self.assertRaises(markdown.Failure) as caught:
            take(text)
        self.assertIn(message, str(caught.exception))

    def test_a_session_has_commands_and_what_they_print(self):
        commands = take("Text.\n\n```console\n$ one --flag  # why\nprinted\n\n  more\n$ two \\\n>   --more\n```\n")
        self.assertEqual([(c.line, c.text, c.output) for c in commands],
                         [(4, "one --flag  # why", "printed\n\n  more"), (8, "two \\\n  --more", None)])
        self.assertEqual(markdown.strip_comment(commands[0].text), "one --flag")
        self.assertEqual(markdown.strip_comment(commands[1].text), "two --more")

    def test_loops_quotes_and_documents_are_one_command(self):
        text = "```sh\nfor x in 1 2; do\n  echo $x\ndone\necho 'a\nb'\ncat <<END\ntext\nEND\n# a note\nlast\n```\n"
        self.assertEqual([c.text.split("\n")[0] for c in take(text)], ["for x in 1 2; do", "echo 'a", "cat <<END", "last"])

    def test_what_is_no_block_of_ours_is_refused(self):
        self.refuse("```sh\necho 'a\n```\n", "page.md:2: bash cannot read this command")
        self.refuse("Text.\n\n    armwright list\n", "page.md:3: a code block by indentation; write ```sh instead")
        self.refuse("```\nx\n```\n", "page.md:1: a code block in ''")
        self.refuse("```console\nprinted\n```\n", "page.md:2: a session begins with '$ '")
        self.refuse("```sh\nx\n", "page.md:1: this code block has no end")

    def test_scripts_may_write_indented_blocks(self):
        self.assertEqual([c.text for c in take("<!-- Written by x. -->\n# A\n\n    armwright list\n\n    no command\n")][:1], ["armwright list"])

    def test_dots_stand_for_what_varies(self):
        printed = "one\ntwo 3.1 s\nthree\nfour\n"
        self.assertIsNone(markdown.find_difference("one\ntwo ... s\n...\nfour", printed))
        self.assertIsNone(markdown.find_difference("one\n...", printed))
        self.assertIn("two 3.1 s", markdown.find_difference("one\ntwo 3.2 s\n...", printed))
        self.assertIn("goes on", markdown.find_difference("one\ntwo 3.1 s", printed))
        self.assertIn("(the end)", markdown.find_difference("one\n...\nfive\nsix", "one\n"))
        self.assertIsNotNone(markdown.find_difference("a.c", "abc"))

    def test_numbers_alone_may_differ_where_less_is_simulated(self):
        self.assertEqual(markdown.loosen("worst   -1.2e-3 mm\n"), markdown.loosen("worst 44 mm\n"))
        self.assertNotEqual(markdown.loosen("worst 1 mm"), markdown.loosen("best 1 mm"))
        self.assertEqual(markdown.loosen("q1-complex r03"), "q1-complex r03")


class TableTest(unittest.TestCase):
    ROWS = '[[command]]\npage = "docs/a.md"\nmatch = "armwright x (.*)"\ninstead = \'armwright y \\1\'\nwhy = "dear"\n' \
           '[[command]]\nmatch = "armwright .*"\nadd = "--budget 5 --set a.b=1"\nwhy = "dear"\n'

    def test_the_first_row_that_matches_counts(self):
        rows = make_table(self.ROWS)
        run = lambda page, command, full=False: table.apply_row(rows.find(page, command), page, command, full)  # noqa: E731
        self.assertEqual(run("docs/a.md", "armwright x 1"), "armwright y 1")
        self.assertEqual(run("docs/b.md", "armwright x 1"), "armwright x 1 --budget 5 --set a.b=1")
        self.assertEqual(run("docs/b.md", "armwright x --budget 900 --set a.b=7 --set a.c=7"), "armwright x --set a.c=7 --budget 5 --set a.b=1")
        self.assertEqual(run("docs/a.md", "armwright x 1", full=True), "armwright x 1")
        self.assertEqual(run("docs/a.md", "ls"), "ls")

    def test_rows_that_say_too_little_are_refused(self):
        for text, message in (('match = "x"', "it needs one of"), ('match = "x"\nadd = "--y"', "why"), ('match = "x"\nonly = 1', "only")):
            with self.assertRaises(markdown.Failure) as caught:
                make_table("[[command]]\n" + text)
            self.assertIn(message, str(caught.exception))


class SessionTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.session = session.Session(pathlib.Path(cls.folder.name) / "page", "/usr/bin/true", pathlib.Path(__file__).resolve().parents[2])

    @classmethod
    def tearDownClass(cls):
        cls.session.close()
        cls.folder.cleanup()

    def test_commands_go_on_where_the_last_one_left_off(self):
        self.assertEqual(self.session.run("mkdir -p there; cd there; export NAME='a b'").code, 0)
        self.assertEqual(self.session.run('basename "$PWD"; echo "$NAME"').output, "there\na b\n")
        outcome = self.session.run("cd ..; echo no >&2; false")
        self.assertEqual((outcome.code, outcome.errors), (1, "no\n"))

    def test_blocks_in_other_languages_are_tried(self):
        def fault(language, argument, text):
            return self.session.try_block(markdown.Block(1, language, argument, text))
        self.assertIsNone(fault("python", "", "x = 1\n"))
        self.assertIsNone(fault("pycon", "", ">>> x + 1\n2\n"))
        self.assertIn("Expected", fault("pycon", "", ">>> x + 1\n3\n"))
        self.assertIn("NameError", fault("python", "", "y\n"))
        self.assertIn("no JSON", fault("json", "", "{,}"))
        self.assertIn("no TOML", fault("toml", "problem=q1", "a = \n"))
        self.assertIn("write ```toml problem", fault("toml", "", "a = 1\n"))
        self.assertIn("error", fault("c", "", "int x = y;\n"))
        self.assertIsNone(fault("python", "made/by_page.py", "print(1)\n"))
        self.assertEqual((self.session.where() / "made/by_page.py").read_text(), "print(1)\n")


if __name__ == "__main__":
    unittest.main()
