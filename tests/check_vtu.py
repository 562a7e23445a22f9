#!/usr/bin/env python3
"""Reads the tetrahedra of softreel export with an XML reader and struct: a bar that is pinned at both ends and pulled to 1.1 of its length.

    check_vtu.py PROGRAM

Volumes are positive and sum to that of the bar; in the middle of the bar the strain is 0.1 and the stress E times that over the thinner
cross-section; displacements carry the first frame onto the others; the .pvd lists the frames by their time.
"""
import os
import re
import struct
import subprocess
import sys
import tempfile
import xml.etree.ElementTree

MODULUS, STRETCH, FPS = 2e4, 1.1, 25
NUMBERS = {"Float64": "d", "Float32": "f", "Int32": "i", "Int64": "q", "UInt8": "B"}

SHOT = """schema = 1
[shot]
name = "bar"
frames = [1, 3]
fps = %d
mode = "static"
[gravity]
acceleration = [0, 0, 0]
[body.bar]
mesh = "bar.obj"
scale = 1.0
edge = 0.08
material = "soft"
[[body.bar.pin]]
select = { box = { min = [0, 0, 0], max = [0.01, 1, 1] }, unit = "box" }
[[body.bar.pin]]
select = { box = { min = [0.99, 0, 0], max = [1, 1, 1] }, unit = "box" }
keys = [ { frame = 1, ease = "linear" }, { frame = 3, translate = [0.1, 0, 0] } ]
[material.soft]
youngs_modulus = %g
poisson_ratio = 0.3
""" % (FPS, MODULUS)

BAR = """v 0 0 0\nv 1 0 0\nv 1 0.2 0\nv 0 0.2 0\nv 0 0 0.2\nv 1 0 0.2\nv 1 0.2 0.2\nv 0 0.2 0.2
f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n"""


def check(condition, what):
    if not condition:
        sys.exit("vtu: " + what)


def near(a, b, tolerance, what):
    check(abs(a - b) <= tolerance, "%s is %g, expected %g +- %g" % (what, a, b, tolerance))


class Vtu:
    def __init__(self, path):
        with open(path, "rb") as f:
            data = f.read()
        marker = re.search(rb'<AppendedData encoding="raw">\s*_', data)
        self.raw, self.end = data, data.rindex(b"\n</AppendedData>")
        self.begin = marker.end()
        root = xml.etree.ElementTree.fromstring(data[:marker.start()] + b"</VTKFile>")
        check(root.get("byte_order") == "LittleEndian" and root.get("header_type") == "UInt64", "the header is another")
        self.piece = root.find("UnstructuredGrid/Piece")
        self.points = self.rows("Points/DataArray")
        ids = self.rows("Cells/DataArray[@Name='connectivity']")
        ends = self.rows("Cells/DataArray[@Name='offsets']")
        check(set(self.rows("Cells/DataArray[@Name='types']")) == {10}, "there are cells that are no tetrahedra")
        check(list(ends) == [4 * (e + 1) for e in range(len(ends))], "a tetrahedron has no 4 nodes")
        self.tets = [ids[4 * e:4 * e + 4] for e in range(len(ends))]
        check(len(self.tets) == int(self.piece.get("NumberOfCells")), "another number of cells")
        check(len(self.points) == int(self.piece.get("NumberOfPoints")), "another number of points")

    def rows(self, where):
        """Values of an array: numbers, or tuples of its components."""
        array = self.piece.find(where)
        at = self.begin + int(array.get("offset"))
        (size,) = struct.unpack_from("<Q", self.raw, at)
        check(at + 8 + size <= self.end, "%s lies beyond the file" % where)
        kind = NUMBERS[array.get("type")]
        values = struct.unpack_from("<%d%s" % (size // struct.calcsize(kind), kind), self.raw, at + 8)
        n = int(array.get("NumberOfComponents", "1"))
        return values if n == 1 else [values[n * i:n * i + n] for i in range(len(values) // n)]

    def cells(self, name):
        return self.rows("CellData/DataArray[@Name='%s']" % name)

    def volume(self, tet):
        a, b, c, d = [self.points[i] for i in tet]
        u, v, w = [[q - p for p, q in zip(a, x)] for x in (b, c, d)]
        return (w[0] * (u[1] * v[2] - u[2] * v[1]) + w[1] * (u[2] * v[0] - u[0] * v[2]) + w[2] * (u[0] * v[1] - u[1] * v[0])) / 6


def mean(values):
    return sum(values) / len(values)


def middle_of(rest, pulled):
    """Elements a third of the bar away from the pins, and how far it is stretched there: the slope of positions over those at rest."""
    elements = [e for e, tet in enumerate(rest.tets) if all(0.35 < rest.points[i][0] < 0.65 for i in tet)]
    check(len(elements) > 20, "the middle of the bar has no elements")
    nodes = sorted({i for e in elements for i in rest.tets[e]})
    x, y = [rest.points[i][0] for i in nodes], [pulled.points[i][0] for i in nodes]
    slope = sum((a - mean(x)) * (b - mean(y)) for a, b in zip(x, y)) / sum((a - mean(x)) ** 2 for a in x)
    return elements, slope


def check_middle(rest, pulled):
    """Far from the pins it is stretched as a free bar is, a little more than as a whole: pins hold the elements at the ends."""
    middle, stretch = middle_of(rest, pulled)
    near(stretch, STRETCH, 0.02, "stretch")
    strain = stretch - 1
    stress, thinner = MODULUS * strain, (1 - 0.3 * strain) ** 2

    def check_mean(array, component, expected, tolerance):
        rows = pulled.cells(array)
        values = [rows[e] if component is None else rows[e][component] for e in middle]
        near(mean(values), expected, tolerance, "%s %s" % (array, component))

    check_mean("strain", None, strain, 0.02 * strain)
    check_mean("green_strain", 0, (stretch ** 2 - 1) / 2, 0.02 * strain)
    check_mean("cauchy_stress", 0, stress / thinner, 0.03 * stress)
    check_mean("cauchy_stress", 1, 0, 0.03 * stress)
    check_mean("von_mises_stress", None, stress, 0.03 * stress)
    check_mean("cauchy_von_mises", None, stress / thinner, 0.03 * stress)


def main():
    with tempfile.TemporaryDirectory() as folder:
        for name, text in (("bar.obj", BAR), ("bar.toml", SHOT)):
            with open(os.path.join(folder, name), "w", encoding="utf-8") as f:
                f.write(text)
        ran = subprocess.run([os.path.abspath(sys.argv[1]), "export", os.path.join(folder, "bar.toml"), "--format", "vtu", "--output",
                              folder, "--quiet"], capture_output=True, text=True)
        check(ran.returncode == 0, "status %d: %s" % (ran.returncode, ran.stderr))
        frames = [Vtu(os.path.join(folder, "bar.bar.%04d.vtu" % k)) for k in (1, 2, 3)]
        series = xml.etree.ElementTree.parse(os.path.join(folder, "bar.bar.pvd")).getroot().findall("Collection/DataSet")
        check([s.get("file") for s in series] == ["bar.bar.%04d.vtu" % k for k in (1, 2, 3)], "the .pvd lists other files")
        for k in (1, 2):
            near(float(series[k].get("timestep")) - float(series[0].get("timestep")), k / FPS, 1e-9, "time of frame %d" % (k + 1))
    for frame in frames:
        volumes = [frame.volume(tet) for tet in frame.tets]
        check(min(volumes) > 0, "a volume is %g" % min(volumes))
    near(sum(frames[0].volume(tet) for tet in frames[0].tets), 0.04, 1e-3, "volume at rest")
    check(max(frames[0].cells("strain")) < 1e-9, "the first frame is not at rest")
    for rest, now, moved in zip(frames[0].points, frames[2].points, frames[2].rows("PointData/DataArray[@Name='displacement']")):
        check(all(abs(r + m - n) < 1e-12 for r, m, n in zip(rest, moved, now)), "a displacement ends elsewhere")
    check_middle(frames[0], frames[2])
    print("vtu: %d tetrahedra in 3 frames" % len(frames[0].tets))


if __name__ == "__main__":
    main()
