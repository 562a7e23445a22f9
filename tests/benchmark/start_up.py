#!/usr/bin/env python3
"""How long the program takes to start: median wall time of every command that does little else, and what it loads.

  start_up.py PROGRAM [RUNS]

PROGRAM is the built softreel, RUNS how often each command runs [40]. Prints tab-separated values: command, median_ms,
libraries. The first row, of /bin/true, is what any process costs here. Commands take turns, so that a slow second of the
machine does not fall on one of them.
"""
import json
import os
import re
import statistics
import subprocess
import sys
import tempfile
import time

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
SHOT = os.path.join("presets", "first_pull.toml")
CUBE = """v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
v 0 0 1
v 1 0 1
v 1 1 1
v 0 1 1
f 4 3 2 1
f 5 6 7 8
f 1 2 6 5
f 2 3 7 6
f 3 4 8 7
f 4 1 5 8
"""


def subcommands(program):
    """The names in the program's own table of commands."""
    text = subprocess.run([program, "completion", "json"], check=True, capture_output=True, text=True).stdout
    names = [command["name"] for command in json.loads(text)["commands"]]
    if not names:
        sys.exit("start_up.py: %s --help lists no subcommands" % program)
    return names


def command_lines(program, mesh):
    names = subcommands(program)
    lines = [["/bin/true"], [program, "--help"]]
    lines += [[program, name, "--help"] for name in names]
    lines += [[program, "fields"], [program, "check", SHOT], [program, "inspect", mesh]]
    if "status" in names:
        lines.append([program, "status", SHOT])
    return lines


def run_once(line):
    """Wall time, ms. Exits if the command fails: a failure is quick, and says nothing of the start."""
    start = time.perf_counter()
    done = subprocess.run(line, cwd=ROOT, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    elapsed = 1e3 * (time.perf_counter() - start)
    if done.returncode != 0:
        sys.exit("start_up.py: %s: status %d\n%s" % (" ".join(line), done.returncode, done.stderr.decode()))
    return elapsed


def libraries(line, folder):
    """Names of the shared libraries that the command loads, in the order of their initialisation."""
    log = tempfile.mkdtemp(dir=folder)
    environment = dict(os.environ, LD_DEBUG="files", LD_DEBUG_OUTPUT=os.path.join(log, "loader"))
    subprocess.run(line, cwd=ROOT, check=True, env=environment, stdout=subprocess.DEVNULL)
    text = "".join(open(os.path.join(log, name)).read() for name in sorted(os.listdir(log)))
    names = [os.path.basename(path) for path in re.findall(r"calling init: (\S+)", text)]
    return [name for name in names if not name.startswith("ld-linux")]


def main():
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    program, runs = os.path.abspath(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) == 3 else 40
    with tempfile.TemporaryDirectory() as folder:
        mesh = os.path.join(folder, "cube.obj")
        with open(mesh, "w") as file:
            file.write(CUBE)
        lines = command_lines(program, mesh)
        times = [[] for _ in lines]
        for _ in range(runs):
            for line, of_line in zip(lines, times):
                of_line.append(run_once(line))
        print("command\tmedian_ms\tlibraries")
        for line, of_line in zip(lines, times):
            shown = " ".join(os.path.basename(word) if os.path.isabs(word) else word for word in line)
            print("%s\t%.2f\t%s" % (shown, statistics.median(of_line), " ".join(libraries(line, folder))))


if __name__ == "__main__":
    main()
