"""Runs figure_six small and short, and offline_trace: every method has its rows and pictures. No time is judged."""
import csv
import os
import struct
import subprocess
import sys
import tempfile
import unittest

sys.path.append(os.path.join(os.path.dirname(__file__), ".."))
import headless

PROGRAM, OFFLINE = sys.argv.pop(1), sys.argv.pop(1)
HEADER = ("triangles,mesh_kb,method,motion,fps,ms,ms_build,ms_bvh,ms_rows,ms_solve,ms_surface,ms_trace,ms_filter,"
          "ms_draw,rel_mse,ssim,equal_error_ms")


def png_size(path):
    with open(path, "rb") as file:
        head = file.read(24)
    return struct.unpack(">II", head[16:]) if head[:8] == b"\x89PNG\r\n\x1a\n" else None


class FigureSix(unittest.TestCase):
    def test_small(self):
        with tempfile.TemporaryDirectory() as folder:
            command = [PROGRAM, "--context", headless.CONTEXT, "--quick", "--size", "32x32", "--out", folder]
            done = subprocess.run(command, capture_output=True, text=True, check=False)
            if "no OpenGL 4.5 context" in done.stderr and done.returncode:
                self.skipTest(done.stderr)
            self.assertEqual(done.returncode, 0, done.stderr)
            with open(os.path.join(folder, "figure6.csv"), encoding="utf-8") as file:
                self.assertEqual(file.readline().strip(), HEADER)
                file.seek(0)
                rows = list(csv.DictReader(file))
            self.assertEqual([(r["method"], r["motion"]) for r in rows],
                             [(m, k) for _ in range(2) for m in ("radiosity", "realtime", "offline")
                              for k in ("rest", "moving")])
            for row in rows:
                self.assertGreater(float(row["fps"]), 0)
                self.assertAlmostEqual(float(row["fps"]) * float(row["ms"]), 1000, delta=1)
                # A picture of another scene, or a black one, is off by 0.1 and more.
                self.assertLess(float(row["rel_mse"]), 0.03)
                self.assertGreater(float(row["ssim"]), 0.5)
                self.assertEqual(row["ms_rows"] != "", row["method"] == "radiosity")
                self.assertEqual(row["ms_trace"] != "", row["method"] != "radiosity")
                for method in ("truth", row["method"]):
                    name = f"figure6_{method}_{row['triangles']}.png"
                    self.assertEqual(png_size(os.path.join(folder, name)), (32, 32), name)
            self.assertEqual(sorted({int(r["triangles"]) // 1000 for r in rows}), [1, 4])
            with open(os.path.join(folder, "figure6.md"), encoding="utf-8") as file:
                self.assertEqual(file.read().count("| radiosity |"), 8)

    def test_offline(self):
        with tempfile.TemporaryDirectory() as folder:
            linear = os.path.join(folder, "a.pfm")
            for scene in ("buddha", "two_balls"):
                subprocess.run([OFFLINE, "--scene", scene, "--light", "indirect", "--size", "24x16", "--samples", "2",
                                "--fineness", "1", "--linear", linear], capture_output=True, check=True)
                with open(linear, "rb") as file:
                    self.assertEqual([file.readline() for _ in range(3)], [b"PF\n", b"24 16\n", b"-1.0\n"])
                    values = struct.unpack("<1152f", file.read())
                self.assertTrue(0.01 < sum(values) / len(values) < 0.2, sum(values) / len(values))

    def test_bad_options(self):
        for program, bad in ((PROGRAM, "--size=3"), (PROGRAM, "--size=64x0"), (PROGRAM, "--quickly=1"),
                             (OFFLINE, "--scene=sea"), (OFFLINE, "--light=dim"), (OFFLINE, "--samples=0")):
            done = subprocess.run([program, bad], capture_output=True, text=True, check=False)
            self.assertNotEqual(done.returncode, 0)
            self.assertNotEqual(done.stderr, "")


unittest.main()
