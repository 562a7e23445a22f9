#!/usr/bin/env python3
"""A processor without AVX2 gets one clear line and exit status 2, not an illegal instruction; one that has it goes on."""
import subprocess

import client


def run_on(processor):
    return subprocess.run([client.need_program("qemu-x86_64"), "-cpu", processor, client.SOFTREEL, "--version"],
                          capture_output=True, text=True)


old, new = run_on("Westmere"), run_on("Haswell")
client.check(old.returncode == 2 and "this processor lacks AVX2" in old.stderr and not old.stdout,
             "on a Westmere: %d %s" % (old.returncode, old.stderr))
client.check(new.returncode == 0 and new.stdout.startswith("softreel "), "on a Haswell: %d %s" % (new.returncode, new.stderr))
