"""The page of scripts/figures: verdicts follow from numbers, and a small run of all steps ends in a page.

    test_figures.py FOLDER_OF_PROGRAMS
"""
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

import figures_page
sys.path.append(os.path.join(os.path.dirname(__file__), ".."))
import headless

PROGRAMS = sys.argv.pop(1)

FOUR = """figure,measure,place,unit,ours,truth
4,penumbra,small ball,m,{width},0.100
4,red over green global,floor by the red wall,,1.5,1.52
4,bleeding global,floor by the red wall,,{bleeding},1.25
4,relative MSE,global,,0.01,0
"""
SIX = """method,triangles,motion,fps,ms,equal_error_ms
radiosity,1000,rest,{0},10,10
off-line,1000,rest,1,1000,2000
real-time,1000,rest,20,50,400
radiosity,64000,rest,{1},10,20
off-line,64000,rest,0.5,2000,9000
real-time,64000,rest,2,500,4000
"""


def verdicts(folder, outputs=None):
    sections = figures_page.read_sections(pathlib.Path(folder), outputs or {})
    return {claim: (state, why) for s in sections for state, claim, why in s.verdicts}


class Verdicts(unittest.TestCase):
    def setUp(self):
        self.kept = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.kept.name)
        self.addCleanup(self.kept.cleanup)

    def test_nothing_measured_claims_nothing(self):
        found = verdicts(self.folder)
        self.assertGreaterEqual(len(found), 12)
        self.assertEqual({state for state, _ in found.values()}, {figures_page.UNKNOWN})

    def test_figure_four_holds_or_not_by_its_numbers(self):
        yes, no = figures_page.HOLDS, figures_page.FAILS
        for width, bleeding, soft, colour in ((0.104, 1.24, yes, yes), (0.106, 1.24, no, yes), (0.1, 1.18, yes, no),
                                              ("nan", 1.0, None, no)):
            (self.folder / "figure4.csv").write_text(FOUR.format(width=width, bleeding=bleeding))
            found = verdicts(self.folder)
            self.assertEqual(found["soft shadows are right"][0], soft or figures_page.UNKNOWN, width)
            self.assertEqual(found["global light shows colour bleeding"][0], colour, bleeding)
        self.assertIn("25 %", found["global light shows colour bleeding"][1])

    def test_figure_five_reads_what_the_test_prints(self):
        line = "{} ball of 1536 faces: 1.0000 W of 1.0100 ({:+.2f} %), RMS by leaf {:.2f} %\n"
        claim = "caustics of mirror and glass carry the right light"
        good = {"a": line.format("mirror", -0.99, 3) + line.format("glass", 0.5, 6)}
        self.assertEqual(verdicts(self.folder, good)[claim][0], figures_page.HOLDS)
        bad = {"a": line.format("mirror", -2.1, 3)}
        self.assertEqual(verdicts(self.folder, bad)[claim][0], figures_page.FAILS)
        frames = "frame,frame_wall_ms\n0,9000\n1,80\n2,90\n3,300\n"
        (self.folder / "budget_frames.csv").write_text(frames)
        state, why = verdicts(self.folder)["two moving balls keep 10 frames a second under a budget, without a GPU"]
        self.assertEqual(state, figures_page.HOLDS)
        self.assertIn("90 ms", why)

    def test_figure_six_compares_rates(self):
        (self.folder / "figure6.csv").write_text("# machine\n" + SIX.format(30, 25))
        found = verdicts(self.folder)
        self.assertEqual(found["faster than off-line ray tracing"][0], figures_page.HOLDS)
        self.assertEqual(found["faster than real-time ray tracing"][0], figures_page.HOLDS)
        self.assertEqual(found["the lead over real-time ray tracing grows with the mesh"][0], figures_page.HOLDS)
        self.assertEqual(found["faster than real-time ray tracing, at equal error"][0], figures_page.HOLDS)
        (self.folder / "figure6.csv").write_text(SIX.format(10, 1))
        found = verdicts(self.folder)
        state, why = found["faster than real-time ray tracing"]
        self.assertEqual(state, figures_page.FAILS)
        self.assertIn("behind at 1000 triangles rest, 64000 triangles rest", why)
        self.assertEqual(found["the lead over off-line ray tracing grows with the mesh"][0], figures_page.FAILS)

    def test_markdown_is_narrow_and_names_its_pictures(self):
        (self.folder / "figure4.csv").write_text(FOUR.format(width=0.1, bleeding=1.25))
        (self.folder / "difference4.png").write_bytes(b"\x89PNG\r\n\x1a\n")
        sections = figures_page.read_sections(self.folder, {})
        machine = dict.fromkeys(("processor", "renderer", "commit", "date", "pictures", "run", "took"), "x")
        docs = self.folder / "docs" / "figures.md"
        docs.parent.mkdir()
        figures_page.write_docs(sections, machine, [("figure 6", "not built")], self.folder, docs)
        text = docs.read_text()
        self.assertTrue(all(len(line) <= 120 for line in text.splitlines() if not line.startswith("|")))
        self.assertIn("- Missing: figure 6: not built", text)
        self.assertIn("(pictures/figures-difference4.png)", text)
        self.assertTrue((docs.parent / "pictures" / "figures-difference4.png").exists())
        self.assertIn("<li class=holds>", figures_page.html(sections, machine, []))


class SmallRun(unittest.TestCase):
    def test_every_step(self):
        """Tiny pictures of few paths: that all is there and told; what they show is another matter."""
        with tempfile.TemporaryDirectory() as folder:
            script = os.path.join(os.path.dirname(os.path.abspath(__file__)), "figures.py")
            command = [sys.executable, "-B", script, PROGRAMS, "--size", "48x48", "--context", headless.CONTEXT,
                       "--only", "4", "--out", folder]
            done = subprocess.run(command, capture_output=True, text=True, check=False)
            if "no OpenGL 4.5 context" in done.stderr:
                self.skipTest(done.stderr)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertNotIn("missing", done.stderr)
            page = (pathlib.Path(folder) / "index.html").read_text(encoding="utf-8")
            for picture in ("ours/direct.png", "truth/global.png", "shadow_truth.png", "bleeding_global.png"):
                self.assertIn(f'src="{picture}"', page)
                self.assertTrue((pathlib.Path(folder) / picture).exists())
            measures = figures_page.read_measures(pathlib.Path(folder) / "figure4.csv")
            self.assertGreater(len(measures), 50)
            ours, truth = measures["radiance direct", "floor in the middle"]
            self.assertLess(abs(ours / truth - 1), 0.1)  # nothing is in the lamp's way there

    def test_programs_that_are_not_there(self):
        with tempfile.TemporaryDirectory() as folder:
            script = os.path.join(os.path.dirname(os.path.abspath(__file__)), "figures.py")
            done = subprocess.run([sys.executable, "-B", script, folder, "--size", "48x48", "--out", folder],
                                  capture_output=True, text=True, check=False)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn("figure_six is not built here", done.stderr)
            page = (pathlib.Path(folder) / "index.html").read_text(encoding="utf-8")
            self.assertIn("offline_trace is not built here", page)
            self.assertIn("not measured", page)
            bad = subprocess.run([sys.executable, "-B", script, folder, "--size", "4x5"], capture_output=True,
                                 check=False)
            self.assertEqual(bad.returncode, 2)


unittest.main()
