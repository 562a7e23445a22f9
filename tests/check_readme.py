#!/usr/bin/env python3
"""Runs the commands that README.md shows, with the built program in place of ./tool/run.

    check_readme.py PROGRAM

Works in a temporary folder that sees assets/, presets/ and tests/. The bare ./tool/run and ./tool/test are what runs this test.
"""
import os
import re
import shlex
import subprocess
import sys
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))


def commands():
    with open(os.path.join(ROOT, "README.md"), encoding="utf-8") as f:
        blocks = re.findall(r"```sh\n(.*?)```", f.read(), re.DOTALL)
    for line in "".join(blocks).splitlines():
        words = shlex.split(line, comments=True)
        if words and words[0] == "./tool/run" and len(words) > 1:
            yield words[1:]


def main():
    program = os.path.abspath(sys.argv[1])
    count = failed = 0
    with tempfile.TemporaryDirectory() as folder:
        for name in ("assets", "presets", "tests"):
            os.symlink(os.path.join(ROOT, name), os.path.join(folder, name))
        for arguments in commands():
            count += 1
            run = subprocess.run([program] + arguments, cwd=folder, capture_output=True, text=True)
            if run.returncode != 0:
                failed += 1
                print("softreel %s: status %d\n%s" % (" ".join(arguments), run.returncode, run.stderr))
    print("README: %d commands, %d failed" % (count, failed))
    return 1 if failed or count == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
