# SPDX-License-Identifier: MIT
"""Makes pictures of the documents with the real engine; needs Chromium, which puts the labels on.

usage: make_pictures.py BUILD OUT [NAME...]    BUILD: a build folder; OUT: docs/pictures; without a name all of them

  eye.png           what an eye sees that follows the motion: 30 frames a second held, with Pursuit, and 120 rendered
  mistake-KIND.png  an in-between, and one row of the picture over time, with a mistake in the stream
"""
import html
import itertools
import os
import shutil
import struct
import subprocess
import sys
import tempfile
import zlib

import browser

PANEL = (300, 224)  # pixels of one panel of a picture of a mistake
SECONDS, FIRST = 2.1, 128  # of the scene, and the first displayed frame that is shown
STYLE = """<style>body{margin:0;padding:6px;display:inline-flex;gap:8px;font:15px system-ui,sans-serif;background:#fff;color:#222}
figure{margin:0}figcaption{padding:4px 2px 0}img{display:block;image-rendering:pixelated}</style>"""
# what is planted: the scene, the middle of what is shown, how many times it is enlarged
MISTAKES = {
    "sign": ("trees", (350, 175), 2), "ndc": ("trees", (350, 175), 2), "twice": ("trees", (350, 175), 2),
    "depth-reversed": ("trees", (350, 175), 2), "jitter-motion": ("still", (320, 180), 6),
}
NAMES = ["eye.png", *(f"mistake-{kind}.png" for kind in MISTAKES)]


def run(*arguments):
    subprocess.run(arguments, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def unfilter(kind, row, above):
    """A row of a PNG with its filter taken off, in place; three bytes a pixel."""
    if kind == 1:
        for channel in range(3):
            row[channel::3] = bytes(map((255).__and__, itertools.accumulate(row[channel::3])))
        return
    for i, value in enumerate(row):
        left, corner = (row[i - 3], above[i - 3]) if i >= 3 else (0, 0)
        up = above[i]
        if kind == 2:
            value += up
        elif kind == 3:
            value += (left + up) // 2
        else:
            near = [abs(up - corner), abs(left - corner), abs(left + up - 2 * corner)]
            value += (left, up, corner)[near.index(min(near))]
        row[i] = value & 255


def read_png(path):
    """Rows of RGB bytes of a PNG of 8 bits."""
    with open(path, "rb") as file:
        data = file.read()
    at, packed = 8, b""
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        content = data[at + 8:at + 8 + size]
        at += 12 + size
        if kind == b"IHDR":
            width, height = struct.unpack(">II", content[:8])
        elif kind == b"IDAT":
            packed += content
    raw, stride, rows = zlib.decompress(packed), 3 * width + 1, [bytes(3 * width)]
    for y in range(height):
        row = bytearray(raw[y * stride + 1:(y + 1) * stride])
        if raw[y * stride]:
            unfilter(raw[y * stride], row, rows[-1])
        rows.append(bytes(row))
    return rows[1:]


def write_png(path, rows):
    def chunk(kind, content):
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))

    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", len(rows[0]) // 3, len(rows), 8, 2, 0, 0, 0)) +
                   chunk(b"IDAT", zlib.compress(b"".join(b"\0" + row for row in rows), 9)) + chunk(b"IEND", b""))


class Maker:
    def __init__(self, build, out):
        self.pursuit = os.path.join(build, "daemon/cli/pursuit")
        self.plant = os.path.join(build, "tests/cli/plant-mistake")
        self.out, self.folder = os.path.abspath(out), tempfile.mkdtemp(prefix="pursuit-pictures-")
        self.browser = browser.Browser(browser.find())

    def path(self, name):
        return os.path.join(self.folder, name)

    def page(self, name, figures):
        """[(picture, width, caption)] side by side, as one PNG."""
        body = "".join(f'<figure><img src="{html.escape(picture)}" width="{width}"><figcaption>{html.escape(caption)}'
                       "</figcaption></figure>" for picture, width, caption in figures)
        with open(self.path("page.html"), "w", encoding="utf-8") as page:
            page.write(f"<!DOCTYPE html><meta charset=utf-8>{STYLE}{body}")
        self.browser.window(1400, 900)
        self.browser.open(self.path("page.html"))
        width, height = self.browser.evaluate("[document.body.offsetWidth, document.body.offsetHeight]")
        self.browser.window(width, height)
        self.browser.screenshot(os.path.join(self.out, name))

    def eye(self):
        out = self.path("report")
        run(self.pursuit, "report", "--scenes", "trees", "--n", "4", "--vary", "none", "--methods", "hold,pursuit", "--out", out)
        captions = {"hold": "30 frames a second, each shown four times", "pursuit": "the same 30 frames, with Pursuit",
                    "rendered": "120 rendered frames a second"}
        self.page("eye.png", [(f"{out}/pictures/seen-0-trees-{name}.png", 320, caption)
                              for name, caption in captions.items()])

    def replay(self, scene, kind):
        """A folder with the displayed frames of a scene with a mistake."""
        good, frames = self.path(scene + ".pursuit"), self.path(f"{scene}-{kind}")
        if os.path.exists(frames):
            return frames
        if not os.path.exists(good):
            run(self.pursuit, "record", good, "--scene", scene, "--size", "640x360", "--fps", "30", "--seconds", str(SECONDS))
        os.mkdir(frames)
        run(self.plant, kind, good, self.path("planted.pursuit"))
        run(self.pursuit, "replay", self.path("planted.pursuit"), "--write-frames", frames + "/%05d.png")
        return frames

    def panels(self, frames, middle, zoom):
        """The files of a part of an in-between, and of the row in its middle over time."""
        width, height = PANEL[0] // zoom, PANEL[1] // zoom
        left, top = 3 * (middle[0] - width // 2), middle[1] - height // 2
        pictures = [read_png(f"{frames}/{FIRST + i:05d}.png") for i in range(height)]
        crop, rows = frames + "/crop.png", frames + "/rows.png"
        write_png(crop, [row[left:left + 3 * width] for row in pictures[3][top:top + height]])
        write_png(rows, [picture[middle[1]][left:left + 3 * width] for picture in pictures])
        return crop, rows

    def mistake(self, kind):
        scene, middle, zoom = MISTAKES[kind]
        crop, rows = self.panels(self.replay(scene, kind), middle, zoom)
        _, good = self.panels(self.replay(scene, "none"), middle, zoom)
        self.page(f"mistake-{kind}.png", [(crop, PANEL[0], "an in-between"), (rows, PANEL[0], "its middle row over time"),
                                          (good, PANEL[0], "as it should be")])

    def make(self, name):
        if name == "eye.png":
            self.eye()
        else:
            self.mistake(name.removeprefix("mistake-").removesuffix(".png"))

    def close(self):
        self.browser.close()
        shutil.rmtree(self.folder)


def main():
    maker = Maker(sys.argv[1], sys.argv[2])
    try:
        for name in sys.argv[3:] or NAMES:
            maker.make(name)
    finally:
        maker.close()


if __name__ == "__main__":
    main()
