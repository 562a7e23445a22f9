#!/usr/bin/env python3
"""three.js's USDA reader has the time samples that softreel wrote, bit for bit, and its loader makes the mesh of them."""
import json
import os

import client
import mesh_files


def main():
    node = client.need_node("three")
    with client.work_folder() as folder:
        shot = client.make_shot(folder)
        truth = client.exported_positions(shot, folder)
        client.export(shot, folder, "usda")
        (name,) = [n for n in os.listdir(folder) if n.endswith(".usda")]
        read = json.loads(node("read_usda.mjs", os.path.join(folder, name)))
        polygons = mesh_files.read_ply(os.path.join(folder, "barrel.barrel.0001.ply")).polygons
    (mesh,) = read["meshes"]
    client.check(mesh["times"] == list(client.FRAMES), "time samples at %r" % mesh["times"])
    for frame, points in zip(mesh["times"], mesh["points"]):
        # The type is point3f: a decimal stands for the float32 that is nearest to it.
        got = mesh_files.rounded(mesh_files.floats_to_points(points))
        difference = mesh_files.first_difference(got, mesh_files.rounded(truth[frame]))
        client.check(not difference, "frame %d: %s" % (frame, difference))
    client.check(mesh["counts"] == [len(p) for p in polygons], "the polygons' sizes are others")
    client.check(mesh["indices"] == [v for p in polygons for v in p], "the polygons' vertices are others")
    client.check(read["loaded"] == 1, "the loader makes %d meshes instead of 1" % read["loaded"])
    print("three.js r%s: %d time samples of %d points, bit for bit" % (read["revision"], len(mesh["times"]), len(truth[1])))


if __name__ == "__main__":
    main()
