# SPDX-License-Identifier: GPL-3.0-or-later

"""Photographs windows of Blender on a virtual screen.

usage: python3 photograph.py panels|windows [NAME...]
"panels" photographs single panels (panels/NAME-VERSION.png), "windows" whole windows (NAME.png);
pictures.py has the names. Runs outside of Blender, and starts Xvfb and Blender.
"""

import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from pictures import CROPPED, FOLDER, KEYWORD, WHOLE
from PIL import Image, PngImagePlugin

READY = "prefilter: ready "
SIZES = {"panels": (1500, 2000), "windows": (1280, 720)}
SECONDS_BETWEEN_LOOKS = 0.7
MOST_LOOKS = 40
MARGIN = 6
DIFFERENCE = 3
"""Least difference from the background of a pixel that counts as drawn, in byte values."""


def main(kind: str, names: list[str]) -> None:
    """Takes the photographs, one Blender after another."""
    (FOLDER / "panels").mkdir(exist_ok=True)
    for name in names or list(CROPPED if kind == "panels" else WHOLE):
        with screen(*SIZES[kind]) as (display, look):
            photograph(kind, name, display, look)


def photograph(kind: str, name: str, display: str, look) -> None:
    """Starts Blender, and saves the picture of its window."""
    width, height = SIZES[kind]
    blender = subprocess.Popen(
        [
            "blender",
            "--window-geometry",
            *("0", "0", str(width), str(height)),
            "--python-exit-code",
            "1",
            *("--python", str(Path(__file__).with_name("scenes.py")), "--", kind, name),
        ],
        env={**os.environ, "DISPLAY": display},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    try:
        told, output = None, []
        for line in blender.stdout:
            output.append(line)
            if line.startswith(READY):
                told = json.loads(line.removeprefix(READY))
                break
        if told is None:
            raise SystemExit(
                f"{name}: Blender ended before its window was ready\n{''.join(output)}"
            )
        if told.get("left_out"):
            print(f"{name}: not in Blender {told['version']}")
            return
        pixels = steady(look)
    finally:
        blender.kill()
        blender.wait()
    if kind == "panels":
        pixels = cropped(pixels, told["region"])
        target = FOLDER / "panels" / f"{name}-{told['version']}.png"
    else:
        target = FOLDER / f"{name}.png"
    save(pixels, told, target)
    print(target, flush=True)


@contextmanager
def screen(width: int, height: int) -> Iterator[tuple[str, object]]:
    """Runs an X server, and yields its display and a function that returns its picture."""
    with tempfile.TemporaryDirectory() as folder:
        reading, writing = os.pipe()
        size = ["-screen", "0", f"{width}x{height}x24", "-fbdir", folder]
        server = subprocess.Popen(
            ["Xvfb", "-displayfd", str(writing), "-nolisten", "tcp", *size], pass_fds=[writing]
        )
        os.close(writing)
        with os.fdopen(reading) as answer:
            display = f":{answer.readline().strip()}"
        try:
            yield display, lambda: framebuffer(Path(folder) / "Xvfb_screen0")
        finally:
            server.terminate()
            server.wait()


def framebuffer(path: Path) -> np.ndarray:
    """The screen as (height, width, 3) bytes, from X's window dump format (XWDFile.h)."""
    dump = path.read_bytes()
    header = np.frombuffer(dump, ">u4", 25)
    size, width, height, bytes_per_line, colors = header[[0, 4, 5, 12, 19]]
    start = size + 12 * colors
    rows = np.frombuffer(dump, np.uint8, height * bytes_per_line, start)
    pixels = rows.reshape(height, -1)[:, : 4 * width].reshape(height, width, 4)
    return pixels[..., 2::-1]


def steady(look) -> np.ndarray:
    """Takes pictures until two in a row are equal."""
    before = look()
    for _ in range(MOST_LOOKS):
        time.sleep(SECONDS_BETWEEN_LOOKS)
        now = look()
        if np.array_equal(before, now):
            return now
        before = now
    raise SystemExit("the window does not come to rest")


def cropped(pixels: np.ndarray, region: list[int]) -> np.ndarray:
    """The drawn part of a region (left, bottom, width, height; y upwards), and a small margin."""
    left, bottom, width, height = region
    top = pixels.shape[0] - bottom - height
    pixels = pixels[top : top + height, left : left + width]
    # The corners of areas are round.
    inside = pixels[:-10, 4:-4]
    ground = inside[-1, len(inside[-1]) // 2].astype(int)
    is_drawn = (np.abs(inside.astype(int) - ground) > DIFFERENCE).any(axis=(1, 2))
    (rows,) = np.nonzero(is_drawn)
    if not len(rows):
        raise SystemExit("nothing is drawn in the region")
    return pixels[: rows[-1] + 1 + MARGIN]


def save(pixels: np.ndarray, told: dict[str, object], target: Path) -> None:
    """Writes a small PNG file of at most 256 colors, with the contents of the panels as text."""
    picture = Image.fromarray(np.ascontiguousarray(pixels))
    # Pillow dithers with a given palette only.
    small = picture.quantize(palette=picture.quantize(256), dither=Image.Dither.FLOYDSTEINBERG)
    text = PngImagePlugin.PngInfo()
    said = {"blender": told["version"], "drawn": told["drawn"]}
    text.add_text(KEYWORD, json.dumps(said), zip=True)
    small.save(target, optimize=True, pnginfo=text)


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2:])
