# SPDX-License-Identifier: MIT
"""A reader of recordings, written from docs/recording.md and docs/protocol.md alone."""
import ctypes
import ctypes.util
import struct

FILE_MAGIC, CHUNK_MAGIC = b"PUIT\n\r\x1a\n", b"PUITCHNK"
INFO, FRAME, SETTINGS, END = 1, 2, 3, 4
RAW_LIMIT = 1 << 28
ROLES = {1: "color", 2: "depth", 3: "motion", 4: "ui", 5: "object_id"}
PIXEL_BYTES = {1: 4, 2: 4, 3: 4, 4: 8, 16: 2, 17: 4, 18: 4, 32: 4, 33: 8, 48: 1, 49: 2, 50: 4}


def library(name):
    found = ctypes.util.find_library(name)
    return ctypes.CDLL(found) if found else None


ZSTD, XXHASH = library("zstd"), library("xxhash")


def checksum(data):
    XXHASH.XXH3_64bits.restype = ctypes.c_uint64
    return XXHASH.XXH3_64bits(bytes(data), ctypes.c_size_t(len(data)))


def unpack_zstd(data, raw_bytes):
    ZSTD.ZSTD_decompress.restype = ctypes.c_size_t
    out = ctypes.create_string_buffer(max(raw_bytes, 1))
    size = ZSTD.ZSTD_decompress(out, ctypes.c_size_t(raw_bytes), bytes(data), ctypes.c_size_t(len(data)))
    return out.raw[:raw_bytes] if size == raw_bytes else None


class Chunk:
    def __init__(self, header):
        (self.magic, self.type, self.compression, self.stored_bytes, self.raw_bytes, self.sequence, self.time_ns,
         self.payload_checksum, self.header_checksum) = struct.unpack("<8s2I6Q", header)
        self.believed = self.magic == CHUNK_MAGIC and self.header_checksum == checksum(header[:56])
        self.payload = None


class Frame:
    """A frame header, and of each plane its width, height, format and rows without gaps."""

    def __init__(self, payload):
        self.frame_id, self.time_ns, self.submit_ns, self.real_interval_ns, self.motion_interval_ns = struct.unpack_from(
            "<5Q", payload, 0)
        self.flags, count, self.motion_kind, self.depth_kind = struct.unpack_from("<4I", payload, 40)
        self.planes = {}
        for i in range(min(count, 8)):
            role, code, storage, width, height, _, offset, stride, size = struct.unpack_from("<6I3Q", payload, 200 + 72 * i)
            row = width * PIXEL_BYTES.get(code, 0)
            if storage != 1 or 1024 + offset + size > len(payload) or stride * (height - 1) + row > size:
                raise ValueError(f"plane {i} does not lie within its frame")
            start = 1024 + offset
            rows = b"".join(payload[start + y * stride:start + y * stride + row] for y in range(height))
            self.planes[ROLES.get(role, role)] = (width, height, code, rows)


def text(payload):
    return dict(line.split("=", 1) for line in payload.decode().split("\n") if "=" in line)


class Recording:
    """All chunks that can be believed. `cut`: the file ends within one; `lost`: chunks that were damaged."""

    def __init__(self, path):
        with open(path, "rb") as file:
            data = file.read()
        magic, self.version, header_bytes, self.created_ns, _ = struct.unpack_from("<8s2I2Q", data)
        if magic != FILE_MAGIC:
            raise ValueError("this is no recording")
        self.info, self.settings, self.frames, self.end, self.cut, self.lost = {}, [], [], None, False, 0
        at, expected = header_bytes, 0
        while at + 64 <= len(data):
            chunk = Chunk(data[at:at + 64])
            if not chunk.believed:
                at += 8
                continue
            if at + 64 + chunk.stored_bytes > len(data):
                self.cut = True
                break
            stored = data[at + 64:at + 64 + chunk.stored_bytes]
            if checksum(stored) != chunk.payload_checksum or chunk.raw_bytes > RAW_LIMIT:
                at += 8
                continue
            self.lost += chunk.sequence - expected
            expected = chunk.sequence + 1
            self.take(chunk, unpack_zstd(stored, chunk.raw_bytes) if chunk.compression == 1 else stored)
            at += 64 + (chunk.stored_bytes + 7) // 8 * 8

    def take(self, chunk, payload):
        if chunk.type == INFO:
            self.info = text(payload)
        elif chunk.type == FRAME:
            self.frames.append(Frame(payload))
        elif chunk.type == SETTINGS:
            self.settings.append(text(payload))
        elif chunk.type == END:
            self.end = text(payload)
