"""Runs inside Blender: reads an export of the proof's shot and writes the vertices of every frame as JSON."""
import json
import os
import sys

import bpy

FRAMES = range(1, 6)


def vertices(mesh):
    return [tuple(v.co) for v in mesh.vertices]


def import_mesh(path):
    """The one new object; axes as in the file."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    if path.endswith(".obj"):
        bpy.ops.wm.obj_import(filepath=path, forward_axis="Y", up_axis="Z")
    else:
        bpy.ops.import_mesh.ply(filepath=path)
    (imported,) = bpy.context.scene.objects
    return imported


def read_sequence(folder, file_format):
    return {frame: vertices(import_mesh(os.path.join(folder, "barrel.barrel.%04d.%s" % (frame, file_format))).data)
            for frame in FRAMES}


def read_cache(folder, file_format):
    body = import_mesh(os.path.join(folder, "barrel.barrel.0001.obj"))
    modifier = body.modifiers.new("cache", "MESH_CACHE")
    modifier.cache_format = file_format.upper()
    modifier.filepath = os.path.join(folder, "barrel.barrel." + file_format)
    modifier.interpolation = "NONE"
    modifier.time_mode = "FRAME"
    modifier.play_mode = "SCENE"
    modifier.frame_start = FRAMES[0]
    read = {}
    for frame in FRAMES:
        bpy.context.scene.frame_set(frame)
        evaluated = body.evaluated_get(bpy.context.evaluated_depsgraph_get())
        read[frame] = vertices(evaluated.to_mesh())
        evaluated.to_mesh_clear()
    return read


def main():
    file_format, folder, result = sys.argv[sys.argv.index("--") + 1:]
    read = read_sequence(folder, file_format) if file_format in ("obj", "ply") else read_cache(folder, file_format)
    read["version"] = bpy.app.version_string
    with open(result, "w", encoding="utf-8") as f:
        json.dump(read, f)


main()
