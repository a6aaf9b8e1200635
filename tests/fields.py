"""Reads what --field writes: a PLY of all leaves."""
import struct

TYPES = {"float": ("f", 4), "int": ("i", 4), "uchar": ("B", 1)}


def read_ply(path):
    """A field file: vertices, and faces as dictionaries with their corners."""
    with open(path, "rb") as file:
        data = file.read()
    head, body = data.split(b"end_header\n", 1)
    lines = head.decode().splitlines()
    assert lines[0] == "ply" and lines[1] == "format binary_little_endian 1.0", lines[:2]
    counts = {line.split()[1]: int(line.split()[2]) for line in lines if line.startswith("element")}
    of_faces = lines[lines.index("element face %d" % counts["face"]):]
    properties = [line.split() for line in of_faces if line.startswith("property")]
    assert properties[0][1:] == ["list", "uchar", "int", "vertex_indices"]
    vertices = [struct.unpack_from("<3f", body, 12 * k) for k in range(counts["vertex"])]
    at, faces = 12 * counts["vertex"], []
    for _ in range(counts["face"]):
        corners = body[at]
        face = {"corners": struct.unpack_from("<%di" % corners, body, at + 1)}
        at += 1 + 4 * corners
        for _, kind, name in properties[1:]:
            code, size = TYPES[kind]
            face[name] = struct.unpack_from("<" + code, body, at)[0]
            at += size
        faces.append(face)
    assert at == len(body), (at, len(body))
    return vertices, faces


def area(corners):
    """Of the fan about the first corner."""
    def cross(a, b):
        return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    total = 0
    for k in range(2, len(corners)):
        edges = [[corners[i][c] - corners[0][c] for c in range(3)] for i in (k - 1, k)]
        total += 0.5 * sum(x * x for x in cross(*edges)) ** 0.5
    return total


def mean_radiosity(path, of=lambda face: True):
    """Area, m2, and area mean of B (green), W/m2, of the leaves that are asked for."""
    vertices, faces = read_ply(path)
    areas = [(area([vertices[i] for i in face["corners"]]), face["b_g"]) for face in faces if of(face)]
    total = sum(a for a, _ in areas)
    return total, sum(a * b for a, b in areas) / total if total else 0
