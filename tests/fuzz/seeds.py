# SPDX-License-Identifier: MIT
"""Writes the first inputs of the fuzz targets: good files and conversations, for a fuzzer to spoil.

usage: seeds.py FOLDER      one folder below it for each target
"""
import os
import struct
import sys
import zlib

FOLDER = sys.argv[1]


def put(target, name, data):
    os.makedirs(os.path.join(FOLDER, target), exist_ok=True)
    with open(os.path.join(FOLDER, target, name), "wb") as out:
        out.write(data)


# ---- frames ----

def plane(role, form, width, height, offset, pixel, curve=0):
    stride = (width * pixel + 63) // 64 * 64
    return struct.pack("<IIIIIIQQQIfffQ", role, form, 1, width, height, 0, offset, stride, stride * height, curve,
                       0, 0, 0, 0)


def header(planes, motion=0, depth=0, frame_id=1):
    head = struct.pack("<5Q4I", frame_id, 10**9, 10**9, 16666667, 0, 0, len(planes), motion, depth)
    head += struct.pack("<4f", 0.1, 1000, 0, 0) + struct.pack("<32f", *([1.0] + [0.0] * 31))
    return (head + b"".join(planes)).ljust(1024, b"\0")


def small_frame(frame_id=1):
    planes = [plane(1, 1, 4, 2, 0, 4, 1), plane(2, 18, 4, 2, 128, 4), plane(3, 32, 4, 2, 256, 4)]
    return header(planes, motion=1, depth=1, frame_id=frame_id) + bytes(range(128)) * 3


def frames():
    put("frame", "whole", b"\x01\xfe\x10\x00" + header([plane(1, 1, 4, 2, 0, 4, 1)]))
    put("frame", "good", b"\x00\x06\x00\x10")
    for where in range(0, 256, 8):
        put("frame", f"patch-{where}", b"\x00\x06\x00\x10" + bytes([where, 1 + 4 * (where % 23), where + 1, 4 * 3]))


# ---- recordings ----

CHUNK_MAGIC = 0x4B4E484354495550


def chunk(kind, payload, sequence, compression=0, raw=None):
    raw = len(payload) if raw is None else raw
    head = struct.pack("<QIIQQQQQQ", CHUNK_MAGIC, kind, compression, len(payload), raw, sequence, 1, 0, 0)
    return head + payload + b"\0" * (-len(payload) % 8)


def recordings():
    start = struct.pack("<QIIQQ", 0x0A1A0D0A54495550, 1, 32, 0, 0)
    info, end = chunk(1, b"program=fuzz\n", 0), chunk(4, b"frames=2\n", 4)
    first, second = chunk(2, small_frame(1), 1), chunk(2, small_frame(2), 2)
    settings, later = chunk(3, b"cell=8\n", 3), chunk(77, b"of a later version", 3)
    put("recording", "good", b"\x03" + start + info + first + second + settings + end)
    put("recording", "unsealed", b"\x00" + start + info + first)
    put("recording", "gap", b"\x03" + start + info + second + end)
    put("recording", "cut", b"\x03" + start + info + first[:200])
    put("recording", "later", b"\x03" + start + info + later + end)
    put("recording", "long-header", b"\x03" + struct.pack("<QIIQQ", 0x0A1A0D0A54495550, 1, 40, 0, 0) + b"\0" * 8 + info)
    put("recording", "no-magic", b"\x03" + struct.pack("<QIIQQ", 7, 1, 32, 0, 0) + info + first)
    put("recording", "version-2", b"\x03" + struct.pack("<QIIQQ", 0x0A1A0D0A54495550, 2, 32, 0, 0) + info)
    put("recording", "zstd", b"\x03" + start + chunk(1, ZSTD_RAW, 0, 1, 6) + chunk(2, ZSTD_RAW, 1, 1, 6))
    put("recording", "garbage", b"\x03" + start + info + b"\x55" * 128 + second + end)


# A zstd frame with one raw block: magic, a frame header with the content size, "a=fuzz".
ZSTD_RAW = bytes.fromhex("28b52ffd2006310000613d66757a7a")


# ---- images ----

def png_chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def png(width, height, depth, color, pixel_bits, extra=b"", interlace=0):
    row = b"\0" + bytes((width * pixel_bits + 7) // 8)
    return (b"\x89PNG\r\n\x1a\n" + png_chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, depth, color, 0, 0, interlace))
            + extra + png_chunk(b"IDAT", zlib.compress(row * height)) + png_chunk(b"IEND", b""))


def attribute(name, kind, data):
    return name + b"\0" + kind + b"\0" + struct.pack("<I", len(data)) + data


def exr(channels, compression, tile=0, size=4):
    kinds = b"".join(name + b"\0" + struct.pack("<IBBBBii", kind, 0, 0, 0, 0, 1, 1) for name, kind in channels) + b"\0"
    box = struct.pack("<iiii", 0, 0, size - 1, size - 1)
    head = struct.pack("<II", 20000630, 2 | (0x200 if tile else 0))
    head += attribute(b"channels", b"chlist", kinds) + attribute(b"compression", b"compression", bytes([compression]))
    head += attribute(b"dataWindow", b"box2i", box) + attribute(b"displayWindow", b"box2i", box)
    head += attribute(b"lineOrder", b"lineOrder", b"\0") + attribute(b"pixelAspectRatio", b"float", struct.pack("<f", 1))
    head += attribute(b"screenWindowCenter", b"v2f", struct.pack("<ff", 0, 0))
    head += attribute(b"screenWindowWidth", b"float", struct.pack("<f", 1))
    if tile:
        head += attribute(b"tiles", b"tiledesc", struct.pack("<IIB", tile, tile, 0))
    head += b"\0"
    pixel = sum(2 if kind == 1 else 4 for _, kind in channels)
    blocks = []
    lines = {0: 1, 1: 1, 2: 1, 3: 16}.get(compression, 32)
    if tile:
        for y in range(0, size, tile):
            for x in range(0, size, tile):
                data = bytes(min(tile, size - x) * min(tile, size - y) * pixel)
                blocks.append(struct.pack("<iiii", x // tile, y // tile, 0, 0) + packed(data, compression))
    else:
        for y in range(0, size, lines):
            blocks.append(struct.pack("<i", y) + packed(bytes(size * min(lines, size - y) * pixel), compression))
    at, table = len(head) + 8 * len(blocks), b""
    for block in blocks:
        table += struct.pack("<Q", at)
        at += len(block)
    return head + table + b"".join(blocks)


def packed(data, compression):
    if compression in (2, 3):
        half = (len(data) + 1) // 2
        order = data[0::2] + data[1::2]
        assert len(order[:half]) == half
        delta = bytes([order[0]]) + bytes((order[i] - order[i - 1] + 128) & 255 for i in range(1, len(order)))
        small = zlib.compress(delta)
        data = small if len(small) < len(data) else data
    return struct.pack("<I", len(data)) + data


def images():
    palette = png_chunk(b"PLTE", bytes(range(12))) + png_chunk(b"tRNS", b"\x80\x40")
    for want in (2, 3):
        mark = bytes([want])
        put("image", f"png-rgb-{want}", mark + png(3, 2, 8, 2, 24))
        put("image", f"png-grey16-{want}", mark + png(3, 2, 16, 0, 16))
        put("image", f"png-palette-{want}", mark + png(3, 2, 2, 3, 2, palette))
        put("image", f"png-interlaced-{want}", mark + png(5, 5, 8, 6, 32, b"", 1))
        put("image", f"pfm-{want}", mark + b"PF\n2 2\n-1.0\n" + struct.pack("<12f", *range(12)))
        put("image", f"pfm-grey-{want}", mark + b"Pf\n3 1\n1.0\n" + struct.pack(">3f", 0.5, 1, 2))
        put("image", f"exr-half-{want}", mark + exr([(b"A", 1), (b"B", 1), (b"G", 1), (b"R", 1)], 0))
        put("image", f"exr-zip-{want}", mark + exr([(b"X", 2), (b"Y", 2)], 3))
        put("image", f"exr-zips-{want}", mark + exr([(b"Z", 2)], 2))
        put("image", f"exr-uint-{want}", mark + exr([(b"id", 0)], 0))
        put("image", f"exr-tiles-{want}", mark + exr([(b"Y", 1)], 0, tile=2))
        put("image", f"exr-tiles-zip-{want}", mark + exr([(b"U", 1), (b"V", 1)], 3, tile=3))
        put("image", f"nothing-{want}", mark + b"P")
    put("image", "exr-huge-tiles", b"\x03" + exr([(b"Y", 1)], 0).replace(struct.pack("<II", 20000630, 2), struct.pack("<II", 20000630, 0x202))
        .replace(attribute(b"screenWindowWidth", b"float", struct.pack("<f", 1)),
                 attribute(b"screenWindowWidth", b"float", struct.pack("<f", 1))
                 + attribute(b"tiles", b"tiledesc", struct.pack("<IIB", 32768, 32768, 0))))
    deep = attribute(b"type", b"string", b"deepscanline") + attribute(b"version", b"int", struct.pack("<i", 1))
    put("image", "exr-deep", b"\x03" + exr([(b"Z", 2)], 0).replace(struct.pack("<II", 20000630, 2), struct.pack("<II", 20000630, 0x802))
        .replace(attribute(b"screenWindowWidth", b"float", struct.pack("<f", 1)),
                 attribute(b"screenWindowWidth", b"float", struct.pack("<f", 1)) + deep
                 + attribute(b"maxSamplesPerPixel", b"int", struct.pack("<i", 1))
                 + attribute(b"name", b"string", b"a") + attribute(b"chunkCount", b"int", struct.pack("<i", 4))))
    put("image", "exr-no-channels", b"\x03" + exr([], 0))


# ---- texts ----

def texts():
    put("options", "file", b"\0# comment\ncell = 16\nrefresh=119.88\ncontext = egl-device:1\ngamma = 2.2\n")
    put("options", "file-2", b"\0blur = everywhere\nsocket = /tmp/x\ngles = yes\nrefresh = 120000/1001\n")
    put("options", "file-3", b"\0nonsense\n")
    put("options", "file-4", b"\0celll = 3\n")
    put("options", "file-5", b"\0snap-threshold = 0.75\ndisplay-width-mm = 300.5\nviewing-distance-mm = 1e3\n")
    put("options", "arguments", b"\x01--cell\0" b"16\0--no-compensation\0--gles=yes\0--method\0hold\0--record=x\0stray")
    put("options", "arguments-2", b"\x01--log-level=debug\0--refresh\0" b"59.94\0--no-cell\0--no-gles=yes\0--cell")
    put("options", "set", b"\x02refresh\x00144")
    put("options", "set-2", b"\x02context\0osmesa")
    put("options", "pattern", b"\x03c_%04d.png")
    put("options", "pattern-2", b"\x03%%a%d/%9x%1d")


# ---- conversations: step, who, what ... (fuzz-server.c, talker.c) ----

CONNECT, STEP, TAKE, CLOSE = b"\x04\x80", b"\0\0", b"\x01\0", b"\x03\0"


def act(what, data=b"", who=0):
    return bytes([5, who, what]) + data


def conversations():
    opened = CONNECT + STEP + act(2, b"\0\x01") + STEP + act(8)
    publish = act(5, b"\x02") + STEP + TAKE + STEP + act(8)
    put("server", "frames", b"\x01" + opened + publish + act(5, b"\x00") + STEP + TAKE + act(4, b"\x01\0") + STEP + act(8))
    put("server", "bad-slot", b"\x01" + opened + act(5, b"\x07") + STEP + TAKE + STEP + act(8))
    put("server", "bad-frame", b"\x01" + opened + act(5, b"\xe2" + b"\x32\x05" * 7) + STEP + TAKE + STEP + act(8))
    put("server", "stop", b"\x00" + opened + publish)
    for choices in (1, 2, 4, 8, 16, 32, 64, 128):
        put("server", f"open-{choices}", b"\x01" + CONNECT + STEP + act(2, bytes([choices, 1, 5, 5])) + STEP + act(8))
    requests = b"".join(act(9, bytes([i, 0])) + STEP + act(8) for i in range(12))
    put("server", "requests", b"\x01" + opened + requests)
    record = act(9, bytes([4, 13])) + STEP + publish + act(9, bytes([5, 0])) + STEP + STEP + act(8)
    put("server", "record", b"\x01" + opened + record)
    put("server", "request-text", b"\x01" + CONNECT + act(9, b"\x80\0\x0ctimeline 5 7") + STEP + act(8))
    put("server", "hello", b"\x01" + b"\x04\0" + act(0, b"\0\x01\x01\0\x04name") + STEP + act(8) + act(0) + STEP)
    put("server", "anything", b"\x01" + CONNECT + act(81, b"\x01\x02\x00\x01\x20" + bytes(64)) + STEP + act(8))
    streams = b"".join(act(2, bytes([0, i])) for i in range(1, 6))
    put("server", "streams", b"\x01" + CONNECT + STEP + streams + STEP + act(8))
    for kind in (0, 1, 2, 3, 5, 6, 0xe6, 0xf6):
        opening = struct.pack("<IIIIQIIQQQQ", 0, 0, 0, 0, 1, 4, 0, 4096, 0, 0, 0)
        put("server", f"fds-{kind}", b"\x01" + CONNECT + STEP + act(41, bytes([1, 2, kind, kind, 32]) + opening) + STEP
            + act(8))
    for count in (1, 4, 8, 11):
        put("server", f"many-fds-{count}", b"\x01" + CONNECT + STEP + act(11, bytes([1, count] + [0] * count + [48])
            + bytes(16) + struct.pack("<IIII", 0x54495550, 1, 1, 0) + bytes(64)) + STEP + act(8))
    control = struct.pack("<IIIIIIQ", 0, 0, 0, 0, 3, 0, 0)
    put("server", "status", b"\x01" + CONNECT + STEP + act(81, bytes([1, 0, 16]) + control) + STEP + act(8))
    put("server", "long-name", b"\x01\x04\0" + act(0, b"\0\x01\x01\0\x40" + b"n" * 64) + STEP + act(8))
    put("server", "crowd", b"\x01" + b"".join(bytes([4, i]) for i in range(4)) + STEP + b"\x02\0\xff\x02\0\xff"
        + bytes([3, 0]) + bytes([4, 0x80]) + STEP + act(8))
    packet = struct.pack("<IIII", 1, 96, 1, 0) + struct.pack("<IIII", 0x54495550, 1, 1, 0) + b"x".ljust(64, b"\0")
    put("server", "raw-hello", b"\x01" + b"\x04\0" + act(1, b"\0\0\x30" + packet) + STEP + act(8))


def shims():
    attach = b"\x03\x06\x07\x07" + bytes([10, 0, 0]) + bytes([10, 1, 0]) + b"\x03"
    put("shim", "attach", attach + b"\0\x01\0\x01\x09\x10\x09\x20\x04" + b"\0\0\x0d\x02\x04")
    put("shim", "lost", attach + b"\0\0\x8f\x03\x05\xff\x06\x03\x01\x0d" + attach)
    put("shim", "refused", b"\x06\x07" + bytes([10, 3, 0]) + b"\x03\x04\x05\xff\x03\x06")
    put("shim", "closed", attach + bytes([10, 3, 0, 10, 2, 0]) + b"\x03\x04")
    put("shim", "lying", attach + b"\0\x08\x00\x00\x08\x01\x04")


def slots():
    put("slots", "good", b"\x00\x02\x12\x07\x05\x00\x03\x1a\x07\x09\x04\x05")
    put("slots", "scribble", b"\x03\x12\x07\x05\x0a\x07\x05\x1a\x07\x05\x06\x02\x07\x05")
    put("slots", "bad-word", b"\x01\xff\x07\x00")
    put("slots", "bad-header", b"\x00\x52\x33\x04\x34\x05\x35\x09\x40\x0d\x41\x11\x12\x07\x05")
    put("slots", "anywhere", b"\x05\x10\x00\xff\xff\xff\xff\x12\x07\x05")


frames()
recordings()
images()
texts()
conversations()
shims()
slots()
