#!/usr/bin/env python3
"""Plays scene files as they come: turned faces, closed rooms, materials and shapes that not every reader takes.

    test_scene_files.py FOLDER_OF_PROGRAMS SOURCE_FOLDER [PART/PARTS]

The files are written here; where ../shared/cases is, its files are played too. Parts and last lines are
tests/suite.py's.
"""
import os
import subprocess
import sys
import tempfile
import time
import unittest

sys.path.append(os.path.join(os.path.dirname(__file__), ".."))
import fields
import headless
import suite

PROGRAMS, SOURCE = sys.argv[1], sys.argv[2]
CASES = os.path.join(SOURCE, "..", "shared", "cases")
SMALL = ["--context", headless.CONTEXT, "--size", "32x32", "--frames", "1"]

MATERIALS = """newmtl wall
Kd 0.7 0.7 0.7
newmtl lamp
Kd 0.5 0.5 0.5
Ke 10 10 10
"""

# Corners of a box: x runs fastest, then y, then z. Faces look inward.
WALLS = ["1 2 4 3", "7 8 6 5", "5 6 2 1", "3 4 8 7", "1 3 7 5", "2 6 8 4"]


def room(walls, width=3, height=2, depth=4, lamp="9 10 11 12"):
    """A box of rho 0.7 with a lamp of 0.5 m2 below its ceiling, as an OBJ."""
    lines = ["mtllib room.mtl"]
    for corner in range(8):
        lines.append("v %g %g %g" % (corner % 2 * width, corner // 2 % 2 * height, corner // 4 * depth))
    for x, z in ((1, 1), (2, 1), (2, 1.5), (1, 1.5)):
        lines.append("v %g %g %g" % (x, 0.95 * height, z))
    return "\n".join(lines + ["o room", "usemtl wall"] + ["f " + wall for wall in walls] +
                     ["o lamp", "usemtl lamp", "f " + lamp]) + "\n"


def turned(wall):
    return " ".join(reversed(wall.split()))


class SceneFiles(unittest.TestCase):
    def setUp(self):
        self.began = time.monotonic()
        self.holder = tempfile.TemporaryDirectory()
        self.folder = self.holder.name
        self.path("room.mtl", MATERIALS)

    def tearDown(self):
        print("%.1f s " % (time.monotonic() - self.began), end="")
        self.holder.cleanup()

    def path(self, name, text=None):
        path = os.path.join(self.folder, name)
        if text is not None:
            with open(path, "w") as file:
                file.write(text)
        return path

    def play(self, scene, *arguments, code=0):
        """What it says on stderr, but for the line that every file without leaves of its own gets."""
        done = subprocess.run([os.path.join(PROGRAMS, "gi_play"), scene, "--field", self.path("f%d.ply"), "--images",
                               self.path("p%d.png"), *SMALL, *arguments], capture_output=True, text=True, timeout=300)
        self.assertEqual(done.returncode, code, (scene, done.stderr))
        return "".join(line for line in done.stderr.splitlines(True) if "(--leaf-size, --leaves)" not in line)

    def light(self, of=lambda face: True):
        return fields.mean_radiosity(self.path("f0.ply"), of)

    def walls(self):
        return self.light(lambda face: face["object"] == 0)

    def picture(self):
        """Mean of the picture's bytes as they are filtered, mostly as differences: all black gives 0."""
        import struct
        import zlib
        with open(self.path("p0.png"), "rb") as file:
            data = file.read()
        at, packed = 8, b""
        while at < len(data):
            size, kind = struct.unpack(">I4s", data[at:at + 8])
            packed += data[at + 8:at + 8 + size] if kind == b"IDAT" else b""
            at += 12 + size
        return sum(zlib.decompress(packed)) / 3072

    def test_turned_faces_are_turned_back(self):
        self.play(self.path("right.obj", room(WALLS)), "--leaf-size", "0.5")
        right = self.walls()
        for wrong in ([3], [0, 4], [0, 1, 2, 3, 4, 5]):
            walls = [turned(wall) if k in wrong else wall for k, wall in enumerate(WALLS)]
            told = self.play(self.path("turned.obj", room(walls)), "--leaf-size", "0.5")
            found = self.walls()
            print("walls %s turned: B %.4f of %.4f W/m2" % (wrong, found[1], right[1]))
            self.assertIn("lit from behind alone are turned round (%d, first" % len(wrong), told)
            self.assertAlmostEqual(found[1], right[1], delta=0.002 * right[1])
            self.assertGreater(self.picture(), 20)
            self.play(self.path("turned.obj", room(walls)), "--leaf-size", "0.5", "--two-sided=off")
            self.assertLess(self.walls()[1], 0.9 * right[1])

    def test_walls_of_two_rooms_in_one_plane_stay(self):
        # Which of two walls in one place a ray meets first is a matter of rounding, unless it is who looks at it.
        def rooms(dark_first, cosine, sine, overlap=0):
            lit, dark = ([(x + k % 2 * w, k // 2 % 2 * 2.3, k // 4 * 4.1) for k in range(8)] for x, w in
                         ((0, 3.1), (3.1 - overlap, 2.2)))
            lamp = [(x, 2.2, z) for x, z in ((1, 1), (1.7, 1), (1.7, 1.6), (1, 1.6))]
            lines = ["mtllib room.mtl"] + ["v %.7f %.7f %.7f" % (cosine * x - sine * z, y, sine * x + cosine * z)
                                           for x, y, z in lit + dark + lamp]
            walls = [["o lit", "usemtl wall"] + ["f " + wall for wall in WALLS], ["o dark", "usemtl wall"] +
                     ["f " + " ".join(str(int(k) + 8) for k in wall.split()) for wall in WALLS]]
            lines += sum(reversed(walls) if dark_first else walls, []) + ["o lamp", "usemtl lamp", "f 17 18 19 20"]
            return "\n".join(lines) + "\n"
        for dark_first in (False, True):
            for cosine, sine in ((1, 0), (0.8, 0.6)):
                told = self.play(self.path("rooms.obj", rooms(dark_first, cosine, sine)), "--leaf-size", "0.5")
                dark = self.light(lambda face: face["object"] == (0 if dark_first else 1))
                print("dark room, %s, %g: B %.4f" % ("first" if dark_first else "second", sine, dark[1]))
                self.assertNotIn("turned", told)
                self.assertEqual(dark[1], 0)
        # What is reflected in all, and how much of the dark room is lit: its wall's back, where it lies in the lit one.
        area, mean = self.light(lambda face: face["object"] < 2)
        for overlap in (1e-5, 1e-3):
            told = self.play(self.path("rooms.obj", rooms(False, 0.8, 0.6, overlap)), "--leaf-size", "0.5")
            both = self.light(lambda face: face["object"] < 2)
            lit = self.light(lambda face: face["object"] == 1 and face["b_g"] > 0.05)
            print("rooms %g m into one another: flux %.4f of %.4f, lit %.3f of 9.43 m2" %
                  (overlap, both[0] * both[1], area * mean, lit[0]))
            self.assertIn("get two sides", told)
            self.assertAlmostEqual(both[0] * both[1], area * mean, delta=0.01 * area * mean)
            self.assertAlmostEqual(lit[0], 2.3 * 4.1, delta=0.01)

    def test_two_sides_for_all(self):
        self.play(self.path("right.obj", room(WALLS)), "--leaf-size", "0.5")
        right = self.walls()
        walls = [turned(WALLS[0])] + WALLS[1:]
        told = self.play(self.path("turned.obj", room(walls)), "--leaf-size", "0.5", "--two-sided")
        inside = self.light(lambda face: face["object"] == 0 and face["b_g"] > 0)
        print("two sides for all: inside B %.4f of %.4f W/m2" % (inside[1], right[1]))
        self.assertAlmostEqual(inside[0], right[0], delta=1e-3 * right[0])
        self.assertAlmostEqual(inside[1], right[1], delta=0.01 * right[1])
        self.assertIn("the camera stands where light falls", told)
        self.assertGreater(self.picture(), 20)

    def test_a_room_below_a_sky_shows_its_outside(self):
        lampless = room(WALLS).split("o lamp")[0]
        for path in (self.path("room.obj", lampless), self.path("alone.obj", lampless.replace("mtllib room.mtl", ""))):
            self.assertIn("no face looks at the sky", self.play(path, "--sky", "2", "--leaf-size", "0.5"))
            self.assertGreater(self.light()[1], 0.5)
            self.assertGreater(self.picture(), 0)
        self.assertEqual(self.play(path, "--sky", "2", "--leaf-size", "0.5", "--two-sided=off").count("sky"), 0)
        self.assertEqual(self.light()[1], 0)
        opened = "\n".join(line for line in lampless.splitlines() if line != "f " + WALLS[3])
        self.assertNotIn("no face looks", self.play(self.path("open.obj", opened + "\n"), "--sky", "2"))

    def test_right_rooms_stay_as_they_are(self):
        self.assertEqual(self.play(self.path("right.obj", room(WALLS))), "")
        self.assertGreater(self.picture(), 20)

    def test_open_ground_is_seen_from_above(self):
        """Below a lamp as large as itself, level and on a slope; and beside a lit closed box, where a sky lights it."""
        def ground(height, lamp, slope):
            corners = [(x, 0, z) for x, z in ((-5, -5), (-5, 5), (5, 5), (5, -5))]
            corners += [(lamp * x, height, lamp * z) for x, z in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
            return "\n".join(["mtllib room.mtl"] + ["v %g %g %g" % (x, y + slope * x, z) for x, y, z in corners] +
                             ["o ground", "usemtl wall", "f 1 2 3 4", "o lamp", "usemtl lamp", "f 5 6 7 8"]) + "\n"
        for height, lamp, slope in ((5, 5, 0), (2, 0.5, 0), (2, 0.5, 1), (0.3, 3, 0.2)):
            told = self.play(self.path("ground.obj", ground(height, lamp, slope)), "--row-tolerance", "0.5")
            print("lamp of %g m, %g m above, slope %g: picture %.1f" % (2 * lamp, height, slope, self.picture()))
            self.assertEqual(told, "")
            self.assertGreater(self.picture(), 5)
        # The lamp shut in below a lid that is turned down, so that it is seen from nowhere.
        shut = ground(0.3, 0.1, 0) + "\n".join(
            ["v %g %g %g" % (0.2 * (2 * (k % 2) - 1), 0.4 * (k // 2 % 2), 0.2 * (2 * (k // 4) - 1)) for k in range(8)] +
            ["o box", "usemtl wall"] + ["f " + " ".join(str(8 + int(c)) for c in reversed(wall.split()))
                                        for wall in WALLS]) + "\n"
        self.assertIn("nothing lit is seen", self.play(self.path("shut.obj", shut), "--row-tolerance", "0.5",
                                                       "--two-sided=off"))
        self.assertNotIn("nothing lit is seen", self.play(self.path("shut.obj", shut), "--row-tolerance", "0.5",
                                                          "--two-sided=off", "--sky", "2"))
        self.assertEqual(self.play(self.path("ground.obj", ground(2, 0.5, 0)), "--row-tolerance", "0.5", "--sky", "0"),
                         "")

    def test_a_camera_that_sees_backs_is_told(self):
        # A unit square that is a lamp towards +z and a camera behind it.
        import base64
        import json
        import struct
        numbers = base64.b64encode(struct.pack("<12f6H", 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 1, 2, 0, 2, 3)).decode()
        scene = {"asset": {"version": "2.0"}, "nodes": [{"mesh": 0}, {"camera": 0, "translation": [0.5, 0.5, 1]}],
                 "cameras": [{"perspective": {"yfov": 0.7}}], "materials": [{"emissiveFactor": [1, 1, 1]}],
                 "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
                 "buffers": [{"byteLength": 60, "uri": "data:;base64," + numbers}],
                 "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 12}],
                 "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
                               {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"}]}
        self.assertEqual(self.play(self.path("before.gltf", json.dumps(scene))), "")
        scene["nodes"][1].update(translation=[0.5, 0.5, -1], rotation=[0, 1, 0, 0])
        self.assertIn("sees backs of faces", self.play(self.path("behind.gltf", json.dumps(scene))))

    def test_a_bad_choice_of_sides_is_told(self):
        done = subprocess.run([os.path.join(PROGRAMS, "gi_play"), "x.obj", "--two-sided=maybe"], capture_output=True,
                              text=True)
        self.assertEqual(done.returncode, 2)
        self.assertIn("must be on, off or auto", done.stderr)

    def test_white_is_told_once(self):
        self.path("room.mtl", MATERIALS.replace("Kd 0.5 0.5 0.5", "Kd 1 1 1"))
        told = self.play(self.path("white.obj", room(WALLS)))
        self.assertEqual(told.count("0.98"), 1, told)
        self.path("room.mtl", MATERIALS + "newmtl spare\nKd 1 1 1\n")
        self.assertEqual(self.play(self.path("white.obj", room(WALLS))), "")

    def test_concave_faces_keep_their_area(self):
        # An L of 3 m2 under a sky of 1 W/m2: B is rho, everywhere.
        text = "v 0 0 0\nv 2 0 0\nv 2 0 -1\nv 1 0 -1\nv 1 0 -2\nv 0 0 -2\nf 4 5 6 1 2 3\n"
        for more in ([], ["--leaf-size", "0.25"]):
            self.play(self.path("l.obj", text), "--sky", "1", *more)
            area, radiosity = self.light()
            print("L of 3 m2 %s: %.6f m2, B %.5f of 0.5" % (" ".join(more), area, radiosity))
            self.assertAlmostEqual(area, 3, delta=1e-5)
            self.assertAlmostEqual(radiosity, 0.5, delta=1e-3)

    def test_map_coordinates(self):
        self.play(self.path("here.obj", room(WALLS)), "--leaf-size", "0.5")
        here = self.walls()
        lines = [line if not line.startswith("v ") else "v %.4f %.4f %.4f" % tuple(
            float(x) + shift for x, shift in zip(line.split()[1:], (500000.5, 30, 5800000.25)))
            for line in room(WALLS).splitlines()]
        told = self.play(self.path("map.obj", "\n".join(lines) + "\n"), "--leaf-size", "0.5")
        there = self.walls()
        print("the room at 500 km, 5,800 km: area %.5f of %.5f, B %.5f of %.5f" %
              (there[0], here[0], there[1], here[1]))
        self.assertIn("far from the origin", told)
        self.assertAlmostEqual(there[0], here[0], delta=1e-3)
        self.assertAlmostEqual(there[1], here[1], delta=0.005 * here[1])

    def linear(self, row):
        """A row of the picture's radiances, from below: r g b of each pixel."""
        import struct
        with open(self.path("l0.pfm"), "rb") as file:
            width = int([file.readline() for _ in range(3)][1].split()[0])
            file.seek(12 * width * row, os.SEEK_CUR)
            values = struct.unpack("<%df" % (3 * width), file.read(12 * width))
        return [values[3 * x:3 * x + 3] for x in range(width)]

    def test_textures_are_drawn(self):
        """Checks, bricks and holes come and go along rows of the picture, finer than leaves are."""
        make = os.path.join(SOURCE, "demos", "scenes", "make_textured_room.py")
        scene = self.path("room.gltf", subprocess.run([sys.executable, make], capture_output=True, text=True,
                                                      check=True).stdout)
        self.play(scene, "--size", "256x256", "--leaves", "600", "--cage-faces", "100", "--linear",
                  self.path("l%d.pfm"))

        def turns(row, columns, of):
            kinds = [of(*pixel) for pixel in self.linear(row)[columns[0]:columns[1]]]
            return sum(a != b for a, b in zip(kinds, kinds[1:]))

        found = {"globe": turns(100, (66, 122), lambda r, g, b: g > 0.4 * r),
                 "bricks": turns(170, (45, 215), lambda r, g, b: g > 0.6 * r),
                 "floor": turns(20, (10, 246), lambda r, g, b: r > 2.2 * b),
                 "sheet": turns(90, (155, 232), lambda r, g, b: g > r)}
        print(found)
        self.assertGreaterEqual(found["globe"], 4)
        self.assertGreaterEqual(found["bricks"], 12)
        self.assertGreaterEqual(found["floor"], 8)
        self.assertEqual(found["sheet"], 8)

    # What each file says, and how much of it there is: area of an object, m2, and B, W/m2, where the file is about it.
    CASES = {
        "g_texture_white_factor.gltf": ("", None), "g_scale_zero.gltf": ("scale is 0", 2),
        "g_shear.gltf": ("", 3), "g_equal_times.gltf": ("equal times", 3), "g_instancing.gltf": ("", 5),
        "g_point_light_and_lamp.gltf": ("", 2), "g_alpha_zero.gltf": ("let light through", 2),
        "g_metal.gltf": ("metals are taken as diffuse", 2), "g_orthographic.gltf": ("orthographic", 2),
        "g_no_mesh.gltf": ("holds no faces", 0), "g_emissive_texture_black.gltf": ("", 2),
        "g_skin_scale.gltf": ("skins are read as they are at rest", 3),
        "g_all_two_sides.gltf": ("where light falls", 2),
        "flipped.obj": ("turned round", 2), "white_kd.obj": ("0.98", 2), "unused_white.obj": ("", 2),
    }

    def test_files_of_the_cases(self):
        if not os.path.isdir(CASES):
            self.skipTest("../shared/cases is not there")
        for name, (says, objects) in self.CASES.items():
            told = self.play(os.path.join(CASES, name))
            self.assertLessEqual(told.count("\n"), 1, (name, told))
            self.assertIn(says, told) if says else self.assertEqual(told, "", name)
            faces = fields.read_ply(self.path("f0.ply"))[1]
            if objects is not None:
                self.assertEqual(len({face["object"] for face in faces}), objects, name)
            if objects:
                self.assertGreater(self.picture(), 5, name)
        self.play(os.path.join(CASES, "ushape.obj"), "--sky", "1")
        self.assertAlmostEqual(self.light()[0], 7, delta=1e-5)
        # A texel of 128 20 20 of sRGB on white.
        self.play(os.path.join(CASES, "g_texture_white_factor.gltf"))
        walls = [face for face in fields.read_ply(self.path("f0.ply"))[1] if face["e_r"] == 0]
        for face in walls:
            for channel, rho in (("rho_r", 0.21586), ("rho_g", 0.00700), ("rho_b", 0.00700)):
                self.assertAlmostEqual(face[channel], rho, delta=1e-4)
        self.assertTrue(walls)
        # A lamp whose texture is black.
        self.play(os.path.join(CASES, "g_emissive_texture_black.gltf"))
        shining = {face["object"] for face in fields.read_ply(self.path("f0.ply"))[1] if face["e_r"] > 0}
        self.assertEqual(len(shining), 1, "the walls' texture is black")
        self.play(os.path.join(CASES, "g_skin_scale.gltf"))
        area = self.light(lambda face: face["object"] == 2)[0]
        print("skinned cube: %.5f of 0.96 m2" % area)
        self.assertAlmostEqual(area, 0.96, delta=1e-4)
        for name in ("slow_chain_1object.gltf", "amplify_small.gltf"):
            began = time.monotonic()
            self.play(os.path.join(CASES, "hostile", name), code=1 if "amplify" in name else 0)
            print("%s: %.2f s" % (name, time.monotonic() - began))


sys.exit(suite.run(SceneFiles, *sys.argv[3:4]))
