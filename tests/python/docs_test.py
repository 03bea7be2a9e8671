"""docs/python.md names calls that exist. (Its code and commands are run like those of all pages, tests/docs.)"""
import re
import unittest

from support import ROOT

import armwright

PAGE = (ROOT / "docs/python.md").read_text()


class DocsTest(unittest.TestCase):
    def test_calls_that_are_named_exist(self):
        for name in re.findall(r"`(?:problem\.)?(\w+)\(", PAGE.split("| call |")[1].split("**Numbers.**")[0]):
            self.assertTrue(any(hasattr(one, name) for one in (armwright, armwright.Problem, armwright.Study, armwright.Run, armwright.Search)), name)


if __name__ == "__main__":
    unittest.main()
