"""What the proofs of this folder share: the program under test, its clients, a small shot, and how a proof ends."""
import math
import os
import shutil
import subprocess
import sys
import tempfile

import mesh_files

SOFTREEL = os.environ.get("SOFTREEL_PROGRAM", "")
# Where tool/test --clients puts the npm packages.
CLIENTS = os.environ.get("SOFTREEL_CLIENTS", "")
HERE = os.path.dirname(os.path.abspath(__file__))
FRAMES = range(1, 6)


def skip(reason):
    """Ends the proof as skipped: its client is not here."""
    print("skipped: %s (tool/test --clients installs it)" % reason)
    sys.exit(77)


def check(condition, what):
    """Ends the proof as failed unless the client agrees."""
    if not condition:
        sys.exit("the client disagrees: %s" % what)


def need_program(name):
    path = shutil.which(name)
    if not path:
        skip("no %s on PATH" % name)
    return path


def need_python(module):
    """A Python interpreter that can import the module: Debian's packages are for Debian's own, which may not come first on PATH."""
    for folder in os.environ.get("PATH", "").split(os.pathsep):
        python = os.path.join(folder, "python3")
        if os.access(python, os.X_OK) and subprocess.run([python, "-c", "import " + module], capture_output=True).returncode == 0:
            return python
    return skip("no python3 on PATH has the module %s" % module)


def need_node(*packages):
    """Node.js with npm packages; returns a function that runs a script of this folder and returns what it printed."""
    node = need_program("node")
    for package in packages:
        if not os.path.isdir(os.path.join(CLIENTS, "node_modules", package)):
            skip("no npm package %s in %s" % (package, CLIENTS))

    def run(script, *arguments):
        # Modules are looked for from the script's own folder upwards: the script joins its packages.
        copy = os.path.join(CLIENTS, script)
        shutil.copyfile(os.path.join(HERE, script), copy)
        return run_program([node, copy] + list(arguments))

    return run


def run_program(arguments):
    """Standard output of a program; a proof whose client cannot even run has failed."""
    ran = subprocess.run(arguments, capture_output=True, text=True)
    if ran.returncode != 0:
        sys.exit("%s: status %d\n%s\n%s" % (" ".join(arguments), ran.returncode, ran.stdout[-4000:], ran.stderr[-4000:]))
    return ran.stdout


def softreel(*arguments):
    return run_program([SOFTREEL] + list(arguments) + ["--quiet"])


def work_folder():
    """A temporary folder that goes with the proof."""
    return tempfile.TemporaryDirectory(prefix="softreel-client-")


def barrel_obj(rings=9, segments=12):
    """A closed barrel of quads and two fans of triangles, with texture coordinates that have a seam, in two groups."""
    lines = []
    for r in range(rings):
        height = r / (rings - 1)
        radius = 0.2 + 0.07 * math.sin(math.pi * height)
        for s in range(segments):
            angle = 2 * math.pi * s / segments
            lines.append("v %.9g %.9g %.9g" % (radius * math.sin(angle), height, radius * math.cos(angle)))
    lines += ["v 0 0 0", "v 0 1 0"]
    for r in range(rings):
        lines += ["vt %.9g %.9g" % (s / segments, r / (rings - 1)) for s in range(segments + 1)]
    lines += ["vt 0.5 0", "vt 0.5 1"]

    def corner(r, s):
        return "%d/%d" % (1 + r * segments + s % segments, 1 + r * (segments + 1) + s)

    low, high = ["%d/%d" % (rings * segments + k, rings * (segments + 1) + k) for k in (1, 2)]
    lines.append("g side")
    for r in range(rings - 1):
        lines += ["f %s %s %s %s" % (corner(r, s), corner(r, s + 1), corner(r + 1, s + 1), corner(r + 1, s))
                  for s in range(segments)]
    lines.append("g lids")
    for s in range(segments):
        lines.append("f %s %s %s" % (low, corner(0, s + 1), corner(0, s)))
        lines.append("f %s %s %s" % (high, corner(rings - 1, s), corner(rings - 1, s + 1)))
    return "\n".join(lines) + "\n"


SHOT = """schema = 1
[shot]
name = "barrel"
frames = [%d, %d]
mode = "static"
[gravity]
acceleration = [0, 0, 0]
[body.barrel]
mesh = "barrel.obj"
scale = 0.5
translate = [0.3, 0.1, -0.2]
tets = 900
material = "soft"
[[body.barrel.pin]]
select = { box = { min = [0, 0, 0], max = [1, 0.12, 1] }, unit = "box" }
[[body.barrel.pin]]
select = { box = { min = [0, 0.88, 0], max = [1, 1, 1] }, unit = "box" }
keys = [ { frame = 1 }, { frame = 5, translate = [0.03, 0.04, 0], rotate_deg = [0, 40, 0], pivot = [0.3, 0.1, -0.2] } ]
[material.soft]
youngs_modulus = 2e4
[environment]
zenith = [0.6, 0.7, 0.9]
[render]
width = 96
height = 54
samples = 4
[output]
movie = false
""" % (FRAMES[0], FRAMES[-1])


def make_shot(folder, more=""):
    """barrel.obj and a shot that twists, lifts and bends it from frame 1, at rest, to 5; returns the shot's path."""
    with open(os.path.join(folder, "barrel.obj"), "w", encoding="utf-8") as f:
        f.write(barrel_obj())
    path = os.path.join(folder, "barrel.toml")
    with open(path, "w", encoding="utf-8") as f:
        f.write(SHOT + more)
    return path


def export(shot, folder, file_format, *options):
    softreel("export", shot, "--format", file_format, "--output", folder, *options)


def exported_positions(shot, folder, *options):
    """The truth of a proof: positions per frame as doubles, [frame][vertex] = (x, y, z), from softreel's PLY files."""
    export(shot, folder, "ply", *options)
    truth = {}
    for frame in FRAMES:
        truth[frame] = mesh_files.read_ply(os.path.join(folder, "barrel.barrel.%04d.ply" % frame)).positions
    check(truth[FRAMES[0]] != truth[FRAMES[-1]], "softreel's own frames do not differ: this shot proves nothing")
    return truth
