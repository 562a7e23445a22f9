#!/usr/bin/env python3
"""The Khronos glTF validator finds nothing wrong with a GLB, or three.js plays it and has the positions that softreel wrote.

    gltf_proof.py validator | three

three.js sums float32 targets times weights: its positions may differ by 1.2e-7 of the body's largest coordinate.
"""
import json
import os
import sys

import client

TOLERANCE = 1.2e-7


def validate(folder, path):
    node = client.need_node("gltf-validator")
    report = json.loads(node("validate_gltf.mjs", path))
    counts = report["issues"]
    for message in report["issues"]["messages"]:
        print("%s %s: %s" % (message["code"], message.get("pointer", ""), message["message"]))
    client.check(counts["numErrors"] == 0 and counts["numWarnings"] == 0,
                 "%d errors, %d warnings" % (counts["numErrors"], counts["numWarnings"]))
    client.check(report["info"]["animationCount"] == 1 and report["info"]["hasMorphTargets"], "nothing is animated")
    print("glTF validator %s: 0 errors, 0 warnings" % report["validatorVersion"])


def compare(read, truth, where):
    """The largest error over the frames, as a share of the size."""
    size = max(abs(c) for frame in truth.values() for p in frame for c in p)
    worst = 0.0
    for frame in client.FRAMES:
        got = read["frames"][str(frame)][where]
        client.check(len(got) == len(truth[frame]), "frame %d has %d vertices" % (frame, len(got)))
        for v, (p, q) in enumerate(zip(got, truth[frame])):
            error = max(abs(a - b) for a, b in zip(p, q)) / size
            worst = max(worst, error)
            client.check(error <= TOLERANCE, "%s, frame %d: vertex %d is %r instead of %r" % (where, frame, v, p, q))
    return worst


def play(shot, folder, path):
    node = client.need_node("three")
    truth = client.exported_positions(shot, folder)
    in_world = client.exported_positions(shot, os.path.join(folder, "world"), "--space", "world")
    settings = {"glb": path, "fps": 24, "frames": list(client.FRAMES), "vertices": len(truth[1])}
    read = json.loads(node("read_glb.mjs", json.dumps(settings)))
    worst, worst_in_world = compare(read, truth, "mesh"), compare(read, in_world, "world")
    print("three.js r%s: %d frames of %d vertices, largest error %.2g of the size, in the world %.2g" %
          (read["revision"], len(client.FRAMES), len(truth[1]), worst, worst_in_world))


def main():
    client.need_node("gltf-validator" if sys.argv[1] == "validator" else "three")
    with client.work_folder() as folder:
        shot = client.make_shot(folder)
        client.export(shot, folder, "glb")
        path = os.path.join(folder, "barrel.barrel.glb")
        validate(folder, path) if sys.argv[1] == "validator" else play(shot, folder, path)


if __name__ == "__main__":
    main()
