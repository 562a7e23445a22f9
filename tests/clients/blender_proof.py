#!/usr/bin/env python3
"""Blender reads an export and has the positions that softreel wrote, bit for bit.

    blender_proof.py obj | ply | pc2 | mdd

Blender keeps float32: it must have the nearest one of each double. Point caches are put on the first frame's mesh by the Mesh Cache
modifier and evaluated at every frame, as a user would do it.
"""
import json
import os
import sys

import client
import mesh_files


def main():
    file_format = sys.argv[1]
    blender = client.need_program("blender")
    with client.work_folder() as folder:
        shot = client.make_shot(folder)
        truth = client.exported_positions(shot, folder)
        client.export(shot, folder, file_format)
        client.export(shot, folder, "obj", "--frames", "1")  # the mesh that carries the caches
        result = os.path.join(folder, "read.json")
        client.run_program([blender, "--background", "--factory-startup", "--python-exit-code", "1",
                            "--python", os.path.join(client.HERE, "blender_reads.py"), "--", file_format, folder, result])
        with open(result, encoding="utf-8") as f:
            read = json.load(f)
    for frame in client.FRAMES:
        got = [tuple(p) for p in read[str(frame)]]
        difference = mesh_files.first_difference(got, mesh_files.rounded(truth[frame]))
        client.check(not difference, "%s, frame %d: %s" % (file_format, frame, difference))
    print("Blender %s: %d frames of %d vertices, bit for bit" % (read["version"], len(client.FRAMES), len(truth[1])))


if __name__ == "__main__":
    main()
