"""scripts/bench against: one short run of frame_times stands for both sides; what it prints becomes whole tables.

No time is judged.
"""
import argparse
import os
import subprocess
import sys
import unittest

import against
sys.path.append(os.path.join(os.path.dirname(__file__), ".."))
import headless

PROGRAM = sys.argv.pop(1)


def side(name):
    return against.Side(name, name + " of a day", None, PROGRAM)


class Against(unittest.TestCase):
    def test_tables(self):
        command = [PROGRAM, "--context", headless.CONTEXT, "--frames", "2", "--rebuilds", "1", "--size", "64",
                   "--row-tolerance", "0.5"]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if "no OpenGL 4.5 context" in done.stderr and done.returncode:
            self.skipTest(done.stderr)
        self.assertEqual(done.returncode, 0, done.stderr)
        m = against.Measurements()
        m.add_lines(side("old"), done.stdout)
        m.add_lines(side("new"), done.stdout)
        m.add("start", "shaders cached ms", side("old"), 30)
        m.add("start", "shaders cached ms", side("old"), 10)
        m.add("start", "shaders cached ms", side("old"), 12)
        m.add("start", "shaders cached ms", side("new"), 3)
        m.add("start", "new pass ms", side("new"), 5)
        for series in ("fine", "coarse"):
            for measure, count in (("update ms", 2), ("frame ms", 2), ("trace ms", 2), ("draw ms", 2),
                                   ("rebuild ms", 1), ("from nothing ms", 1), ("leaves", 1), ("rays", 2)):
                values = m.of(series, measure, "old")
                self.assertEqual(len(values), count, (series, measure))
                self.assertTrue(all(value > 0 for value in values), (series, measure))
            self.assertEqual(m.of(series, "leaves", "old"), [4124])
        options = argparse.Namespace(size=64, rounds=1, frames=2, rebuilds=1, start_row_tolerance=0.5, load=0.0)
        text = against.page([side("old"), side("new")], options, m)
        self.assertIn("row tolerance 0.5", text)
        self.assertEqual(text.count("| update | "), 2)
        self.assertEqual(text.count("| from nothing | "), 2)
        self.assertIn("| shaders cached | 12.0 | 10.0 | 3.00 | 3.00 | 4.00 | 3.33 |", text)
        self.assertIn("| new pass |  |  | 5.00 | 5.00 |  |  |", text)


unittest.main()
