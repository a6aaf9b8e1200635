#!/usr/bin/env python3
"""Writes a room of textures: a floor of checks, brick walls, a screen that shines, a sheet with holes, a globe whose
mesh is finer than what it is lit through.

    demos/scenes/make_textured_room.py > room.gltf; build/bin/gi_play room.gltf

Metres, y is up. Pictures are in the file, as data.
"""
import base64
import json
import math
import struct
import zlib

FLOOR = [(225, 220, 205), (60, 35, 30)]  # sRGB
GLOBE_COLUMNS, GLOBE_ROWS, GLOBE_RADIUS = 64, 32, 0.5


def data_uri(kind, data):
    return "data:%s;base64,%s" % (kind, base64.b64encode(data).decode())


def png(width, height, colour_at):
    """colour_at gives 3 bytes of each pixel, or 4."""
    pixels = [[colour_at(x, y) for x in range(width)] for y in range(height)]
    kind = 6 if len(pixels[0][0]) == 4 else 2
    rows = b"".join(b"\0" + b"".join(bytes(p) for p in row) for row in pixels)

    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, kind, 0, 0, 0)) +
            chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b""))


def checks(x, y):
    return FLOOR[(x // 32 + y // 32) % 2]


def bricks(x, y):
    """Four to a row, every other row half a brick aside, each of a shade of its own."""
    row = y // 16
    along = (x + 16 * (row % 2)) % 128
    shade = along // 32 * 7 + row * 13
    return (200, 195, 185) if y % 16 < 2 or along % 32 < 2 else (150 + 8 * (shade % 5), 70 + 5 * (shade % 5), 50)


def screen(x, y):
    if (x - 64) ** 2 + (y - 36) ** 2 < 24 ** 2:
        return (255, 160, 20)
    return (20, 40, 160) if y < 48 else (10, 90, 30)


def holes(x, y):
    return (40, 140, 50, 255 if (x % 32 - 16) ** 2 + (y % 32 - 16) ** 2 < 14 ** 2 else 0)


def globe_checks(x, y):
    return (220, 60, 50) if (x // 16 + y // 16) % 2 else (240, 230, 210)


IMAGES = [png(64, 64, checks), png(128, 128, bricks), png(128, 72, screen), png(128, 128, holes),
          png(256, 128, globe_checks)]
CHECKS, BRICKS, SCREEN, HOLES, GLOBE = range(5)


def painted(name, texture, **more):
    return {"name": name, "pbrMetallicRoughness": {"metallicFactor": 0, "baseColorTexture": texture}, **more}


def shining(name, strength, **more):
    return {"name": name, "pbrMetallicRoughness": {"metallicFactor": 0, "baseColorFactor": [0.05, 0.05, 0.05, 1]},
            "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": strength}}, **more}


MATERIALS = [
    painted("floor", {"index": CHECKS}),
    painted("brick", {"index": BRICKS, "extensions": {"KHR_texture_transform": {"scale": [3, 2]}}}),
    shining("screen", 4, emissiveTexture={"index": SCREEN}, emissiveFactor=[1, 1, 1]),
    painted("sheet", {"index": HOLES}, alphaMode="MASK", alphaCutoff=0.5, doubleSided=True),
    painted("globe", {"index": GLOBE}),
    {"name": "white", "pbrMetallicRoughness": {"metallicFactor": 0, "baseColorFactor": [0.75, 0.75, 0.75, 1]}},
    shining("lamp", 12, emissiveFactor=[1, 0.95, 0.85]),
]


def quad(name, material, corner, u, v, times=1):
    """corner + s u + t v, its front where u x v points; the picture stands upright along v, so many times each way."""
    points = [[corner[k] + s * u[k] + t * v[k] for k in range(3)] for s, t in ((0, 0), (1, 0), (1, 1), (0, 1))]
    return name, material, points, [[0, times], [times, times], [times, 0], [0, 0]], [0, 1, 2, 0, 2, 3]


def globe(middle):
    points, uvs, indices = [], [], []
    for j in range(GLOBE_ROWS + 1):
        down = math.pi * j / GLOBE_ROWS
        for i in range(GLOBE_COLUMNS + 1):
            round_y = 2 * math.pi * (i % GLOBE_COLUMNS) / GLOBE_COLUMNS
            wide = 0 if j in (0, GLOBE_ROWS) else math.sin(down)
            points.append([middle[0] + GLOBE_RADIUS * wide * math.cos(round_y),
                           middle[1] + GLOBE_RADIUS * math.cos(down),
                           middle[2] - GLOBE_RADIUS * wide * math.sin(round_y)])
            uvs.append([i / GLOBE_COLUMNS, j / GLOBE_ROWS])
    for j in range(GLOBE_ROWS):
        for i in range(GLOBE_COLUMNS):
            a = j * (GLOBE_COLUMNS + 1) + i
            b = a + GLOBE_COLUMNS + 1
            indices += ([a, b, a + 1] if j > 0 else []) + ([a + 1, b, b + 1] if j < GLOBE_ROWS - 1 else [])
    return "globe", 4, points, uvs, indices


MESHES = [
    quad("floor", 0, [-2, 0, 2], [4, 0, 0], [0, 0, -4], 8),
    quad("ceiling", 5, [-2, 3, -2], [4, 0, 0], [0, 0, 4]),
    quad("back", 1, [-2, 0, -2], [4, 0, 0], [0, 3, 0]),
    quad("left", 5, [-2, 0, 2], [0, 0, -4], [0, 3, 0]),
    quad("right", 1, [2, 0, -2], [0, 0, 4], [0, 3, 0]),
    quad("lamp", 6, [-0.5, 2.98, -0.5], [1, 0, 0], [0, 0, 1]),
    quad("screen", 2, [-1.95, 0.8, 0.9], [0, 0, -1.6], [0, 0.9, 0]),
    quad("sheet", 3, [0.4, 0, 0.6], [1.2, 0, -0.4], [0, 1.2, 0]),
    globe([-0.6, 0.5, -0.4]),
]


def main():
    data, views, accessors, meshes = bytearray(), [], [], []

    def add(values, kind, component, code):
        flat = [x for v in values for x in (v if isinstance(v, list) else [v])]
        data.extend(bytes(-len(data) % 4))
        views.append({"buffer": 0, "byteOffset": len(data), "byteLength": struct.calcsize(code) * len(flat)})
        data.extend(struct.pack("<%d%s" % (len(flat), code), *flat))
        accessors.append({"bufferView": len(views) - 1, "componentType": component, "count": len(values),
                          "type": kind})
        return len(accessors) - 1

    for name, material, points, uvs, indices in MESHES:
        place = add(points, "VEC3", 5126, "f")
        accessors[place].update(min=[min(p[k] for p in points) for k in range(3)],
                                max=[max(p[k] for p in points) for k in range(3)])
        attributes = {"POSITION": place, "TEXCOORD_0": add(uvs, "VEC2", 5126, "f")}
        meshes.append({"name": name, "primitives": [{"attributes": attributes, "material": material,
                                                     "indices": add(indices, "SCALAR", 5123, "H")}]})
    nodes = [{"name": mesh["name"], "mesh": k} for k, mesh in enumerate(meshes)]
    nodes.append({"camera": 0, "translation": [0, 1.5, 5.2], "rotation": [-0.0436, 0, 0, 0.999]})
    print(json.dumps({
        "asset": {"version": "2.0"}, "extensionsUsed": ["KHR_texture_transform", "KHR_materials_emissive_strength"],
        "scene": 0, "scenes": [{"nodes": list(range(len(nodes)))}], "nodes": nodes, "meshes": meshes,
        "cameras": [{"type": "perspective", "perspective": {"yfov": 0.75, "znear": 0.1}}], "materials": MATERIALS,
        "textures": [{"source": k} for k in range(len(IMAGES))],
        "images": [{"uri": data_uri("image/png", image)} for image in IMAGES],
        "buffers": [{"uri": data_uri("application/octet-stream", bytes(data)), "byteLength": len(data)}],
        "bufferViews": views, "accessors": accessors}))


if __name__ == "__main__":
    main()
