#!/usr/bin/env python3
"""Writes door.gltf: two rooms, a lamp in one, and a door between them that opens and closes.

    demos/scenes/make_door.py > demos/scenes/door.gltf

Metres; x leads from the lit room (x < 0) to the dark one, y is up. glTF has triangles only, so each quad is the two
triangles a b c and a c d, which the loader puts together again.
"""
import base64
import json
import math
import struct

WALL = 0.075  # half the thickness of the wall between the rooms
LENGTH, HEIGHT, HALF_WIDTH = 4.0, 2.6, 2.0
DOOR_HALF, DOOR_TOP = 0.45, 2.1


def rectangle(corner, u, v, n=1, m=1):
    """Quads of corner + s u + t v; the front is where u x v points."""
    points, quads = [], []
    for j in range(m + 1):
        for i in range(n + 1):
            points.append([corner[k] + u[k] * i / n + v[k] * j / m for k in range(3)])
    for j in range(m):
        for i in range(n):
            a = j * (n + 1) + i
            quads.append([a, a + 1, a + n + 2, a + n + 1])
    return points, quads


def box(lower, upper):
    """Six quads, outward."""
    (a, b, c), (d, e, f) = lower, upper
    w, h, l = d - a, e - b, f - c
    return [rectangle([a, b, c], [w, 0, 0], [0, 0, l]), rectangle([a, e, c], [0, 0, l], [w, 0, 0]),
            rectangle([a, b, c], [0, 0, l], [0, h, 0]), rectangle([d, b, c], [0, h, 0], [0, 0, l]),
            rectangle([a, b, c], [0, h, 0], [w, 0, 0]), rectangle([a, b, f], [w, 0, 0], [0, h, 0])]


def room(side):
    """Inward, with a doorway: (floor), (ceiling and walls). side: -1 is the lit room, 1 the dark one."""
    near, far = side * WALL, side * (WALL + LENGTH)
    a, b = min(near, far), max(near, far)
    w, d = b - a, 2 * HALF_WIDTH
    beside = HALF_WIDTH - DOOR_HALF

    def across(x, z, y, width, height, inward, n, m):
        """A piece of a wall across the x axis whose front looks to `inward`."""
        if inward > 0:
            return rectangle([x, y, z], [0, height, 0], [0, 0, width], m, n)
        return rectangle([x, y, z], [0, 0, width], [0, height, 0], n, m)

    floor = [rectangle([a, 0, -HALF_WIDTH], [0, 0, d], [w, 0, 0], 4, 4)]
    walls = [rectangle([a, HEIGHT, -HALF_WIDTH], [w, 0, 0], [0, 0, d], 4, 4),
             rectangle([a, 0, -HALF_WIDTH], [w, 0, 0], [0, HEIGHT, 0], 4, 3),
             rectangle([a, 0, HALF_WIDTH], [0, HEIGHT, 0], [w, 0, 0], 3, 4),
             across(far, -HALF_WIDTH, 0, d, HEIGHT, -side, 4, 3),
             across(near, -HALF_WIDTH, 0, beside, HEIGHT, side, 2, 3),
             across(near, DOOR_HALF, 0, beside, HEIGHT, side, 2, 3),
             across(near, -DOOR_HALF, DOOR_TOP, 2 * DOOR_HALF, HEIGHT - DOOR_TOP, side, 1, 1)]
    return floor, walls


def frame():
    """The inside of the doorway."""
    w = 2 * WALL
    return [rectangle([-WALL, 0, -DOOR_HALF], [w, 0, 0], [0, DOOR_TOP, 0], 1, 3),
            rectangle([-WALL, 0, DOOR_HALF], [0, DOOR_TOP, 0], [w, 0, 0], 3, 1),
            rectangle([-WALL, DOOR_TOP, -DOOR_HALF], [w, 0, 0], [0, 0, 2 * DOOR_HALF]),
            rectangle([-WALL, 0, -DOOR_HALF], [0, 0, 2 * DOOR_HALF], [w, 0, 0])]


class Writer:
    def __init__(self, generator):
        self.data = b""
        self.gltf = {"asset": {"version": "2.0", "generator": generator}, "scene": 0,
                     "extensionsUsed": ["KHR_materials_emissive_strength"],
                     "scenes": [{"nodes": []}], "nodes": [], "meshes": [], "materials": [], "accessors": [],
                     "bufferViews": []}

    def accessor(self, values, component, kind, code, **more):
        while len(self.data) % 4:
            self.data += b"\0"
        raw = struct.pack("<%d%s" % (len(values), code), *values)
        self.gltf["bufferViews"].append({"buffer": 0, "byteOffset": len(self.data), "byteLength": len(raw)})
        self.data += raw
        size = {"SCALAR": 1, "VEC3": 3, "VEC4": 4, "MAT4": 16}[kind]
        self.gltf["accessors"].append(dict(bufferView=len(self.gltf["bufferViews"]) - 1, componentType=component,
                                           type=kind,
                                           count=len(values) // size, **more))
        return len(self.gltf["accessors"]) - 1

    def material(self, name, color, strength=0.0):
        m = {"name": name, "pbrMetallicRoughness": {"baseColorFactor": color + [1], "metallicFactor": 0}}
        if strength:
            m["emissiveFactor"] = [1, 0.82, 0.6]
            m["extensions"] = {"KHR_materials_emissive_strength": {"emissiveStrength": strength}}
        self.gltf["materials"].append(m)
        return len(self.gltf["materials"]) - 1

    def primitive(self, parts, material):
        positions, indices, index = [], [], {}
        for points, quads in parts:
            for quad in quads:
                ids = [index.setdefault(tuple(round(x, 6) for x in points[k]), len(index)) for k in quad]
                indices += [ids[0], ids[1], ids[2], ids[0], ids[2], ids[3]]
        for point in index:
            positions += point
        low = [min(positions[k::3]) for k in range(3)]
        high = [max(positions[k::3]) for k in range(3)]
        return {"attributes": {"POSITION": self.accessor(positions, 5126, "VEC3", "f", min=low, max=high)},
                "indices": self.accessor(indices, 5123, "SCALAR", "H"), "material": material}

    def node(self, **node):
        self.gltf["nodes"].append(node)
        self.gltf["scenes"][0]["nodes"].append(len(self.gltf["nodes"]) - 1)
        return len(self.gltf["nodes"]) - 1

    def thing(self, name, primitives, levels, scheme="bilinear", **more):
        self.gltf["meshes"].append({"name": name, "primitives": primitives})
        extras = {"gi": {"scheme": scheme, "levels": levels}}
        return self.node(name=name, mesh=len(self.gltf["meshes"]) - 1, extras=extras, **more)

    def turn(self, node, keys):
        """Keys (seconds, degrees about y)."""
        times = self.accessor([k[0] for k in keys], 5126, "SCALAR", "f", min=[keys[0][0]], max=[keys[-1][0]])
        turns = []
        for _, degrees in keys:
            half = math.radians(degrees) / 2
            turns += [0, math.sin(half), 0, math.cos(half)]
        sampler = {"input": times, "output": self.accessor(turns, 5126, "VEC4", "f")}
        self.gltf["animations"] = [{"name": "door", "samplers": [sampler],
                                    "channels": [{"sampler": 0, "target": {"node": node, "path": "rotation"}}]}]

    def write(self):
        self.gltf["buffers"] = [{"byteLength": len(self.data), "uri": "data:application/octet-stream;base64,"
                                 + base64.b64encode(self.data).decode()}]
        print(json.dumps(self.gltf, separators=(",", ":")))


def look(eye, target):
    """The rotation of a camera, which looks along -z."""
    f = [t - e for e, t in zip(eye, target)]
    yaw = math.atan2(-f[0], -f[2]) / 2
    pitch = math.atan2(f[1], math.hypot(f[0], f[2])) / 2
    return [math.cos(yaw) * math.sin(pitch), math.sin(yaw) * math.cos(pitch), -math.sin(yaw) * math.sin(pitch),
            math.cos(yaw) * math.cos(pitch)]


def main():
    w = Writer("make_door.py")
    wood = w.material("wood", [0.42, 0.27, 0.16])
    ochre = w.material("ochre", [0.72, 0.5, 0.24])
    white = w.material("white", [0.78, 0.78, 0.76])
    teal = w.material("teal", [0.1, 0.42, 0.42])
    plum = w.material("plum", [0.5, 0.16, 0.24])
    lamp = w.material("lamp", [0, 0, 0], 40)

    for name, side, paint, levels in (("lit room", -1, ochre, 1), ("dark room", 1, white, 2)):
        floor, walls = room(side)
        w.thing(name, [w.primitive(floor, wood), w.primitive(walls, paint)], levels)
    w.thing("frame", [w.primitive(frame(), white)], 1)
    # A bright pane on the far wall, opposite the doorway.
    w.thing("lamp", [w.primitive([rectangle([0, -0.4, -0.4], [0, 0.8, 0], [0, 0, 0.8])], lamp)], 2,
            translation=[-WALL - LENGTH + 0.01, 1.75, 0.5])
    w.thing("table", [w.primitive(box([-0.35, 0, -0.35], [0.35, 0.5, 0.35]), teal)], 2, translation=[1.9, 0.001, -1.1])
    w.thing("pouf", [w.primitive(box([-0.5, 0, -0.5], [0.5, 0.7, 0.5]), plum)], 3, "catmull-clark",
            translation=[0.95, 0.001, 1.3])
    # Inside the doorway, flush with the dark room, 4 mm of air around; the hinge is the corner on that side.
    door = w.thing("door", [w.primitive(box([-0.04, 0, 0], [0, DOOR_TOP - 0.008, 2 * DOOR_HALF - 0.008]), teal)], 3,
                   translation=[WALL - 0.002, 0.004, -DOOR_HALF + 0.004])
    w.turn(door, [(0, 0), (0.75, 48), (1.5, 96), (2.5, 96), (3.25, 48), (4, 0)])

    eye = [3.75, 1.55, 1.7]
    w.gltf["cameras"] = [{"type": "perspective", "perspective": {"yfov": 1.0, "znear": 0.05}}]
    w.node(name="camera", camera=0, translation=eye, rotation=look(eye, [0.4, 0.95, -0.3]))
    w.write()


if __name__ == "__main__":
    main()
