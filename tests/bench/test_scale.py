"""Runs gi_scale over small worlds: every event has its lines, and the tables name all of them. No time is judged."""
import os
import subprocess
import sys
import tempfile
import unittest

import scale_tables
sys.path.append(os.path.join(os.path.dirname(__file__), ".."))
import headless

PROGRAM = sys.argv.pop(1)


class Scale(unittest.TestCase):
    def test_small_worlds(self):
        command = [PROGRAM, "--context", headless.CONTEXT, "--objects", "10,20", "--rounds", "1", "--pair", "60"]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if "no OpenGL 4.5 context" in done.stderr and done.returncode:
            self.skipTest(done.stderr)
        self.assertEqual(done.returncode, 0, done.stderr)
        with tempfile.NamedTemporaryFile("w", suffix=".csv") as file:
            file.write(done.stdout)
            file.flush()
            worlds, pair, about = scale_tables.read(file.name)
            text = subprocess.run([sys.executable, "-B", scale_tables.__file__, file.name], capture_output=True,
                                  text=True, check=True).stdout
        self.assertIn("OpenGL", about)
        self.assertEqual(sorted(worlds), ["hall", "street"])
        for name, world in worlds.items():
            self.assertEqual(sorted(world), [10, 20])
            for one in world.values():
                for event in scale_tables.EVENTS:
                    self.assertEqual((event, "cpu ms") in one, event != "a door turns" or name == "street", event)
                self.assertGreater(one["first", "entries per leaf"], 1)
            self.assertIn(f"## {name.capitalize()}", text)
        self.assertEqual(text.count("| exponent |"), 4)
        self.assertEqual(sorted(pair), [20, 60])
        for event in ("one moves", "one of a leaf a face moves"):
            self.assertGreater(pair[20][event, "ratio"], 0)
        self.assertEqual(text.count("| 20 | one "), 2)

    def test_exponents(self):
        self.assertAlmostEqual(scale_tables.exponent([(x, 3 * x**.6) for x in (1, 10, 100, 700)]), .6)
        self.assertIsNone(scale_tables.exponent([(5, 5)]))

    def test_bad_options(self):
        for bad in ("--objects=3", "--objects=many", "--world=sea", "--rounds=few", "--rounds=0", "--cells=1x",
                    "--pair=3",
                    "--leaf-size=nan"):
            done = subprocess.run([PROGRAM, bad], capture_output=True, text=True, check=False)
            self.assertNotEqual(done.returncode, 0)
            self.assertNotEqual(done.stderr, "")


unittest.main()
