"""A notebook, run by a real kernel: progress is one output, updated in place; a class from a cell is an optimizer."""
import unittest

import nbformat
from nbclient import NotebookClient
from support import FolderTest

CELLS = [
    """import time
import numpy as np
import armwright
problem = armwright.load_problem("sphere")""",
    """class Mine(armwright.Optimizer):
    def minimize(self, evaluator, seed):
        random = np.random.default_rng(seed)
        while not evaluator.stopped:
            time.sleep(0.1)
            evaluator.evaluate(evaluator.problem.from_unit(random.random((8, len(evaluator.problem)))))
run = armwright.optimize(problem, Mine, budget=80, out="mine")""",
    """print(run.optimizer, run.counts["cases"], *run.manifest["configuration"]["inputs"])""",
    """run = armwright.optimize(problem, Mine, budget=80, out="mine", progress=False)
print(run.counts["cases"])""",
]


class NotebookTest(FolderTest):
    def test_progress_and_classes(self):
        notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(source) for source in CELLS])
        NotebookClient(notebook, timeout=120, kernel_name="python3").execute()
        shown = notebook.cells[1].outputs
        self.assertEqual([one.output_type for one in shown], ["display_data"])
        self.assertEqual(shown[0].data["text/plain"], "")  # taken away at the end
        self.assertIn("python:Mine 80 class Mine", notebook.cells[2].outputs[0].text)
        self.assertEqual(notebook.cells[3].outputs[0].text, "80\n")


if __name__ == "__main__":
    unittest.main()
