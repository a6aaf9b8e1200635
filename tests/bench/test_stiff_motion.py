"""Runs gi_stiff_motion over a few frames: its CSV is whole, what is certified holds, its table names every rho."""
import csv
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

sys.path.append(os.path.join(os.path.dirname(__file__), ".."))
import headless

PROGRAM = sys.argv.pop(1)
RHOS = ["0.9", "0.99", "0.999", "0.9999"]
MOVING, RESTING, SWEEPS = 3, 1, 4


class StiffMotion(unittest.TestCase):
    def test_short_run(self):
        with tempfile.TemporaryDirectory() as folder:
            command = [PROGRAM, "--context", headless.CONTEXT, "--moving", str(MOVING), "--resting", str(RESTING),
                       "--sweeps", str(SWEEPS), "--out", folder]
            done = subprocess.run(command, capture_output=True, text=True, check=False)
            if "no OpenGL 4.5 context" in done.stderr and done.returncode:
                self.skipTest(done.stderr)
            self.assertEqual(done.returncode, 0, done.stderr)
            rows = list(csv.DictReader(pathlib.Path(folder, "stiff-motion.csv").read_text().splitlines()))
            text = pathlib.Path(folder, "stiff-motion.md").read_text()
        kinds = {(r["rho"], r["frame"], r["solver"], r["start"]) for r in rows}
        self.assertEqual(len(kinds), len(rows))
        self.assertEqual(len(rows), len(RHOS) * (MOVING + RESTING) * 4)
        for r in rows:
            self.assertEqual(r["moving"], str(int(int(r["frame"]) < MOVING)))
            self.assertLessEqual(int(r["sweeps"]), SWEEPS)
            self.assertGreaterEqual(float(r["distance"]), 0)
            self.assertEqual(r["bound"] != "", r["solver"] == "library")
            if r["bound"]:
                self.assertLessEqual(float(r["distance"]), float(r["bound"]), r)
        # Four sweeps a frame that only swept would leave 0.99 of the light to come at 0.9999.
        self.assertLess(max(float(r["distance"]) for r in rows if r["solver"] == "library"), 0.5)
        for rho in RHOS:
            self.assertEqual(text.count(f"| {rho} |"), 1)
            self.assertIn(f"| {rho} |", done.stdout)

    def test_bad_options(self):
        for bad in ("--sweeps=0", "--moving=many", "--tolerance=2"):
            done = subprocess.run([PROGRAM, bad], capture_output=True, text=True, check=False)
            self.assertNotEqual(done.returncode, 0)
            self.assertIn(bad.split("=")[1], done.stderr)


unittest.main()
