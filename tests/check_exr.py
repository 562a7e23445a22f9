#!/usr/bin/env python3
"""The multichannel EXR of a shot, read by a reader of our own that shares no code with the writer.

Usage: check_exr.py SOFTREEL. Renders two bodies, one of which a pin carries as a whole, and checks names, metadata and
values of the channels: motion vectors against the pin's speed, depth against position, Cryptomatte against its manifest.
"""
import json
import math
import os
import struct
import subprocess
import sys
import tempfile
import zlib

WIDTH, HEIGHT = 96, 54
CAMERA = (0.0, 1.0, 6.0)
FOCAL, SENSOR = 50.0, 36.0
SPEED = 0.06  # m a frame, along x

SHOT = """schema = 1
[shot]
name = "two"
frames = [1, 3]
[body.carried]
mesh = "box.obj"
edge = 0.3
translate = [-0.8, 0.5, 0]
material = "gum"
[[body.carried.pin]]
select = { box = { min = [-0.1, -0.1, -0.1], max = [1.1, 1.1, 1.1] }, unit = "box" }
keys = [ { frame = 1, ease = "linear" }, { frame = 3, translate = [%g, 0, 0] } ]
[body.standing]
mesh = "box.obj"
edge = 0.3
translate = [0.8, 0.5, 0]
material = "wax"
[[body.standing.pin]]
select = { box = { min = [-0.1, -0.1, -0.1], max = [1.1, 1.1, 1.1] }, unit = "box" }
[material.gum]
[material.wax]
[camera]
mode = "place"
position = [0, 1, 6]
target = [0, 1, 0]
focal_length_mm = %g
sensor_width_mm = %g
[render]
width = %d
height = %d
samples = 16
max_bounces = 1
channels = ["albedo", "normal", "depth", "position", "motion", "object_id", "material_id", "strain", "samples"]
[output]
png = false
exr = true
movie = false
""" % (2 * SPEED, FOCAL, SENSOR, WIDTH, HEIGHT)


def box_obj():
    corners = [(x, y, z) for z in (-0.4, 0.4) for y in (0, 0.8) for x in (-0.4, 0.4)]
    faces = [(1, 3, 4, 2), (5, 6, 8, 7), (1, 2, 6, 5), (3, 7, 8, 4), (1, 5, 7, 3), (2, 4, 8, 6)]
    lines = ["v %g %g %g" % c for c in corners] + ["f " + " ".join(map(str, f)) for f in faces]
    return "\n".join(lines) + "\n"


def text_to_zero(data, at):
    end = data.index(b"\0", at)
    return data[at:end].decode("utf-8"), end + 1


def read_exr(path):
    """{channel: rows of floats}, {attribute: text}; scan lines, ZIP, 32-bit float (OpenEXR file layout)."""
    with open(path, "rb") as f:
        data = f.read()
    assert struct.unpack_from("<I", data)[0] == 20000630, "magic number"
    assert data[4] == 2, "version"
    at, channels, texts, window, compression = 8, [], {}, None, None
    while data[at] != 0:
        name, at = text_to_zero(data, at)
        kind, at = text_to_zero(data, at)
        size = struct.unpack_from("<i", data, at)[0]
        value = data[at + 4:at + 4 + size]
        at += 4 + size
        if kind == "chlist":
            p = 0
            while value[p] != 0:
                channel, p = text_to_zero(value, p)
                assert struct.unpack_from("<i", value, p)[0] == 2, channel + " is no 32-bit float"
                channels.append(channel)
                p += 16
        elif kind == "string":
            texts[name] = value.decode("utf-8")
        elif name == "dataWindow":
            window = struct.unpack("<4i", value)
        elif name == "compression":
            compression = value[0]
    at += 1
    assert compression == 3, "ZIP of 16 lines"
    width, height = window[2] - window[0] + 1, window[3] - window[1] + 1
    planes = {channel: [None] * height for channel in channels}
    blocks = (height + 15) // 16
    for offset in struct.unpack_from("<%dQ" % blocks, data, at):
        y, size = struct.unpack_from("<ii", data, offset)
        lines = min(16, height - y)
        raw = lines * width * 4 * len(channels)
        block = data[offset + 8:offset + 8 + size]
        if size < raw:
            packed = bytearray(zlib.decompress(block))
            for k in range(1, len(packed)):
                packed[k] = (packed[k - 1] + packed[k] - 128) & 255
            half = (len(packed) + 1) // 2
            block = bytearray(len(packed))
            block[0::2] = packed[:half]
            block[1::2] = packed[half:]
        for line in range(lines):
            for c, channel in enumerate(channels):
                start = (line * len(channels) + c) * width * 4
                planes[channel][y + line] = struct.unpack_from("<%df" % width, block, start)
    return planes, texts


def murmur3(name):
    data, h = name.encode("utf-8"), 0
    rotate = lambda x, r: ((x << r) | (x >> (32 - r))) & 0xFFFFFFFF
    whole = len(data) // 4 * 4
    for k in range(0, whole, 4):
        word = struct.unpack_from("<I", data, k)[0]
        h ^= rotate(word * 0xCC9E2D51 & 0xFFFFFFFF, 15) * 0x1B873593 & 0xFFFFFFFF
        h = (rotate(h, 13) * 5 + 0xE6546B64) & 0xFFFFFFFF
    tail = int.from_bytes(data[whole:], "little")
    if tail:
        h ^= rotate(tail * 0xCC9E2D51 & 0xFFFFFFFF, 15) * 0x1B873593 & 0xFFFFFFFF
    h ^= len(data)
    for multiplier, shift in ((0x85EBCA6B, 16), (0xC2B2AE35, 13)):
        h = ((h ^ (h >> shift)) * multiplier) & 0xFFFFFFFF
    return h ^ (h >> 16)


def id_of(name):
    h = murmur3(name)
    return h ^ (1 << 23) if (h >> 23 & 255) in (0, 255) else h


def bits(value):
    return struct.unpack("<I", struct.pack("<f", value))[0]


def coverages(planes, layer, x, y):
    found = {}
    for rank in range(3):
        for a, b in (("R", "G"), ("B", "A")):
            covered = planes["%s%02d.%s" % (layer, rank, b)][y][x]
            if covered > 0:
                found[bits(planes["%s%02d.%s" % (layer, rank, a)][y][x])] = covered
    return found


def check(condition, message):
    if not condition:
        raise AssertionError(message)


def check_names(planes, texts):
    wanted = ["R", "G", "B", "albedo.R", "albedo.G", "albedo.B", "normal.X", "normal.Y", "normal.Z", "depth.Z",
              "position.X", "position.Y", "position.Z", "motion.X", "motion.Y", "strain.V", "samples.N"]
    for layer in ("CryptoObject", "CryptoMaterial"):
        wanted += ["%s%02d.%s" % (layer, rank, part) for rank in range(3) for part in "RGBA"]
    check(sorted(planes) == sorted(wanted), "channels: %s" % sorted(planes))
    for layer, names in (("CryptoObject", ["carried", "standing"]), ("CryptoMaterial", ["gum", "wax"])):
        key = "cryptomatte/%s/" % ("%08x" % id_of(layer))[:7]
        check(texts.get(key + "name") == layer, "metadata of " + layer)
        check(texts.get(key + "hash") == "MurmurHash3_32", "hash")
        check(texts.get(key + "conversion") == "uint32_to_float32", "conversion")
        manifest = json.loads(texts[key + "manifest"])
        check(manifest == {name: "%08x" % id_of(name) for name in names}, "manifest: %s" % manifest)


def check_values(planes, frame):
    scale = WIDTH / 2 / (SENSOR / 2 / FOCAL)  # pixels a metre, one metre ahead
    seen = {"carried": 0, "standing": 0}
    for y in range(HEIGHT):
        for x in range(WIDTH):
            at = lambda channel: planes[channel][y][x]
            objects = coverages(planes, "CryptoObject", x, y)
            check(sum(objects.values()) < 1 + 1e-5, "coverage")
            check(at("samples.N") == 16, "samples")
            if list(objects.values()) != [1]:
                continue
            name = "carried" if id_of("carried") in objects else "standing"
            seen[name] += 1
            material = coverages(planes, "CryptoMaterial", x, y)
            check(material == {id_of("gum" if name == "carried" else "wax"): 1}, "material of " + name)
            if at("normal.Z") < 0.999:
                continue  # the front only: its depth is the same everywhere
            position = [at("position." + c) for c in "XYZ"]
            check(abs(position[2] - 0.4) < 1e-3, "front at 0.4 m: %g" % position[2])
            distance = math.dist(position, CAMERA)
            check(abs(at("depth.Z") - distance) < 2e-3 * distance, "depth %g for %g" % (at("depth.Z"), distance))
            ahead = CAMERA[2] - position[2]
            check(abs(x + 0.5 - WIDTH / 2 - scale * position[0] / ahead) < 0.2, "position under its pixel")
            expected = SPEED * scale / ahead if name == "carried" else 0
            check(abs(at("motion.X") - expected) < 2e-3, "frame %d, motion %g for %g" % (frame, at("motion.X"), expected))
            check(abs(at("motion.Y")) < 1e-4, "motion.Y %g" % at("motion.Y"))
    check(min(seen.values()) > 50, "both bodies are seen: %s" % seen)


def main():
    program = sys.argv[1]
    with tempfile.TemporaryDirectory() as folder:
        with open(os.path.join(folder, "box.obj"), "w") as f:
            f.write(box_obj())
        with open(os.path.join(folder, "two.toml"), "w") as f:
            f.write(SHOT)
        out = os.path.join(folder, "out")
        subprocess.run([program, "render", os.path.join(folder, "two.toml"), "--output", out, "--quiet"], check=True)
        for frame in (1, 2, 3):  # the last one goes on as from the one before
            planes, texts = read_exr(os.path.join(out, "two.%04d.exr" % frame))
            check_names(planes, texts)
            check_values(planes, frame)
    print("exr: 3 frames of %d channels, all as they should be" % len(planes))
    return 0


if __name__ == "__main__":
    sys.exit(main())
