#!/usr/bin/env python3
"""Runs the programs as a user does: what they write, and what they say about bad input.

    test_programs.py FOLDER_OF_PROGRAMS SOURCE_FOLDER [PART/PARTS]

Pictures are small and scenes coarse: this is about files and messages, the library's own tests are about light. Parts
and last lines are tests/suite.py's.
"""
import csv
import json
import math
import os
import pty
import re
import resource
import signal
import struct
import subprocess
import sys
import tempfile
import time
import unittest

sys.path.append(os.path.join(os.path.dirname(__file__), ".."))
import headless
import suite
from fields import read_ply

PROGRAMS, SOURCE = sys.argv[1], sys.argv[2]
DOOR = os.path.join(SOURCE, "demos", "scenes", "door.gltf")
CONTEXT = ["--context", headless.CONTEXT]
TINY = CONTEXT + ["--size", "64x48"]


def run(program, *arguments, folder=None, environment=None):
    return subprocess.run([os.path.join(PROGRAMS, program), *arguments], capture_output=True, text=True, cwd=folder,
                          timeout=300, env=dict(os.environ, **environment) if environment else None)


def on_terminal(program, *arguments):
    """What the program writes to a terminal's standard error, and its exit code."""
    ours, terminal = pty.openpty()
    command = [os.path.join(PROGRAMS, program), *arguments]
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=terminal) as running:
        os.close(terminal)
        told = b""
        try:
            while chunk := os.read(ours, 4096):
                told += chunk
        except OSError:  # Linux's way to say that the other end is closed
            pass
    os.close(ours)
    return told.decode(), running.returncode


def read_csv(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def png_size(path):
    with open(path, "rb") as file:
        head = file.read(24)
    return struct.unpack(">II", head[16:24]) if head[:8] == b"\x89PNG\r\n\x1a\n" else None


PYRAMID = """v -1 0 -1
v 1 0 -1
v 1 0 1
v -1 0 1
v 0 3 0
f 1 2 3 4
f 2 1 5
f 3 2 5
f 4 3 5
f 1 4 5
"""

# A hall with a wall through it, off its middle and a bit askew; a lamp on one side.
HALL = """mtllib hall.mtl
v -3 0 -1
v 3 0 -1
v 3 0 1.5
v -3 0 1.5
v -3 2.4 -1
v 3 2.4 -1
v 3 2.4 1.5
v -3 2.4 1.5
o hall
usemtl wall
f 4 3 2 1
f 5 6 7 8
f 1 2 6 5
f 2 3 7 6
f 3 4 8 7
f 4 1 5 8
v 1.5 -0.2 -1.3
v 1.55 -0.2 -1.3
v 1.65 -0.2 1.7
v 1.6 -0.2 1.7
v 1.5 2.5 -1.3
v 1.55 2.5 -1.3
v 1.65 2.5 1.7
v 1.6 2.5 1.7
o wall
usemtl wall
f 9 10 11 12
f 16 15 14 13
f 13 14 10 9
f 14 15 11 10
f 15 16 12 11
f 16 13 9 12
v -1 2 0
v 0 2 0
v 0 2 0.5
v -1 2 0.5
o lamp
usemtl lamp
f 17 18 19 20
"""


def box(corners, lower, upper, inward=False):
    """Faces of a box, whose corners are added to the list."""
    first = len(corners) + 1
    corners += [[(upper if k >> i & 1 else lower)[i] for i in range(3)] for k in range(8)]
    faces = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))
    return ["f %d %d %d %d" % tuple(first + k for k in (face[::-1] if inward else face)) for face in faces]


def slats():
    """A room lit through twenty slats before a wall that shines: hard for rows that are coarse."""
    corners = []
    lines = ["o room", "usemtl wall"] + box(corners, (-2, -1, -1), (2, 1, 1), True) + ["o slats"]
    for k in range(20):
        lines += box(corners, (-1, -0.9 + 0.09 * k, -0.95), (-0.7, -0.88 + 0.09 * k, 0.95))
    lines += ["o lamp", "usemtl lamp", "f -4 -3 -2 -1"]
    corners += [[-1.9, -0.8, -0.8], [-1.9, 0.8, -0.8], [-1.9, 0.8, 0.8], [-1.9, -0.8, 0.8]]
    return "\n".join(["mtllib hall.mtl"] + ["v %g %g %g" % tuple(at) for at in corners] + lines) + "\n"


HALL_MATERIALS = """newmtl wall
Kd 0.7 0.7 0.7
newmtl lamp
Kd 0 0 0
Ke 5 5 5
"""

# A room of 1 m, seen from inside: each wall an object of one face.
ROOM = """mtllib room.mtl
v 0 0 0
v 1 0 0
v 1 0 1
v 0 0 1
v 0 1 0
v 1 1 0
v 1 1 1
v 0 1 1
o floor
usemtl lamp
f 4 3 2 1
o ceiling
usemtl grey
f 5 6 7 8
o back
f 1 2 6 5
o front
f 3 4 8 7
o left
f 4 1 5 8
o right
f 2 3 7 6
"""
ROOM_MATERIALS = "newmtl lamp\nKd 0.5 0.5 0.5\nKe %.9f %.9f %.9f\nnewmtl grey\nKd 0.5 0.5 0.5\n" % ((1 / math.pi,) * 3)

# Radiosity of that room with E = 1 on its floor, and the form factor across it (Howell's C-11).
ROOM_TRUTH = {"floor": 1.0909090981, "ceiling": 0.1817458261, "left": 0.1818362689}
ACROSS = 0.199824895698


class Programs(unittest.TestCase):
    def setUp(self):
        self.began = time.monotonic()
        self.holder = tempfile.TemporaryDirectory()
        self.folder = self.holder.name

    def tearDown(self):
        print("%.1f s " % (time.monotonic() - self.began), end="")
        self.holder.cleanup()

    def path(self, name, text=None):
        path = os.path.join(self.folder, name)
        if text is not None:
            with open(path, "w") as file:
                file.write(text)
        return path

    def good(self, program, *arguments, **more):
        done = run(program, *arguments, **more)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done

    def bad(self, program, *arguments, says="", **more):
        """One line that names the trouble, a code, nothing on stdout and nothing written."""
        before = sorted(os.listdir(self.folder))
        done = run(program, *arguments, **more)
        self.assertGreater(done.returncode, 0, (arguments, done.stderr))
        self.assertEqual(done.stderr.count("\n"), 1, (arguments, done.stderr))
        self.assertIn(says, done.stderr)
        self.assertEqual(done.stdout, "")
        self.assertEqual(sorted(os.listdir(self.folder)), before)
        return done

    def test_buddha_records(self):
        out = self.path("out/deep")
        done = self.good("moving_buddha", "--frames", "2", "--size", "128x128", "--out", out, *CONTEXT)
        names = sorted(os.listdir(out))
        modes = ("direct", "global", "indirect")
        self.assertEqual(names, ["frame_0000_%s.png" % mode for mode in modes] + ["frames.csv"])
        for name in names[:3]:
            self.assertEqual(png_size(os.path.join(out, name)), (128, 128))
        rows = read_csv(os.path.join(out, "frames.csv"))
        self.assertEqual([row["outcome"] for row in rows], ["converged", "converged"])
        self.assertLess(int(rows[1]["dirty_entries"]), int(rows[1]["entries"]))
        self.assertLess(int(rows[1]["sweeps"]), int(rows[0]["sweeps"]))
        for words in (out, "frames.csv", "dirty entries", "certified bound", "per leaf", "sweeps"):
            self.assertIn(words, done.stdout)

    def test_start_is_told(self):
        """On a terminal what takes its time, each line over the one before; nothing anywhere else."""
        arguments = ["--frames", "1", "--row-tolerance", "0.2", "--images", self.path("p%d.png"), *TINY]
        told, code = on_terminal("moving_buddha", *arguments)
        self.assertEqual(code, 0, told)
        for words in ("compiling shaders ... 1 of", "building object 'buddha'", "first light: trace", "first picture"):
            self.assertIn("moving_buddha: " + words, told)
        self.assertNotIn("\n", told)
        done = self.good("moving_buddha", *arguments)
        self.assertEqual(done.stderr, "")
        self.assertRegex(done.stdout, r"its picture \d+\.\d\d s after the start")

    def test_budget_that_keeps_a_frame_rate(self):
        """Only that budgets are given and rows wait: what rate is reached is the machine's."""
        runs = {}
        for name, more in (("exact", []), ("rate", ["--budget-fps", "1000"]), ("none", ["--budget-fps", "0"]),
                           ("zero", ["--budget-fps", "1000", "--budget-ms", "0"]), ("own", ["--budget-ms", "0.5"])):
            report = self.path(name + ".csv")
            done = self.good("moving_buddha", "--frames", "3", "--row-tolerance", "0.2",
                             "--images", self.path("p%d.png"),
                             "--report", report, *more, *TINY)
            runs[name] = read_csv(report)
            self.assertIn("frames a second", done.stdout)
        for name, rows in runs.items():
            self.assertTrue(all(float(row["frames_per_second"]) > 0 for row in rows), name)
            waiting = [int(row["waiting_rows"]) for row in rows]
            budgets = [float(row["budget_ms"]) for row in rows]
            if name in ("rate", "own"):
                self.assertGreater(min(waiting[1:]), 0, name)
                self.assertGreater(min(float(row["stale_bound_w_per_m2"]) for row in rows[1:]), 0, name)
                self.assertGreater(min(budgets[1:]), 0, name)
            else:
                self.assertEqual(max(waiting + budgets), 0, name)

    def test_linear_pictures(self):
        """What is written before tone mapping adds up: direct and indirect light are the global one."""
        pixels = {}
        for mode in ("direct", "indirect", "global"):
            self.good("moving_buddha", "--frames", "1", "--row-tolerance", "0.2", "--mode", mode, "--linear",
                      self.path(mode + "%d.pfm"), "--out", self.path("out"), *TINY)
            with open(self.path(mode + "0.pfm"), "rb") as file:
                head, data = [file.readline() for _ in range(3)], file.read()
            self.assertEqual(head, [b"PF\n", b"64 48\n", b"-1.0\n"])
            pixels[mode] = struct.unpack("<%df" % (64 * 48 * 3), data)
        largest = max(pixels["global"])
        self.assertGreater(largest, 10)  # the lamp, where a picture is 1
        for k, value in enumerate(pixels["global"]):
            self.assertLess(abs(pixels["direct"][k] + pixels["indirect"][k] - value), 2e-3 * largest, k)

    def test_probes_are_shown(self):
        """Over the picture, in part of its pixels; without them there is nothing to show."""
        self.path("room.mtl", ROOM_MATERIALS)
        room, pixels, coarse = self.path("room.obj", ROOM), {}, ["--row-tolerance", "0.3", "--leaves", "200", *TINY]
        for name, arguments in (("plain", []), ("unseen", ["--probes", "0.4"]),
                                ("shown", ["--probes", "0.4", "--overlay", "receivers"])):
            self.good("gi_play", room, "--frames", "1", "--linear", self.path(name + "%d.pfm"), *arguments, *coarse)
            with open(self.path(name + "0.pfm"), "rb") as file:
                pixels[name] = file.read()
        self.assertEqual(pixels["plain"], pixels["unseen"])
        self.assertNotEqual(pixels["plain"], pixels["shown"])
        self.bad("gi_play", room, "--overlay", "receivers", says="--probes")
        self.bad("moving_buddha", "--overlay", "receivers", says="--overlay receivers")
        for text in ("0", "-1", "nan", "x"):
            self.bad("gi_play", room, "--probes", text, says="--probes " + text)
        done = run("gi_play", room, "--probes", "0.001", "--frames", "1", *coarse)
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, r"use 0\.0\d+ or more")

    def test_two_balls_under_a_budget(self):
        """What an exact frame takes is told after frames that were not; kinds of balls are options."""
        common = ["--frames", "2", "--row-tolerance", "0.3", "--caustic-photons", "64", "--out", self.path("out"),
                  *TINY]
        done = self.good("two_balls", "--balls", "glass,mirror", "--budget-ms", "1", *common)
        self.assertRegex(done.stdout, r"an exact frame, ms +\d+\.\d")
        with open(self.path("out/frame_0000_global.png"), "rb") as file:
            turned = file.read()
        done = self.good("two_balls", *common)
        self.assertNotIn("an exact frame", done.stdout)
        with open(self.path("out/frame_0000_global.png"), "rb") as file:
            self.assertNotEqual(file.read(), turned)

    def test_buddha_of_a_file(self):
        figure = self.path("figure.obj", PYRAMID)
        self.good("moving_buddha", "--mesh", figure, "--frames", "1", "--images", self.path("p%d.png"),
                  "--report", self.path("r.csv"), "--leaf-size", "1", *TINY)
        self.assertEqual(png_size(self.path("p0.png")), (64, 48))
        self.assertEqual(len(read_csv(self.path("r.csv"))), 1)

    def test_door_files(self):
        self.good("gi_play", DOOR, "--frames", "3", "--fps", "2", "--images", self.path("p%02d.png"),
                  "--report", self.path("r.csv"), "--field", self.path("f%d.ply"),
                  "--form-factors", self.path("F.csv"), *TINY)
        rows = read_csv(self.path("r.csv"))
        self.assertEqual([float(row["time_s"]) for row in rows], [0, 0.5, 1])
        for k, row in enumerate(rows):
            self.assertEqual(png_size(self.path("p%02d.png" % k)), (64, 48))
            vertices, faces = read_ply(self.path("f%d.ply" % k))
            self.assertEqual(len(faces), int(row["leaves"]))
            self.assertEqual(sorted(i for face in faces for i in face["corners"]), list(range(len(vertices))))
            self.assertEqual({face["object"] for face in faces}, set(range(7)))
            self.assertTrue(all(face["b_" + c] >= face["e_" + c] >= 0 for face in faces for c in "rgb"))
        factors = {(row["from"], row["to"]): float(row["F"]) for row in read_csv(self.path("F.csv"))}
        names = {pair[0] for pair in factors}
        self.assertEqual(len(factors), len(names) * (len(names) + 1))
        self.assertIn("lit room", names)
        for name in names:
            self.assertLessEqual(factors[name, "*"], 1 + 1e-6)
            self.assertAlmostEqual(sum(factors[name, to] for to in names), factors[name, "*"], delta=2e-2)

    def test_door_lets_light_through(self):
        self.good("gi_play", DOOR, "--frames", "2", "--fps", "0.5", "--field", self.path("f%d.ply"), *CONTEXT)
        table = 4 # in the dark room
        brightest = []
        for frame in range(2):
            faces = read_ply(self.path("f%d.ply" % frame))[1]
            brightest.append(max(face["b_g"] for face in faces if face["object"] == table))
        self.assertGreater(brightest[1], 10 * brightest[0])

    def test_rebuild_gives_the_same_light(self):
        for name, more in (("u", []), ("r", ["--rebuild"])):
            self.good("gi_play", DOOR, "--frames", "3", "--fps", "4", "--field", self.path(name + "%d.ply"),
                      "--report", self.path(name + ".csv"), *more, *CONTEXT)
        row = read_csv(self.path("r.csv"))[2]
        self.assertEqual(row["new_entries"], row["entries"])
        bound = float(row["solve_bound_w_per_m2"]) + float(read_csv(self.path("u.csv"))[2]["solve_bound_w_per_m2"])
        for a, b in zip(read_ply(self.path("u2.ply"))[1], read_ply(self.path("r2.ply"))[1]):
            for c in ("b_r", "b_g", "b_b"):
                self.assertAlmostEqual(a[c], b[c], delta=bound + 1e-5 * max(a[c], 1))

    def test_obj_room_is_true(self):
        self.path("room.mtl", ROOM_MATERIALS)
        self.good("gi_play", self.path("room.obj", ROOM), "--leaf-size", "10", "--field", self.path("f%d.ply"),
                  "--form-factors", self.path("F.csv"), "--solve-tolerance", "1e-6", "--row-tolerance", "0.0005",
                  *CONTEXT)
        faces = read_ply(self.path("f0.ply"))[1]
        names = [row["from"] for row in read_csv(self.path("F.csv")) if row["to"] == "*"]
        self.assertEqual(names, ["floor", "ceiling", "back", "front", "left", "right"])
        self.assertEqual([face["object"] for face in faces], list(range(6)))
        for name, truth in ROOM_TRUTH.items():
            self.assertAlmostEqual(faces[names.index(name)]["b_g"], truth, delta=0.005 * truth)
        rows = read_csv(self.path("F.csv"))
        across = [float(row["F"]) for row in rows if (row["from"], row["to"]) == ("left", "right")]
        self.assertAlmostEqual(across[0], ACROSS, delta=0.005 * ACROSS)

    def test_sky_lights_what_is_convex(self):
        self.good("gi_play", self.path("pyramid.obj", PYRAMID), "--sky", "2", "--leaf-size", "4", "--field",
                  self.path("f%d.ply"), *CONTEXT)
        faces = read_ply(self.path("f0.ply"))[1]
        self.assertEqual(sorted(len(face["corners"]) for face in faces), [3, 3, 3, 3, 4])
        for face in faces: # each sees sky alone: B = rho * 2
            self.assertAlmostEqual(face["b_r"], face["rho_r"] * 2, delta=1e-3)

    def test_empty_scene_is_black(self):
        scene = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": []}]}
        empty = self.path("empty.gltf", json.dumps(scene))
        self.good("gi_play", empty, "--images", self.path("p%d.png"), "--field", self.path("f%d.ply"),
                  "--form-factors", self.path("F.csv"), *TINY)
        self.assertEqual(read_ply(self.path("f0.ply")), ([], []))
        self.assertEqual(read_csv(self.path("F.csv")), [])

    def test_bad_options(self):
        for arguments in (["--nonsense"], ["--frames"], ["--frames", "0"], ["--frames", "1e99"], ["--fps", "-1"],
                          ["--fps", "nan"], ["--size", "0x5"], ["--size", "5"], ["--size", "5x5x"], ["--mode", "all"],
                          ["--overlay", "all"], ["--overlay", "senders:x"],
                          ["--context", "x"], ["--row-tolerance", "2"], ["--row-tolerance", "1e-9"],
                          ["--row-tolerance", "1e-6"],
                          ["--leaf-size", "0"], ["--leaf-size", "1e-50"], ["--solve-tolerance", "1e-40"],
                          ["--solve-tolerance", "x"], ["--images", "frame.png"], ["--images", "%s.png"],
                          ["--sky", "-1"],
                          ["--field", "%d%d"], ["--report", ""], ["--cage-faces", "1"],
                          ["--budget-fps", "-1"], ["--budget-fps", "x"], ["--budget-ms", "-0.5"], ["--budget-ms", ""]):
            self.bad("moving_buddha", *arguments, says=arguments[0])
            self.bad("gi_play", DOOR, *arguments, says=arguments[0])
        for text in ("glass", "glass,", "glass,glas", "mirror,mirror,glass"):
            self.bad("two_balls", "--balls", text, says="--balls " + text)
        self.bad("moving_buddha", "--shadow-map", "32", says="--shadow-map")
        self.bad("moving_buddha", "--caustic-photons", "-1", says="--caustic-photons")
        self.bad("moving_buddha", "--levels", "9", says="--levels")
        self.bad("moving_buddha", "scene.gltf", says="scene.gltf")
        self.bad("gi_play", says="scene")
        self.bad("gi_play", DOOR, DOOR, says=DOOR)

    def test_bad_scenes(self):
        scenes = {"missing.gltf": None, "broken.gltf": "{", "cut.glb": "glTF", "scene.txt": "x", "empty.obj": "",
                  "nan.obj": "v 0 0 0\nv 1 0 0\nv nan 1 0\nf 1 2 3\n"}
        for name, text in scenes.items():
            path = self.path(name, text)
            self.bad("gi_play", path, "--report", self.path("r.csv"), *TINY, says=name)
            self.bad("moving_buddha", "--frames", "1", "--mesh", path, *TINY, says=name)

    def test_nowhere_to_write(self):
        outputs = (("--images", "p%d.png"), ("--field", "f%d.ply"), ("--report", "r.csv"), ("--form-factors", "F.csv"))
        for option, name in outputs:
            place = os.path.join(self.folder, "absent", name)
            self.bad("gi_play", DOOR, "--frames", "1", option, place, *TINY, says=place.replace("%d", "0"))
        self.path("file", "")
        self.bad("moving_buddha", "--frames", "1", "--out", self.path("file/out"), *TINY, says="file")
        if os.path.exists("/dev/full"):
            self.bad("gi_play", DOOR, "--frames", "1", "--form-factors", "/dev/full", *TINY, says="/dev/full")
            self.bad("gi_play", DOOR, "--frames", "1", "--report", "/dev/full", *TINY, says="/dev/full")

    def test_unusable_names_are_told_first(self):
        """Whatever keeps a frame's file from being written is told before a scene is built."""
        self.path("file", "")
        os.mkdir(self.path("q1.png"))
        long_name = self.path("n" * 251 + "%d.png")
        for option in ("--images", "--field", "--linear"):
            for pattern, frames in ((self.path("absent/p%d.png"), "2"), (self.path("file/p%d.png"), "2"),
                                    (self.path("d%d/p.png"), "2"), (self.path("q%d.png"), "2"), (long_name, "2"),
                                    (self.path("n" * 247 + "%d.png"), "100000"), ("/proc/p%d.png", "2")):
                began = time.monotonic()
                self.bad("gi_play", DOOR, "--frames", frames, option, pattern, "--context", "glfw", says="cannot write")
                self.assertLess(time.monotonic() - began, 60)
        for option in ("--report", "--form-factors"):
            for name in (self.folder, self.path("file/r.csv"), self.path("r" * 300)):
                self.bad("gi_play", DOOR, "--frames", "1", option, name, *TINY, says="cannot write")

    def limited(self, bytes_of_a_file, *arguments):
        """The program where no file may be larger: what a full disk does to it."""
        limit = lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (bytes_of_a_file, bytes_of_a_file))
        return subprocess.run([os.path.join(PROGRAMS, "gi_play"), *arguments], capture_output=True, text=True,
                              timeout=300,
                              preexec_fn=limit, env=dict(os.environ, MESA_SHADER_CACHE_DISABLE="true"))

    def test_full_disk_leaves_no_halves(self):
        before = "what was there before"
        for option, name in (("--images", "p%d.png"), ("--field", "f%d.ply"), ("--form-factors", "F.csv")):
            place = self.path(name % 0 if "%" in name else name, before)
            done = self.limited(300, DOOR, "--frames", "1", "--row-tolerance", "0.2", option, self.path(name), *TINY)
            self.assertEqual(done.returncode, 1, done.stderr)
            self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
            self.assertIn("cannot write " + place, done.stderr)
            with open(place) as file:
                self.assertEqual(file.read(), before)
            os.unlink(place)
        self.assertEqual(os.listdir(self.folder), [])
        done = self.limited(4096, DOOR, "--frames", "20", "--row-tolerance", "0.2", "--report", self.path("r.csv"),
                            *TINY)
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn("cannot write " + self.path("r.csv"), done.stderr)
        with open(self.path("r.csv")) as file:
            text = file.read()
        self.assertTrue(text.endswith("\n"))
        rows = read_csv(self.path("r.csv"))
        self.assertGreater(len(rows), 2)
        self.assertTrue(all(row["frames_per_second"] for row in rows))

    def test_signal_leaves_whole_files(self):
        for number in (signal.SIGTERM, signal.SIGINT):
            out = self.path("s%d" % number)
            os.mkdir(out)
            command = [os.path.join(PROGRAMS, "gi_play"), DOOR, "--frames", "100000", "--row-tolerance", "0.2",
                       "--images", os.path.join(out, "p%d.png"), "--report", os.path.join(out, "r.csv"), *TINY]
            with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as running:
                while running.poll() is None and not os.path.exists(os.path.join(out, "p3.png")):
                    time.sleep(0.02)
                running.send_signal(number)
                told = running.communicate(timeout=120)[1]
            self.assertEqual(running.returncode, -number, told)
            self.assertRegex(told, r"^gi_play: stopped (after \d+ frames|before the frame was done)\n$")
            rows = read_csv(os.path.join(out, "r.csv"))
            self.assertTrue(all(row["frames_per_second"] for row in rows))
            pictures = [name for name in os.listdir(out) if name != "r.csv"]
            whole = told.split()[2] == "after"
            self.assertIn(len(pictures) - len(rows), [0] if whole else [0, 1])
            self.assertEqual(sorted(pictures), sorted("p%d.png" % k for k in range(len(pictures))))
            if whole:
                self.assertEqual(int(told.split()[3]), len(rows))
            for name in pictures:
                with open(os.path.join(out, name), "rb") as file:
                    self.assertEqual(file.read()[-8:-4], b"IEND")

    def test_signal_ends_a_long_frame(self):
        """700 boxes in a room: their first light takes minutes, the program a second to end."""
        if "RELUME_SANITIZED" in os.environ:
            self.skipTest("a minute under sanitizers, for nothing that the shorter frames do not run")
        lines, count = ["mtllib lamp.mtl", "usemtl lamp"], 0
        for k in range(701):
            x, y, z, size = (0, 0, 0, 20) if k == 700 else (k % 9 * 2.1 + 0.3, k // 9 % 9 * 2.1 + 0.3,
                                                            k // 81 * 2.1 + 0.3, 1)
            lines += ["o box%d" % k] + ["v %g %g %g" % (x + c % 2 * size, y + c // 2 % 2 * size, z + c // 4 * size)
                                        for c in range(8)]
            for face in ("3 4 2 1", "5 6 8 7", "1 2 6 5", "7 8 4 3", "5 7 3 1", "4 8 6 2"):
                corners = [str(8 * k + int(c)) for c in face.split()]
                lines.append("f " + " ".join(corners if k < 700 else reversed(corners)))
        with open(self.path("boxes.obj"), "w") as file:
            file.write("\n".join(lines) + "\n")
        with open(self.path("lamp.mtl"), "w") as file:
            file.write("newmtl lamp\nKd 0.5 0.5 0.5\nKe 1 1 1\n")
        for number, times in ((signal.SIGTERM, 1), (signal.SIGINT, 2)):
            out = self.path("long%d" % number)
            os.mkdir(out)
            master, terminal = os.openpty() # it tells a terminal what it does
            command = [os.path.join(PROGRAMS, "gi_play"), self.path("boxes.obj"), "--frames", "2", "--row-tolerance",
                       "0.001", "--images", os.path.join(out, "p%d.png"), "--report", os.path.join(out, "r.csv"), *TINY]
            with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=terminal) as running:
                os.close(terminal)
                told = b""
                while b"first light" not in told:
                    told += os.read(master, 4096)
                time.sleep(0.2)
                self.assertIsNone(running.poll(), told)
                began = time.monotonic()
                for _ in range(times):
                    running.send_signal(number)
                while b"stopped" not in told:
                    told += os.read(master, 4096)
                running.wait(timeout=30)
            os.close(master)
            took = time.monotonic() - began
            print("%d signals: ended after %.2f s" % (times, took))
            self.assertEqual(running.returncode, -number, told)
            self.assertIn(b"gi_play: stopped before the frame was done", told)
            self.assertEqual(os.listdir(out), [])
            self.assertLess(took, 60) # a second, on a machine that does nothing else; the light takes minutes

    def test_full_standard_output(self):
        if not os.path.exists("/dev/full"):
            self.skipTest("no /dev/full")
        for program, arguments in (("gi_play", ["--help"]), ("moving_buddha", ["--help"]),
                                   ("gi_play", [DOOR, "--frames", "1", "--row-tolerance", "0.2", "--images",
                                                self.path("p%d.png"), *TINY])):
            with open("/dev/full", "w") as full:
                done = subprocess.run([os.path.join(PROGRAMS, program), *arguments], stdout=full,
                                      stderr=subprocess.PIPE,
                                      text=True, timeout=300)
            self.assertEqual(done.returncode, 1, (program, arguments, done.stderr))
            self.assertRegex(done.stderr, "^%s: cannot write to standard output: .*\n$" % program)

    def test_closed_standard_output(self):
        """What is printed then goes nowhere, least of all into a file that was opened since."""
        for number in (0, 1, 2):
            done = subprocess.run([os.path.join(PROGRAMS, "gi_play"), DOOR, "--frames", "1", "--row-tolerance", "0.2",
                                   "--report", self.path("r.csv"), *TINY], preexec_fn=lambda: os.close(number),
                                  capture_output=True, text=True, timeout=300)
            self.assertEqual(done.returncode, 1 if number == 1 else 0, done.stderr)
            with open(self.path("r.csv")) as file:
                self.assertEqual(len(file.read().splitlines()), 2)
            if number == 1:
                self.assertIn("cannot write to standard output", done.stderr)

    def test_outputs_that_are_no_plain_files(self):
        """Devices, pipes and links are written as they are; modes of files stay."""
        common = ["--frames", "1", "--row-tolerance", "0.2", *TINY]
        done = self.good("gi_play", DOOR, "--form-factors", "/dev/stdout", *common)
        self.assertIn("from,to,F\n", done.stdout)
        self.assertIn("certified bound", done.stdout)
        with open(self.path("both"), "w") as both:
            subprocess.run([os.path.join(PROGRAMS, "gi_play"), DOOR, "--form-factors", "/dev/stdout", *common],
                           stdout=both,
                           check=True, timeout=300)
        with open(self.path("both")) as file:
            self.assertIn("certified bound", file.read())
        real = self.path("real.csv", "old")
        os.chmod(real, 0o640)
        os.symlink("real.csv", self.path("link.csv"))
        self.good("gi_play", DOOR, "--form-factors", self.path("link.csv"), *common)
        self.assertTrue(os.path.islink(self.path("link.csv")))
        self.assertEqual(os.stat(real).st_mode & 0o777, 0o640)
        self.assertGreater(len(read_csv(real)), 6)
        os.mkfifo(self.path("pipe"))
        with subprocess.Popen(["cat", self.path("pipe")], stdout=subprocess.PIPE, text=True) as reader:
            self.good("gi_play", DOOR, "--form-factors", self.path("pipe"), *common)
            self.assertTrue(reader.communicate(timeout=60)[0].startswith("from,to,F\n"))
        self.assertEqual(sorted(os.listdir(self.folder)), ["both", "link.csv", "pipe", "real.csv"])

    def test_names_stay_one_line(self):
        with open(DOOR) as file:
            scene = json.load(file)
        for node in scene["nodes"]:
            node["name"] = "a\nb\r\"c,%s" % node.get("name", "")
        name = self.path("two\nlines.gltf", json.dumps(scene))
        done = self.good("gi_play", name, "--frames", "1", "--row-tolerance", "0.2",
                         "--form-factors", self.path("F.csv"),
                         "--field", self.path("f%d.ply"), *TINY)
        self.assertIn("two lines.gltf: 1 frames", done.stdout)
        with open(self.path("F.csv")) as file:
            lines = file.read().splitlines()
        self.assertEqual(len(lines), 1 + 7 * 8)
        self.assertTrue(all(row["from"].startswith('a b "c,') for row in read_csv(self.path("F.csv"))))
        self.assertEqual(len(read_ply(self.path("f0.ply"))[1]) > 0, True)
        for material in scene["materials"]:
            material.pop("emissiveFactor", None)
        dark = self.path("two\nlines, dark.gltf", json.dumps(scene))
        done = self.good("gi_play", dark, "--frames", "1", "--row-tolerance", "0.2", "--images", self.path("p%d.png"),
                         *TINY)
        self.assertIn("two lines, dark.gltf: nothing in it emits light", done.stderr)
        self.assertTrue(all(line.startswith("gi_play: ") for line in done.stderr.splitlines()), done.stderr)
        self.bad("gi_play", self.path("no\nsuch\x1b[2J.gltf"), *TINY, says="no such")
        self.bad("gi_play", DOOR, "--mode", "a\nb", says="--mode")
        self.bad("moving_buddha", "--images", "a\nb.png", says="--images")

    def test_a_pipe_is_no_scene(self):
        for name in ("s.gltf", "s.glb", "s.obj", "s.ply"):
            os.mkfifo(self.path(name))
            self.bad("gi_play", self.path(name), *TINY, says=name)
            self.bad("moving_buddha", "--mesh", self.path(name), *TINY, says=name)
            self.bad("gi_play", self.folder, *TINY, says=self.folder)

    def test_no_opengl_45(self):
        # Mesa heeds the override, drivers of others do not: EGL is shown Mesa alone.
        old = {"MESA_GL_VERSION_OVERRIDE": "3.3", "DISPLAY": "", "WAYLAND_DISPLAY": "",
               "__EGL_VENDOR_LIBRARY_FILENAMES": "/usr/share/glvnd/egl_vendor.d/50_mesa.json"}
        self.bad("moving_buddha", "--frames", "1", "--context", "auto", environment=old, says="4.5")
        self.bad("moving_buddha", "--frames", "1", "--context", "egl", environment=old, says="4.5")
        self.bad("gi_play", DOOR, "--frames", "1", "--context", "glfw", environment=old, says="display")

    def test_too_fine(self):
        self.bad("moving_buddha", "--frames", "1", "--leaf-size", "1e-5", "--report", self.path("r.csv"), *TINY,
                 says="leaves")

    def test_leaves_are_chosen(self):
        """Two rooms of one polygon a wall, the floor going through under the wall between them, and no options."""
        self.path("hall.mtl", HALL_MATERIALS)
        hall = self.path("hall.obj", HALL)
        for options in ([], ["--leaf-size", "0.5"], ["--leaf-size", "0.27"], ["--leaves", "500"]):
            done = self.good("gi_play", hall, "--field", self.path("f%d.ply"), "--report", self.path("r.csv"), *options,
                             *CONTEXT)
            leaves = int(read_csv(self.path("r.csv"))[0]["leaves"])
            self.assertIn("%d leaves of" % leaves, done.stderr)
            self.assertIn("--leaf-size", done.stderr)
            if not options or "--leaves" in options:
                wanted = int(options[1]) if options else 4000
                self.assertTrue(0.7 * wanted < leaves < 1.3 * wanted, (leaves, wanted))
            vertices, faces = read_ply(self.path("f0.ply"))
            middles = [[sum(vertices[i][k] for i in face["corners"]) / len(face["corners"]) for k in range(3)]
                       for face in faces]
            lit = max(face["b_g"] for face, at in zip(faces, middles) if at[0] < 1.5 and face["e_g"] == 0)
            dark = max(face["b_g"] for face, at in zip(faces, middles) if at[0] > 1.7)
            print("%s: %d leaves, lit room at most %.3g, dark room %.3g W/m2" % (options, leaves, lit, dark), end=" ")
            self.assertGreater(lit, 0.3)
            self.assertEqual(dark, 0)

    def test_detailed_meshes_get_cages(self):
        """A ball of 5,000 faces, which is no cage: as many as its share of the leaves, or as many as asked for."""
        rings, around = 50, 100
        lines = ["v %g %g %g" % (math.sin(math.pi * j / rings) * math.cos(2 * math.pi * i / around),
                                 math.cos(math.pi * j / rings),
                                 math.sin(math.pi * j / rings) * math.sin(2 * math.pi * i / around))
                 for j in range(rings + 1) for i in range(around)]
        number = lambda i, j: j * around + i % around + 1
        lines += ["f %d %d %d %d" % (number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1))
                  for j in range(rings) for i in range(around)]
        ball = self.path("ball.obj", "\n".join(lines) + "\n")
        for options, most in (([], 2000), (["--cage-faces", "300"], 300), (["--leaves", "2000"], 1000)):
            done = self.good("gi_play", ball, "--sky", "1", "--report", self.path("r.csv"),
                             "--field", self.path("f%d.ply"),
                             *options, *TINY)
            self.assertIn("cage of", done.stderr)
            leaves = int(read_csv(self.path("r.csv"))[0]["leaves"])
            # How near it comes depends on the simplifier: Debian 13's leaves 206 of 300.
            self.assertTrue(0.6 * most < leaves <= most, (options, leaves))
            print("%s: %d leaves" % (options, leaves), end=" ")

    def test_error_is_estimated(self):
        """Of pictures that are kept, unless it is turned off."""
        self.path("hall.mtl", HALL_MATERIALS)
        hall = self.path("hall.obj", HALL)
        report = ["--report", self.path("r.csv")]
        for options, wanted in ((["--images", self.path("p%d.png")], True), ([], False),
                                (["--images", self.path("p%d.png"), "--estimate", "0"], False)):
            done = self.good("gi_play", hall, "--frames", "1", "--leaves", "300", *report, *options, *TINY)
            self.assertEqual(int(read_csv(self.path("r.csv"))[0]["sampling_rays"]) > 0, wanted)
            self.assertNotIn("off by", done.stderr)
        done = self.good("gi_play", self.path("slats.obj", slats()), "--frames", "1", "--leaf-size", "2",
                         "--row-tolerance", "1", "--images", self.path("p%d.png"), *TINY)
        self.assertIn("off by", done.stderr)

    def test_too_many_leaves_are_refused(self):
        self.path("hall.mtl", HALL_MATERIALS)
        hall = self.path("hall.obj", HALL)
        began = time.monotonic()
        self.bad("gi_play", hall, "--frames", "1", "--leaf-size", "0.0005", *TINY, says="would be 40")
        print("%.1f s" % (time.monotonic() - began), end=" ")
        told = self.bad("gi_play", hall, "--frames", "1", "--leaf-size", "0.0005", *TINY,
                        says="(--leaf-size, --leaves)").stderr
        fitting = re.search(r"a leaf size of (\S+) fits", told).group(1)
        self.assertTrue(0.01 < float(fitting) < 0.1, fitting)


sys.exit(suite.run(Programs, *sys.argv[3:4]))
