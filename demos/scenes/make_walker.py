#!/usr/bin/env python3
"""Writes walker.gltf: a figure that walks round a room, a skinned cage, and a curtain that waves, of morph targets.

    demos/scenes/make_walker.py > demos/scenes/walker.gltf

Metres and seconds; y is up. At rest the figure looks along +z, arms hanging; each of its parts is a tube of rings of
four vertices, closed at both ends, that Catmull-Clark rounds. Two steps take a second; the lower sole is on the floor.
"""
import math

from make_door import Writer, box, look, rectangle

SECONDS, KEYS_A_SECOND, RADIUS = 6, 8, 0.95
ROOM = ([-2.2, 0, -2.2], [2.2, 2.6, 2.2])

# name, parent, where it is at rest
JOINTS = [("hips", None, [0, 0.99, 0]), ("chest", 0, [0, 1.14, 0]), ("head", 1, [0, 1.52, 0]),
          ("left thigh", 0, [0.1, 0.93, 0]), ("left shin", 3, [0.1, 0.5, 0]),
          ("right thigh", 0, [-0.1, 0.93, 0]), ("right shin", 5, [-0.1, 0.5, 0]),
          ("left arm", 1, [0.205, 1.4, 0]), ("left forearm", 7, [0.205, 1.12, 0]),
          ("right arm", 1, [-0.205, 1.4, 0]), ("right forearm", 9, [-0.205, 1.12, 0])]


def ring(y, x, z, half_x, half_z, *joints):
    """joints: one, or two that share it evenly."""
    return dict(y=y, x=x, z=z, half=(half_x, half_z), joints=joints)


def leg(x, thigh, shin):
    return [ring(1.02, 0.9 * x, 0, 0.07, 0.08, 0), ring(0.93, x, 0, 0.09, 0.095, 0, thigh),
            ring(0.84, x, 0, 0.092, 0.095, thigh), ring(0.68, x, 0, 0.078, 0.08, thigh),
            ring(0.55, x, 0, 0.064, 0.066, thigh),
            ring(0.5, x, 0, 0.062, 0.064, thigh, shin), ring(0.45, x, 0, 0.06, 0.062, shin),
            ring(0.3, x, -0.01, 0.056, 0.06, shin), ring(0.13, x, 0, 0.045, 0.05, shin),
            ring(0.09, x, 0.05, 0.05, 0.12, shin), ring(0.03, x, 0.06, 0.052, 0.14, shin)]


def arm(x, upper, lower):
    return [ring(1.475, 0.9 * x, 0, 0.045, 0.05, 1, upper), ring(1.42, 0.97 * x, 0, 0.062, 0.066, 1, upper),
            ring(1.34, x, 0, 0.054, 0.056, upper), ring(1.26, x, 0, 0.046, 0.048, upper),
            ring(1.16, x, 0, 0.042, 0.044, upper),
            ring(1.12, x, 0, 0.041, 0.043, upper, lower), ring(1.08, x, 0, 0.041, 0.042, lower),
            ring(0.96, x, 0, 0.036, 0.038, lower), ring(0.88, x, 0, 0.032, 0.036, lower),
            ring(0.78, x, 0.01, 0.034, 0.05, lower)]


TORSO = [ring(1.47, 0, 0, 0.1, 0.07, 1), ring(1.42, 0, 0, 0.215, 0.105, 1), ring(1.3, 0, 0, 0.19, 0.12, 1),
         ring(1.14, 0, 0, 0.15, 0.1, 0, 1), ring(1.04, 0, 0, 0.165, 0.11, 0), ring(0.96, 0, 0, 0.17, 0.115, 0)]
PELVIS = [ring(1.03, 0, 0, 0.14, 0.09, 0), ring(0.98, 0, 0, 0.17, 0.11, 0), ring(0.9, 0, 0, 0.175, 0.115, 0),
          ring(0.82, 0, 0, 0.12, 0.09, 0)]
HEAD = [ring(1.79, 0, 0.01, 0.07, 0.085, 2), ring(1.72, 0, 0.01, 0.095, 0.115, 2), ring(1.6, 0, 0.01, 0.085, 0.105, 2),
        ring(1.55, 0, 0, 0.06, 0.06, 2), ring(1.5, 0, 0, 0.055, 0.055, 1, 2), ring(1.43, 0, 0, 0.065, 0.06, 1)]


def tube(rings):
    """Points, their joints, quads: from the upper ring down."""
    points, joints, quads = [], [], []
    for r in rings:
        for u, v in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
            points.append([r["x"] + u * r["half"][0], r["y"], r["z"] + v * r["half"][1]])
            joints.append(r["joints"])
    for k in range(len(rings) - 1):
        for i in range(4):
            a, b = 4 * k, 4 * k + 4
            quads.append([a + i, a + (i + 1) % 4, b + (i + 1) % 4, b + i])
    last = 4 * len(rings) - 4
    return points, joints, quads + [[0, 3, 2, 1], [last, last + 1, last + 2, last + 3]]


def ordered(w, points, quads, material):
    """A primitive whose vertices are the points in their order, as joints and targets are."""
    indices = [q[k] for q in quads for k in (0, 1, 2, 0, 2, 3)]
    low, high = ([f(p[k] for p in points) for k in range(3)] for f in (min, max))
    positions = w.accessor([x for p in points for x in p], 5126, "VEC3", "f", min=low, max=high)
    return {"attributes": {"POSITION": positions},
            "indices": w.accessor(indices, 5123, "SCALAR", "H"), "material": material}


def skinned(w, tubes, material):
    points, joints, quads = [], [], []
    for rings in tubes:
        p, j, q = tube(rings)
        quads += [[len(points) + k for k in quad] for quad in q]
        points += p
        joints += j
    primitive = ordered(w, points, quads, material)
    numbers, weights = [], []
    for j in joints:
        numbers += (list(j) + [0, 0, 0, 0])[:4]
        weights += ([1 / len(j)] * len(j) + [0, 0, 0, 0])[:4]
    primitive["attributes"]["JOINTS_0"] = w.accessor(numbers, 5121, "VEC4", "B")
    primitive["attributes"]["WEIGHTS_0"] = w.accessor(weights, 5126, "VEC4", "f")
    return primitive


def turn(axis, angle):
    return [math.sin(angle / 2) * a for a in axis] + [math.cos(angle / 2)]


def turned(q, p):
    """A point by a quaternion about x."""
    s, c = 2 * q[0] * q[3], 1 - 2 * q[0] * q[0]
    return [p[0], c * p[1] - s * p[2], s * p[1] + c * p[2]]


def lowest_sole(pose):
    """Height of the lower sole, that of the hips being 0."""
    heights = []
    for thigh in (3, 5):
        hip, knee = JOINTS[thigh][2], JOINTS[thigh + 1][2]
        for r in leg(hip[0], thigh, thigh + 1)[-2:]:
            for forward in (-1, 1):
                # Catmull-Clark rounds a foot off by so much.
                p = [0, r["y"] + 0.012 - knee[1], r["z"] + 0.72 * forward * r["half"][1] - knee[2]]
                p = [a + b for a, b in zip(turned(pose[thigh + 1], p), [0, knee[1] - hip[1], knee[2] - hip[2]])]
                heights.append(turned(pose[thigh], p)[1] + hip[1] - JOINTS[0][2][1])
    return min(heights)


def walk(t):
    """Rotations by joint, and where the hips are, at t seconds."""
    way = 2 * math.pi * t / SECONDS
    step = 2 * math.pi * t
    x, y = [1, 0, 0], [0, 1, 0]
    pose = {0: turn(y, way + math.pi / 2), 1: turn(y, 0.12 * math.sin(step)), 2: turn(x, 0.04 * math.sin(2 * step))}
    for thigh, arm_joint, phase in ((3, 7, 0), (5, 9, math.pi)):
        pose[thigh] = turn(x, -0.08 - 0.42 * math.sin(step + phase))
        pose[thigh + 1] = turn(x, 0.14 + 0.7 * max(0, math.cos(step + phase)))
        pose[arm_joint] = turn(x, 0.45 * math.sin(step + phase))
        pose[arm_joint + 1] = turn(x, -0.4 - 0.2 * math.sin(step + phase))
    return pose, [RADIUS * math.sin(way), 0.002 - lowest_sole(pose), RADIUS * math.cos(way)]


def add_figure(w, shirt, trousers, skin):
    w.gltf["skins"] = [{}]
    first = len(w.gltf["nodes"])
    for name, parent, at in JOINTS:
        above = JOINTS[parent][2] if parent is not None else [0, 0, 0]
        w.gltf["nodes"].append({"name": name, "translation": [round(a - b, 6) for a, b in zip(at, above)]})
    for number, (_, parent, _) in enumerate(JOINTS):
        if parent is not None:
            w.gltf["nodes"][first + parent].setdefault("children", []).append(first + number)
    w.gltf["scenes"][0]["nodes"].append(first)
    inverse = []
    for _, _, at in JOINTS:
        inverse += [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -at[0], -at[1], -at[2], 1]
    w.gltf["skins"][0] = {"joints": list(range(first, first + len(JOINTS))),
                          "inverseBindMatrices": w.accessor(inverse, 5126, "MAT4", "f")}
    w.thing("figure", [skinned(w, [TORSO, arm(0.205, 7, 8), arm(-0.205, 9, 10)], shirt),
                       skinned(w, [PELVIS, leg(0.1, 3, 4), leg(-0.1, 5, 6)], trousers), skinned(w, [HEAD], skin)], 1,
            "catmull-clark", skin=0)

    times = [k / KEYS_A_SECOND for k in range(SECONDS * KEYS_A_SECOND + 1)]
    clock = w.accessor(times, 5126, "SCALAR", "f", min=[0], max=[SECONDS])
    samplers, channels = [], []

    def play(node, path, values, kind):
        channels.append({"sampler": len(samplers), "target": {"node": node, "path": path}})
        samplers.append({"input": clock, "output": w.accessor(values, 5126, kind, "f")})

    poses = [walk(t) for t in times]
    for joint in sorted(poses[0][0]):
        play(first + joint, "rotation", [x for pose, _ in poses for x in pose[joint]], "VEC4")
    play(first, "translation", [x for _, at in poses for x in at], "VEC3")
    return clock, times, samplers, channels


def add_curtain(w, material, clock, times, samplers, channels):
    """Two waves a quarter apart, so that their weights make one that runs."""
    width, height, n, m = 1.5, 1.9, 12, 6
    points, quads = rectangle([-width / 2, 0, 0], [width, 0, 0], [0, height, 0], n, m)
    primitive = ordered(w, points, quads, material)
    targets = []
    for phase in (0, math.pi / 2):
        deltas = []
        for x, y, _ in points:
            free = 0.08 * (1 - y / height) + 0.05
            deltas += [0, 0, free * math.sin(2 * math.pi * 2 * x / width + phase)]
        targets.append({"POSITION": w.accessor(deltas, 5126, "VEC3", "f")})
    primitive["targets"] = targets
    node = w.thing("curtain", [primitive], 1, "catmull-clark", translation=[0.7, 0.35, ROOM[0][2] + 0.25])
    values = []
    for t in times:
        values += [0.8 * math.cos(2 * math.pi * t / 3), 0.8 * math.sin(2 * math.pi * t / 3)]
    channels.append({"sampler": len(samplers), "target": {"node": node, "path": "weights"}})
    samplers.append({"input": clock, "output": w.accessor(values, 5126, "SCALAR", "f")})


def main():
    w = Writer("make_walker.py")
    floor = w.material("floor", [0.5, 0.42, 0.34])
    white = w.material("white", [0.75, 0.75, 0.72])
    green = w.material("green", [0.3, 0.55, 0.3])
    shirt = w.material("shirt", [0.7, 0.22, 0.16])
    trousers = w.material("trousers", [0.16, 0.2, 0.4])
    skin = w.material("skin", [0.65, 0.45, 0.33])
    cloth = w.material("cloth", [0.75, 0.6, 0.3])
    w.gltf["materials"][cloth]["doubleSided"] = True
    lamp = w.material("lamp", [0, 0, 0], 14)

    (a, b, c), (d, e, f) = ROOM
    across, deep, high = d - a, f - c, e - b
    w.thing("room", [w.primitive([rectangle([a, b, c], [0, 0, deep], [across, 0, 0], 4, 4)], floor),
                     w.primitive([rectangle([a, e, c], [across, 0, 0], [0, 0, deep], 4, 4),
                                  rectangle([a, b, c], [across, 0, 0], [0, high, 0], 4, 3),
                                  rectangle([a, b, f], [0, high, 0], [across, 0, 0], 3, 4),
                                  rectangle([d, b, c], [0, 0, deep], [0, high, 0], 4, 3)], white),
                     w.primitive([rectangle([a, b, c], [0, high, 0], [0, 0, deep], 3, 4)], green)], 1)
    w.thing("lamp", [w.primitive([rectangle([-0.45, 0, -0.45], [0.9, 0, 0], [0, 0, 0.9])], lamp)], 1,
            translation=[0, e - 0.01, 0])
    w.thing("block", [w.primitive(box([-0.25, 0, -0.25], [0.25, 0.45, 0.25]), white)], 2, translation=[0, 0.001, 0])
    clock, times, samplers, channels = add_figure(w, shirt, trousers, skin)
    add_curtain(w, cloth, clock, times, samplers, channels)
    w.gltf["animations"] = [{"name": "walk", "samplers": samplers, "channels": channels}]

    eye = [1.9, 1.75, 2.05]
    w.gltf["cameras"] = [{"type": "perspective", "perspective": {"yfov": 1.15, "znear": 0.05}}]
    w.node(name="camera", camera=0, translation=eye, rotation=look(eye, [-0.25, 0.85, -0.5]))
    w.write()


if __name__ == "__main__":
    main()
