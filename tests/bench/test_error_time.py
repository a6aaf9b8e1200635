"""Runs gi_error_time briefly in one scene: its CSV is whole, its tables name what was measured. No time is judged."""
import csv
import math
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

sys.path.append(os.path.join(os.path.dirname(__file__), ".."))
import headless

PROGRAM = sys.argv.pop(1)
METHODS = {
    "scratch": {"engine", "Embree paths", "shader paths"},
    "moving": {"engine", "engine rebuilt", "engine budget", "engine error", "Embree paths", "shader paths"},
}


class ErrorTime(unittest.TestCase):
    def test_quick_run(self):
        with tempfile.TemporaryDirectory() as folder:
            command = [PROGRAM, "--context", headless.CONTEXT, "--quick", "--seconds", "2", "--scene", "corridor",
                       "--out", folder]
            done = subprocess.run(command, capture_output=True, text=True, check=False)
            if "no OpenGL 4.5 context" in done.stderr and done.returncode:
                self.skipTest(done.stderr)
            self.assertEqual(done.returncode, 0, done.stderr)
            rows = list(csv.DictReader(pathlib.Path(folder, "error-time.csv").read_text().splitlines()))
            text = pathlib.Path(folder, "error-time.md").read_text()
        for phase, methods in METHODS.items():
            self.assertEqual({r["method"] for r in rows if r["phase"] == phase}, methods)
        for r in rows:
            self.assertEqual(r["scene"], "corridor")
            for column in ("setting", "ms", "error_percent"):
                self.assertGreater(float(r[column]), 0, r)
            self.assertTrue(math.isfinite(float(r["bias_percent"])), r)
            self.assertEqual(r["entries_per_leaf"] != "", r["method"].startswith("engine"), r)
        # A line in the table of each phase, and one a setting in that of the budgets.
        settings = {m: sum(r["method"] == m and r["phase"] == "moving" for r in rows) for m in METHODS["moving"]}
        self.assertEqual(text.count("| engine |"), 2 + settings["engine"])
        self.assertEqual(text.count("| engine budget |"), 1 + settings["engine budget"])
        self.assertEqual(text.count("| engine rebuilt |"), 1)

    def test_unknown_scene(self):
        done = subprocess.run([PROGRAM, "--scene", "nowhere"], capture_output=True, text=True, check=False)
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("nowhere", done.stderr)


unittest.main()
