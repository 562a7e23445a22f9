#!/usr/bin/env python3
"""The rules of the source that a search can check: formatting, direction of includes, fences, budgets, paths.

Prints each violation as FILE:LINE: what is wrong; exit status 1 if there is any.
"""
import graphlib
import os
import re
import subprocess
import sys

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
MAX_FILE_LINES = 400

# Layers from the bottom; a folder may include itself and those above it in this list (that stand before it).
CORE_ORDER = ["base", "mesh", "tetmesh", "sparse", "elasticity", "multigrid", "constraints", "dynamics"]
SKINNING_MAY = {"base", "mesh", "tetmesh", "skinning"}
RENDER_MAY = {"base", "mesh"}

# Header pattern, the only files that may include it.
FENCES = [
    (r"<assimp/", r"core/mesh/readers/assimp_(scene_)?reader\.cpp$"),
    (r"<(tbb|oneapi)/", r"core/base/parallel\.(h|cpp)$"),
    (r"<embree3/", r"render/pathtrace/rays/(ray_scene_embree\.cpp|rays_embree\.h)$"),
    (r"<(EGL|GL|epoxy)/", r"render/preview/egl/[a-z_]+\.(cpp|h)$"),
    (r"<(Imf|Imath|OpenEXR|png\.h|stb)", r"render/image/image_io\.cpp$"),
    (r"<openvdb/", r"(tool/export/level_set_openvdb|tests/tool/export/level_set_test)\.cpp$"),
    (r"<(toml\+\+|nlohmann|CLI)/", r"^(tool|tests/tool)/"),
    (r"<(petsc|cholmod|Eigen/CholmodSupport)", r"^tests/benchmark/rivals/"),
    (r"<(immintrin|x86intrin)", r"core/(sparse/row_product|tetmesh/lane_mask)_simd\.h$"),
    (r"<experimental/simd", r"_simd\.cpp$"),
    (r'"core/sparse/row_product_simd\.h', r"(core/multigrid/smoother_rows\.h|tests/core/sparse/block_kernels_test\.cpp)$"),
    (r'"core/tetmesh/lane_mask_simd\.h', r"core/tetmesh/triangle_tree\.h$"),
    (r'"core/multigrid/smoother_rows\.h', r"core/multigrid/[a-z_]+\.cpp$"),
]


def sources():
    # Of a checkout that another user owns too, as in a container with a mounted folder.
    listed = subprocess.run(["git", "-c", "safe.directory=*", "ls-files", "-co", "--exclude-standard", "*.h", "*.cpp"],
                            cwd=ROOT, check=True, stdout=subprocess.PIPE, text=True).stdout
    return [path for path in listed.splitlines() if os.path.exists(os.path.join(ROOT, path))]


def include_problem(path, included):
    """Why `path` may not include `included` (a path from the root), or None."""
    source, target = path.split("/"), included.split("/")
    rank = {"core": 0, "render": 1, "tool": 2}
    if source[0] not in rank or target[0] not in rank:
        return None
    if rank[target[0]] > rank[source[0]]:
        return "points against tool -> render -> core"
    if source[0] == "core" and target[0] == "core":
        a, b = source[1], target[1]
        if a == "skinning":
            return None if b in SKINNING_MAY else "skinning uses base, mesh and tetmesh only"
        # The solver carries where surface points sit: plain data of skinning.
        if a in ("constraints", "dynamics") and included == "core/skinning/embedding.h":
            return None
        if b not in CORE_ORDER or CORE_ORDER.index(b) > CORE_ORDER.index(a):
            return "core/%s may not include core/%s" % (a, b)
    if source[0] == "render" and target[0] == "core" and target[1] not in RENDER_MAY:
        return "render uses core/base and core/mesh only"
    return None


def check_file(path):
    with open(os.path.join(ROOT, path), encoding="utf-8") as f:
        lines = f.read().splitlines()
    found = []
    if len(lines) > MAX_FILE_LINES and "table" not in path:
        found.append((1, "has %d lines; at most %d are accepted: split it" % (len(lines), MAX_FILE_LINES)))
    if path.endswith(".h") and "#pragma once" not in lines:
        found.append((1, "has no #pragma once"))
    if path.endswith(".h") and not lines[0].startswith("///"):
        found.append((1, "does not open with a sentence that says what it is for"))
    for number, line in enumerate(lines, 1):
        match = re.match(r'\s*#\s*include\s*([<"])([^>"]+)[>"]', line)
        if match:
            if match.group(1) == '"':
                problem = include_problem(path, match.group(2))
                if problem:
                    found.append((number, problem))
                if "/" not in match.group(2):
                    found.append((number, "includes by path from the root only"))
            for pattern, allowed in FENCES:
                if re.match(pattern, match.group(1) + match.group(2)) and not re.search(allowed, path):
                    found.append((number, "%s is fenced off here" % match.group(2)))
        if re.search(r"\b(TODO|FIXME|XXX)\b", line):
            found.append((number, "unfinished work belongs into an issue"))
    return ["%s:%d: %s" % (path, number, what) for number, what in found]


def named_types(path):
    """What the linker takes for one type wherever it is defined: (its whole name, its line)."""
    spaces, found = [], []
    with open(os.path.join(ROOT, path), encoding="utf-8") as f:
        for number, line in enumerate(f, 1):
            match = re.match(r"namespace\s*([\w:]*)\s*{", line)
            if match:
                spaces.append(match.group(1))
            elif line.startswith("}  // namespace"):
                spaces.pop()
            match = re.match(r"(?:struct|class|union|enum(?: class)?) (\w+)(?: final)? [:{]", line)
            if match and "" not in spaces:  # an anonymous namespace keeps it apart
                found.append(("::".join(spaces + [match.group(1)]), number))
    return found


def types_defined_twice(paths):
    """Two types of one name in one program: one's destructor is called for the other, and no compiler says so."""
    places = {}
    for path in paths:
        for name, number in named_types(path):
            places.setdefault(name, []).append("%s:%d" % (path, number))
    return ["%s: %s is defined at %s too" % (where[1], name, where[0])
            for name, where in sorted(places.items()) if len(where) > 1]


def folder_circles(paths):
    """Folders of the program that include each other in a circle, by way of others too; one circle if there are any."""
    graph = {}
    for path in paths:
        if path.split("/")[0] not in ("core", "render", "tool"):
            continue
        with open(os.path.join(ROOT, path), encoding="utf-8") as f:
            included = re.findall(r'^\s*#\s*include\s*"([^"]+)"', f.read(), re.MULTILINE)
        folder = os.path.dirname(path)
        graph.setdefault(folder, set()).update(os.path.dirname(i) for i in included if os.path.dirname(i) != folder)
    try:
        graphlib.TopologicalSorter(graph).prepare()
    except graphlib.CycleError as error:
        return ["folders include each other in a circle: " + " <- ".join(error.args[1])]
    return []


def main():
    paths = sources()
    problems = [problem for path in paths for problem in check_file(path)]
    problems += types_defined_twice(paths)
    problems += folder_circles(paths)
    formatted = subprocess.run(["clang-format", "--dry-run", "-Werror"] + paths, cwd=ROOT, capture_output=True, text=True)
    misformatted = [line for line in formatted.stderr.splitlines() if "error:" in line][:20]
    if formatted.returncode != 0 and not misformatted:
        misformatted = ["clang-format ended with status %d: %s" % (formatted.returncode, formatted.stderr[-500:])]
    problems += misformatted
    if not paths:
        problems.append("git lists no source")
    for problem in problems:
        print(problem)
    print("source rules: %d files, %d problems" % (len(paths), len(problems)))
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
