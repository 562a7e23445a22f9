#!/usr/bin/env python3
"""Feeds the program every file of Debian's assimp-testmodels: each is filled with sound tetrahedra or refused in one message.

    check_models.py PROGRAM [FOLDER]

Two files at a time, each within a minute of processor time. Prints by format how many were filled, how many read but not filled (flat, open,
too thin at this size), and how many not read. Without the package it says so and exits with 77, which ctest shows as skipped.
"""
import collections
import concurrent.futures
import json
import os
import signal
import subprocess
import sys
import tempfile

FOLDER = "/usr/share/assimp/models"
SECONDS = 60  # of the processor, so that a busy machine fails nothing
WAITING_SECONDS = 900
TETS = 2000
# What lies beside the models: textures, shaders, notes, data that a model file names.
BESIDE = {".png", ".jpg", ".tga", ".bmp", ".glsl", ".vert", ".frag", ".txt", ".md", ".mtl", ".bin", ".material", ".uc"}


def models(folder):
    for place, _, names in os.walk(folder):
        for name in names:
            if os.path.splitext(name)[1].lower() not in BESIDE:
                yield os.path.join(place, name)


def messages(text):
    return [line for line in text.splitlines() if line.startswith("softreel: ")]


class Model:
    """One file: `outcome` is filled, not filled or not read; `wrong` says how the program broke a promise, or is empty."""

    def __init__(self, program, path, folder):
        self.format = os.path.splitext(path)[1].lower() or "no ending"
        self.path = path
        self.wrong = []
        self.program = program
        facts = self.run(["inspect", path, "--json"])
        output = os.path.join(folder, "x.vtu")
        mesh = self.run(["tetrahedralize", path, "-o", output, "--tets", str(TETS), "--threads", "1", "--json"])
        self.outcome = "filled" if mesh else "not filled" if facts else "not read"
        if facts and not facts["triangles"] > 0:
            self.wrong.append("inspect tells of no triangle")
        if mesh:
            self.check_mesh(mesh, output)
        left = os.listdir(folder)
        if left != (["x.vtu"] if mesh else []):
            self.wrong.append("files left behind: %s" % left)

    def run(self, arguments):
        """What the command printed as JSON, or None if it refused the file, in one message that names it."""
        limited = ["sh", "-c", "ulimit -t %d; exec \"$@\"" % SECONDS, "sh", self.program]
        try:
            ran = subprocess.run(limited + arguments, capture_output=True, timeout=WAITING_SECONDS)
        except subprocess.TimeoutExpired:
            self.wrong.append("%s hung for %d s" % (arguments[0], WAITING_SECONDS))
            return None
        said = ran.stderr.decode("utf-8", "replace")
        if ran.returncode == 0:
            return json.loads(ran.stdout.decode("utf-8"))
        if ran.returncode in (-signal.SIGXCPU, -signal.SIGKILL):
            self.wrong.append("%s ran for more than %d s" % (arguments[0], SECONDS))
            return None
        if ran.returncode != 2:
            self.wrong.append("%s: exit status %d: %s" % (arguments[0], ran.returncode, said))
        if len(messages(said)) != 1 or self.path not in messages(said)[0] or ran.stdout:
            self.wrong.append("%s: no clear refusal: %s" % (arguments[0], said))
        return None

    def check_mesh(self, mesh, output):
        sound = (mesh["tets"] > 0 and mesh["volume"] > 0 and mesh["min_dihedral_deg"] >= 10.2
                 and mesh["max_dihedral_deg"] <= 164.8 and os.path.getsize(output) > 100 * mesh["tets"] ** 0.5)
        if not sound:
            self.wrong.append("the mesh is not sound: %s" % mesh)


def check(program, path):
    with tempfile.TemporaryDirectory() as folder:
        return Model(program, path, folder)


def print_table(results):
    kinds = ("filled", "not filled", "not read")
    table = collections.defaultdict(collections.Counter)
    for model in results:
        table[model.format][model.outcome] += 1
        table["all"][model.outcome] += 1
    print("%-12s %12s %12s %12s" % (("format",) + kinds))
    for name, counts in sorted(table.items(), key=lambda row: (row[0] == "all", row[0])):
        print("%-12s %12d %12d %12d" % ((name,) + tuple(counts[kind] for kind in kinds)))


def main():
    program = os.path.abspath(sys.argv[1])
    folder = sys.argv[2] if len(sys.argv) > 2 else FOLDER
    paths = sorted(models(folder))
    if not paths:
        print("skipped: no models in %s; the Debian package assimp-testmodels has them" % folder)
        return 77
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        results = list(pool.map(lambda path: check(program, path), paths))
    print_table(results)
    wrong = [model for model in results if model.wrong]
    for model in wrong:
        print("%s\n  %s" % (model.path, "\n  ".join(model.wrong)))
    print("%d files, %d wrong" % (len(results), len(wrong)))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
