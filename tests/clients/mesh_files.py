"""Readers of mesh files and point caches, written from the formats' descriptions and not from softreel's code."""
import struct


class Mesh:
    def __init__(self, positions, polygons):
        self.positions = positions  # [(x, y, z)], doubles
        self.polygons = polygons    # [[vertex, ...]]


def float32(x):
    """The nearest float32 of a double, as a double."""
    return struct.unpack("<f", struct.pack("<f", x))[0]


def rounded(positions):
    """Positions in float32."""
    return [tuple(float32(c) for c in p) for p in positions]


PLY_TYPES = {"char": "b", "uchar": "B", "short": "h", "ushort": "H", "int": "i", "uint": "I", "float": "f", "double": "d"}


def read_ply(path):
    """Binary little-endian PLY."""
    with open(path, "rb") as f:
        data = f.read()
    end = data.index(b"end_header\n") + len(b"end_header\n")
    elements = []
    for words in (line.split() for line in data[:end].decode("ascii").splitlines()):
        if words[0] == "format" and words[1] != "binary_little_endian":
            raise ValueError("%s: format %s" % (path, words[1]))
        if words[0] == "element":
            elements.append((words[1], int(words[2]), []))
        elif words[0] == "property":
            elements[-1][2].append(words[1:])
    at = end
    positions, polygons = [], []

    def take(kind):
        nonlocal at
        value = struct.unpack_from("<" + PLY_TYPES[kind], data, at)[0]
        at += struct.calcsize(PLY_TYPES[kind])
        return value

    for name, count, properties in elements:
        for _ in range(count):
            row = {}
            for p in properties:
                row[p[-1]] = [take(p[2]) for _ in range(take(p[1]))] if p[0] == "list" else take(p[0])
            if name == "vertex":
                positions.append((row["x"], row["y"], row["z"]))
            elif name == "face":
                polygons.append(row["vertex_indices"])
    if at != len(data):
        raise ValueError("%s: %d bytes are left over" % (path, len(data) - at))
    return Mesh(positions, polygons)


def read_obj(path):
    positions, polygons = [], []
    with open(path, encoding="utf-8") as f:
        for words in (line.split() for line in f):
            if words and words[0] == "v":
                positions.append(tuple(float(w) for w in words[1:4]))
            elif words and words[0] == "f":
                polygons.append([int(w.split("/")[0]) - 1 for w in words[1:]])
    return Mesh(positions, polygons)


def floats_to_points(values):
    return [tuple(values[3 * k:3 * k + 3]) for k in range(len(values) // 3)]


def read_pc2(path):
    """(first frame, frames from one sample to the next, [sample][vertex] = (x, y, z))"""
    with open(path, "rb") as f:
        data = f.read()
    magic, version, points, start, rate, samples = struct.unpack_from("<12siiffi", data, 0)
    if magic != b"POINTCACHE2\0" or version != 1 or len(data) != 32 + 12 * points * samples:
        raise ValueError("%s: no PC2 file of version 1" % path)
    size = 3 * points
    return start, rate, [floats_to_points(struct.unpack_from("<%df" % size, data, 32 + 4 * size * k)) for k in range(samples)]


def read_mdd(path):
    """(seconds of each frame, [frame][vertex] = (x, y, z)); all of the file is big-endian."""
    with open(path, "rb") as f:
        data = f.read()
    frames, points = struct.unpack_from(">ii", data, 0)
    if len(data) != 8 + 4 * frames + 12 * points * frames:
        raise ValueError("%s: the size is not that of an MDD file" % path)
    times = struct.unpack_from(">%df" % frames, data, 8)
    begin, size = 8 + 4 * frames, 3 * points
    return times, [floats_to_points(struct.unpack_from(">%df" % size, data, begin + 4 * size * k)) for k in range(frames)]


def first_difference(a, b):
    """Where two lists of points differ, as text; empty if they are equal bit for bit."""
    if len(a) != len(b):
        return "%d vertices instead of %d" % (len(a), len(b))
    for v, (p, q) in enumerate(zip(a, b)):
        if struct.pack("<3d", *p) != struct.pack("<3d", *q):
            return "vertex %d is %r instead of %r" % (v, p, q)
    return ""
