#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""A client without the shim: speaks docs/protocol.md with nothing but Python's standard library.

A picture of waves moves to the right by four pixels a frame; the daemon makes what lies between. The one thing that
Python lacks is the atomic exchange of a word in shared memory, which libatomic (it comes with the C compiler) has.

usage: example-python.py [--seconds S] [--fps F]
"""
import argparse
import array
import ctypes
import fcntl
import math
import mmap
import os
import select
import socket
import struct
import sys
import time

WIDTH, HEIGHT, PIXELS_A_FRAME = 640, 360, 4
SLOTS, HEADERS, REPORTS = 3, 192, 8384
FRESH = 1 << 31
HELLO, WELCOME, REFUSED, OPEN_STREAM, STREAM_OPENED = 1, 2, 3, 4, 5
COLOR, DEPTH, MOTION = 1, 2, 3
BGRA8, DEPTH32F, RG32F = 1, 18, 33
ACQUIRE_RELEASE = 4  # of C's memory_order
STATES = {1: "shown", 2: "replaced by a newer one", 3: "refused"}


def round_up(value, to):
    return (value + to - 1) // to * to


def socket_paths():
    """The first that is set counts; behind XDG_RUNTIME_DIR the system's daemon is tried too."""
    system = "/run/pursuit/socket"
    if os.environ.get("PURSUIT_SOCKET"):
        return [os.environ["PURSUIT_SOCKET"]]
    folder = os.environ.get("XDG_RUNTIME_DIR")
    return [folder + "/pursuit/socket", system] if folder else [system]


def connect():
    for path in socket_paths():
        link = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET | socket.SOCK_CLOEXEC)
        try:
            link.connect(path)
            return link
        except OSError as problem:
            link.close()
            print(f"{path}: {problem.strerror}", file=sys.stderr)
    sys.exit("no daemon answers; start pursuitd")


class Atomic:
    """A 32-bit word of shared memory. Reading and writing whole words is atomic as it is; exchanging needs help."""

    def __init__(self, memory, offset):
        self.exchange_4 = ctypes.CDLL("libatomic.so.1")["__atomic_exchange_4"]
        self.exchange_4.restype = ctypes.c_uint32
        self.word = ctypes.c_uint32.from_buffer(memory, offset)

    def exchange(self, value):
        return self.exchange_4(ctypes.byref(self.word), ctypes.c_uint32(value), ACQUIRE_RELEASE)


class Memory:
    """A memfd that can neither shrink nor grow, and its mapping."""

    def __init__(self, name, size):
        self.fd = os.memfd_create(name, os.MFD_CLOEXEC | os.MFD_ALLOW_SEALING)
        os.ftruncate(self.fd, size)
        fcntl.fcntl(self.fd, fcntl.F_ADD_SEALS, fcntl.F_SEAL_SHRINK | fcntl.F_SEAL_GROW | fcntl.F_SEAL_SEAL)
        self.map = mmap.mmap(self.fd, size)


class Stream:
    """A connection with one stream. `planes`: [(role, format, bytes a pixel)], all of WIDTH x HEIGHT."""

    def __init__(self, planes):
        self.planes, offset = [], 0
        for role, code, pixel in planes:
            self.planes.append((role, code, offset, pixel * WIDTH, pixel * WIDTH * HEIGHT))
            offset = round_up(offset + pixel * WIDTH * HEIGHT, 64)
        self.slot_bytes = round_up(offset, 4096)
        self.owned, self.frame_id, self.reports = list(range(2, SLOTS)), 0, 0
        self.control = Memory("control", 16384)
        self.memory = Memory("planes", SLOTS * self.slot_bytes)
        struct.pack_into("<4IQ", self.control.map, 0, 0x53525550, 1, SLOTS, 0, self.slot_bytes)
        self.latest = Atomic(self.control.map, 64)
        self.latest.exchange(1)
        self.link = connect()
        self.event = None
        self.attach()

    def attach(self):
        hello = struct.pack("<4I 4I 64s", HELLO, 96, 1, 0, 0x54495550, 1, 1, 0, b"example-python")
        self.link.send(hello)
        request = struct.pack("<4I Q2IQ 24x", OPEN_STREAM, 64, 2, 0, 1, SLOTS, 0, self.slot_bytes)
        descriptors = array.array("i", [self.control.fd, self.memory.fd])
        self.link.sendmsg([request], [(socket.SOL_SOCKET, socket.SCM_RIGHTS, descriptors)])
        while self.event is None:
            self.receive()

    def receive(self):
        packet, ancillary, _, _ = self.link.recvmsg(65536, socket.CMSG_SPACE(4))
        if not packet:
            sys.exit("the daemon closed the connection")
        kind = struct.unpack_from("<I", packet)[0]
        if kind == REFUSED:
            sys.exit("refused: " + packet[96:256].split(b"\0")[0].decode())
        if kind == WELCOME:
            print("attached to", packet[48:112].split(b"\0")[0].decode())
        if kind == STREAM_OPENED:
            numerator, denominator = struct.unpack_from("<2Q", packet, 24)
            print(f"display: {numerator / denominator:.2f} Hz")
            self.event = struct.unpack("i", ancillary[0][2])[0]

    def header(self, time_ns, interval_ns):
        """1024 bytes; only what is not 0 is written."""
        header = bytearray(1024)
        struct.pack_into("<5Q", header, 0, self.frame_id, time_ns, time.monotonic_ns(), interval_ns, 0)
        struct.pack_into("<4I", header, 40, 0, len(self.planes), 1, 1)
        for i, (role, code, offset, stride, size) in enumerate(self.planes):
            struct.pack_into("<5I4xQQQ", header, 200 + 72 * i, role, code, 1, WIDTH, HEIGHT, offset, stride, size)
        struct.pack_into("<I", header, 200 + 48, 1)  # of the colour plane: sRGB
        return header

    def submit(self, pictures, time_ns, interval_ns):
        """Planes first, then the header, then the exchange; what comes back is the next slot to fill."""
        slot = self.owned.pop(0)
        self.frame_id += 1
        for (_, _, offset, _, size), picture in zip(self.planes, pictures):
            begin = slot * self.slot_bytes + offset
            self.memory.map[begin:begin + size] = picture
        begin = HEADERS + 1024 * slot
        self.control.map[begin:begin + 1024] = self.header(time_ns, interval_ns)
        back = self.latest.exchange(slot | FRESH) & ~FRESH
        if back >= SLOTS or back in self.owned or back == slot:
            sys.exit(f"the daemon gave back slot {back}, which it cannot have")
        self.owned.append(back)
        if select.select([], [self.event], [], 0)[1]:
            os.write(self.event, struct.pack("<Q", 1))

    def feedback(self):
        """Reports that are whole and new, as dictionaries."""
        count = struct.unpack_from("<Q", self.control.map, 128)[0]
        self.reports = max(self.reports, count - 64)
        while self.reports < count:
            at = REPORTS + 96 * (self.reports % 64)
            report = self.control.map[at:at + 96]
            whole = report[:8] == self.control.map[at:at + 8] == struct.pack("<Q", 2 * self.reports + 2)
            self.reports += 1
            if whole:
                yield {"frame": struct.unpack_from("<Q", report, 8)[0],
                       "submit": struct.unpack_from("<Q", report, 16)[0],
                       "flip": struct.unpack_from("<Q", report, 48)[0],
                       **dict(zip(("state", "vblanks", "in_betweens", "late"), struct.unpack_from("<4I", report, 64)))}

    def check_connection(self):
        while select.select([self.link], [], [], 0)[0]:
            self.receive()


def pattern():
    """Rows of colour and of depth, twice as wide as shown, so that moving the picture is a slice; crests are near."""
    colors, depths = [], []
    for y in range(HEIGHT):
        color, depth = bytearray(), bytearray()
        for x in range(2 * WIDTH):
            wave = math.sin(x * 2 * math.pi * 9 / WIDTH) * math.sin(y * 0.1)
            color += bytes((int(128 + 120 * wave), int(128 - 120 * wave), 255 * y // HEIGHT, 255))
            depth += struct.pack("<f", 0.5 - 0.3 * wave)
        colors.append(bytes(color))
        depths.append(bytes(depth))
    return colors, depths


def moved(rows, number):
    """The picture of one frame; pixels of colour and of depth have 4 bytes."""
    begin = 4 * (-number * PIXELS_A_FRAME % WIDTH)
    return b"".join(row[begin:begin + 4 * WIDTH] for row in rows)


def show(report):
    if report["state"] == 1:
        print(f"frame {report['frame']}: shown {(report['flip'] - report['submit']) / 1e6:.1f} ms after its submit, "
              f"{report['vblanks']} vblanks, {report['in_betweens']} in-betweens, {report['late']} late")
    else:
        print(f"frame {report['frame']}: {STATES.get(report['state'], 'state ' + str(report['state']))}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--seconds", type=float, default=5)
    parser.add_argument("--fps", type=float, default=40)
    arguments = parser.parse_args()
    colors, depths = pattern()
    motion = struct.pack("<2f", PIXELS_A_FRAME, 0) * (WIDTH * HEIGHT)
    stream = Stream([(COLOR, BGRA8, 4), (DEPTH, DEPTH32F, 4), (MOTION, RG32F, 8)])
    begin, interval = time.monotonic_ns(), int(1e9 / arguments.fps)
    for number in range(int(arguments.seconds * arguments.fps)):
        stream.submit((moved(colors, number), moved(depths, number), motion), begin + number * interval, interval if number else 0)
        stream.check_connection()
        for report in stream.feedback():
            show(report)
        time.sleep(max(0, begin + (number + 1) * interval - time.monotonic_ns()) / 1e9)
    for report in stream.feedback():
        show(report)


if __name__ == "__main__":
    main()
