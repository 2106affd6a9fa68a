#!/usr/bin/python3
"""measure_test.py SCRIPTS: scripts/measure puts tables where the pages have a place for them."""
import importlib.machinery
import importlib.util
import pathlib
import subprocess
import sys
import tempfile
import unittest
import unittest.mock

SCRIPTS = pathlib.Path(sys.argv.pop(1))
sys.path.insert(0, str(SCRIPTS))

import measure_program
import measure_tables
import measure_video


def load(name):
    loader = importlib.machinery.SourceFileLoader(name, str(SCRIPTS / name))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(name, loader))
    loader.exec_module(module)
    return module


measure = load("measure")
PAGE = "a\n<!-- measured: x -->\nold\n<!-- end of measured -->\nb\n<!-- measured: y -->\nkept\n<!-- end of measured -->\n"


class Measure(unittest.TestCase):
    def test_replaces_what_is_between_the_markers(self):
        text = measure.replaced(PAGE, "x", "new\n")
        self.assertEqual(text, PAGE.replace("old", "new"))

    def test_refuses_a_page_without_a_place(self):
        with self.assertRaises(ValueError):
            measure.replaced(PAGE, "z", "new\n")
        with self.assertRaises(ValueError):
            measure.replaced("<!-- measured: x -->\nold\n", "x", "new\n")

    def test_every_table_has_one_place(self):
        for table in measure_tables.TABLES:
            page = (SCRIPTS.parent / table.page).read_text()
            self.assertIn("|---", measure.replaced(page, table.name, "|---\n"), table.name)

    def test_every_place_has_a_table(self):
        names = {table.name for table in measure_tables.TABLES}
        for page in [SCRIPTS.parent / "README.md", *(SCRIPTS.parent / "doc").glob("*.md")]:
            for line in page.read_text().splitlines():
                if line.startswith("<!-- measured: "):
                    self.assertIn(line.split()[2], names, page)

    def test_commands_below_tables_can_be_typed(self):
        for table in measure_tables.TABLES:
            self.assertIn(table.programs[0], table.command)
            self.assertEqual(subprocess.run(["bash", "-nc", table.command]).returncode, 0)
            self.assertNotIn("{}", table.command)
        self.assertEqual(measure_program.shell_command("a {} b", (0, 0.5)),
                         "for v in 0 0.5; do a $v b; done")

    def test_refuses_a_commit_on_no_branch(self):
        with tempfile.TemporaryDirectory() as folder, unittest.mock.patch.object(measure, "ROOT", folder):
            git = ["-c", "user.name=n", "-c", "user.email=e"]
            measure.git("init", "--quiet", "-b", "main")
            measure.git(*git, "commit", "--quiet", "--allow-empty", "-m", "one")
            self.assertEqual(measure.commit(), measure.git("rev-parse", "--short", "HEAD"))
            measure.git("checkout", "--quiet", "--detach")
            measure.git(*git, "commit", "--quiet", "--allow-empty", "-m", "two")
            with self.assertRaises(SystemExit) as refused:
                measure.commit()
            self.assertIn("on no branch", str(refused.exception))

    def test_takes_the_last_table_that_a_program_prints(self):
        text = "| trial |\n|---|\n| 1 |\n\n| summary |\n|---|\n| 2 |\ndone\n"
        self.assertEqual(measure_program.last_table(text), ["| summary |", "|---|", "| 2 |"])
        with self.assertRaises(ValueError):
            measure_program.last_table("nothing")

    def test_an_estimate_has_the_digits_of_its_sigma(self):
        summary = {"camera": {"params": {"fx": 311.20199, "w": 0.93},
                              "sigma": {"fx": 0.0174, "w": 0.0}}}
        self.assertEqual(measure_video.estimate(summary), "fx 311.202 ± 0.017")
        summary["camera"]["sigma"]["fx"] = None
        self.assertEqual(measure_video.estimate(summary), "none")

    def test_an_error_is_never_printed_in_powers_of_ten(self):
        self.assertEqual([measure_video.two_digits(px) for px in (0.0154, 2.545, 142.4)],
                         ["0.015", "2.5", "142"])

    def test_a_table_of_cells_is_markdown(self):
        self.assertEqual(measure_program.table(["a", ""], [["1", "2"]]), "| a |  |\n|---|---|\n| 1 | 2 |\n")

    def test_the_angle_between_vectors_does_not_depend_on_their_lengths(self):
        self.assertAlmostEqual(measure_video.angle_deg((2, 0), (0.5, 0.5)), 45.0)
        self.assertEqual(measure_video.angle_deg((3, 0, 0), (1, 0, 0)), 0.0)

    def test_says_what_is_missing(self):
        places = measure_program.Places(pathlib.Path("build"), None)
        with self.assertRaises(measure_program.NotMeasured):
            places.bag("room.bag")


if __name__ == "__main__":
    unittest.main()
