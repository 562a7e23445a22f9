#!/usr/bin/env python3
"""A page that softreel wrote works in a browser: no script error, every image loads, and nothing is fetched from outside.

    page_proof.py golden            the page of softreel golden, of a picture that changed: with sliders
    page_proof.py bench PROGRAM     the page of softreel bench
    page_proof.py batch             the report of softreel batch, of two shots, one of which fails
"""
import json
import os
import subprocess
import sys

import client


def golden_page(folder):
    shot = client.make_shot(folder)
    options = ["--reference", os.path.join(folder, "golden"), "--output", os.path.join(folder, "out")]
    client.softreel("golden", shot, "--update", *options)
    ran = subprocess.run([client.SOFTREEL, "golden", shot, "--set", "environment.zenith=[0.9, 0.3, 0.1]", "--quiet"] + options,
                         capture_output=True, text=True)
    client.check(ran.returncode == 1, "another sky did not change the golden images: %s" % ran.stderr)
    return os.path.join(folder, "out", "golden.html"), 3


def bench_page(folder, program):
    # A figure that is missed on a busy machine is the benchmark's own matter: the page is there all the same.
    subprocess.run([program, "limits", "--quick", "--output", folder], capture_output=True, text=True)
    return os.path.join(folder, "index.html"), 1


def batch_page(folder):
    shot = client.make_shot(folder)
    # Flat: there is nothing to fill, which shows when the job runs.
    with open(shot, encoding="utf-8") as f:
        text = f.read().replace("barrel", "sheet")
    with open(os.path.join(folder, "sheet.toml"), "w", encoding="utf-8") as f:
        f.write(text)
    with open(os.path.join(folder, "sheet.obj"), "w", encoding="utf-8") as f:
        f.write("v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n")
    ran = subprocess.run([client.SOFTREEL, "batch", shot, os.path.join(folder, "sheet.toml"), "--sweep",
                          "material.soft.youngs_modulus=1e4,2e4", "--frames", "1-2", "--output", os.path.join(folder, "out"),
                          "--report", os.path.join(folder, "report"), "--quiet"], capture_output=True, text=True)
    client.check(ran.returncode == 1, "a batch with a shot that fails: status %d: %s" % (ran.returncode, ran.stderr))
    return os.path.join(folder, "report", "batch.html"), 2


def main():
    chromium = client.need_program("chromium")
    node = client.need_node("playwright-core")
    with client.work_folder() as folder:
        if sys.argv[1] == "golden":
            page, least_images = golden_page(folder)
        elif sys.argv[1] == "batch":
            page, least_images = batch_page(folder)
        else:
            page, least_images = bench_page(folder, sys.argv[2])
        picture = os.path.join(folder, "page.png")
        seen = json.loads(node("open_page.mjs", json.dumps({"chromium": chromium, "page": page, "picture": picture})))
        if "SOFTREEL_KEEP_PAGES" in os.environ:
            os.replace(picture, os.path.join(os.environ["SOFTREEL_KEEP_PAGES"], sys.argv[1] + ".png"))
    client.check(not seen["errors"], "script errors: %s" % seen["errors"])
    client.check(not seen["outside"], "fetched from outside: %s" % seen["outside"])
    client.check(not seen["failed"], "requests that failed: %s" % seen["failed"])
    client.check(not seen["broken"], "images that do not load: %s" % seen["broken"])
    client.check(seen["images"] >= least_images, "%d images instead of at least %d" % (seen["images"], least_images))
    client.check(seen["letters"] > 20, "the page shows no text")
    client.check(seen["width"] <= seen["room"], "the page is %d wide in a window of %d" % (seen["width"], seen["room"]))
    print("%s: page \"%s\", %d images, no error" % (seen["browser"], seen["title"], seen["images"]))


if __name__ == "__main__":
    main()
