# SPDX-License-Identifier: GPL-3.0-or-later

"""Compares real drawings with resvg's pictures.

Usage: scripts/run python3 -m bench.vectors.drawings FOLDER --resvg PROGRAM (--help lists options)

FOLDER holds drawings. Each is drawn by prefilter and by resvg (`cargo install resvg`), in an image
of about 512 x 512 pixels, with the same fonts. The difference is the mean over pixels and channels
of premultiplied RGBA, in 1/255. resvg reads neither fonts in files nor the background of a page:
drawings with these are listed, and not compared. The thirty that differ most are kept as a sheet:
ours, resvg's, and the difference. Ends with status 1 if fewer than 97 % are within 2, or if one is
beyond 8 of which no warning speaks.
"""

import argparse
import math
import multiprocessing
import re
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw
from prefilter.shapes.svg_image import SvgPicture

from bench.report import Report, add_json_option

SIDE = 512
NEAR, FAR = 2.0, 8.0
SHARE = 0.97
MOST_SECONDS = 60
WORST = 30
THUMBNAIL = 200
LEAST_KEPT = 0.5
NOT_IN_RESVG = re.compile(rb"@font-face|[\"; ]background(-color)?:\s*(#|rgb|white)")
Pixels = NDArray[np.float64]


@dataclass
class Compared:
    """A drawing beside its reference.

    Attributes:
        name: The file's name.
        difference: The mean absolute difference, in 1/255; None where there is no reference.
        warnings: Our warnings about it.
        refused: The message with which our renderer or the reference refused it.
        sheet: Ours, theirs and the difference on white, side by side.
        seconds: Of the processor, for ours.
    """

    name: str
    difference: float | None = None
    warnings: list[str] = field(default_factory=list)
    refused: str = ""
    sheet: NDArray[np.uint8] | None = None
    seconds: float = 0.0


def compared(path: Path, resvg: str, fonts: Path | None) -> Compared:
    """Draws a file by both."""
    found = Compared(path.name)
    if NOT_IN_RESVG.search(path.read_bytes()):
        found.refused = "a font or a background, which resvg does not read"
        return found
    began = time.process_time()
    try:
        picture = SvgPicture(path, "srgb", [fonts] if fonts else None, None)
        columns = max(round(SIDE * math.sqrt(picture.width / picture.height)), 1)
        scale = columns / picture.width
        found.seconds = time.process_time() - began
        theirs = referred(path, resvg, fonts, columns)
        height, width = theirs.shape[:2]
        began = time.process_time()
        place = (scale, 0.0, height - scale * picture.height)
        drawn = picture.drawn(width, height, place, filter_name="box", threads=1, progress=None)
    except ValueError as error:
        found.refused = str(error)
        return found
    found.seconds += time.process_time() - began
    found.warnings = [str(each) for each in picture.warnings if each.kind == "unsupported"]
    ours = 255.0 * drawn[::-1].astype(np.float64)
    found.difference = float(np.abs(ours - theirs).mean())
    if found.difference > LEAST_KEPT:
        found.sheet = side_by_side(ours, theirs)
    return found


def referred(path: Path, resvg: str, fonts: Path | None, columns: int) -> Pixels:
    """Returns resvg's picture of a file, premultiplied; raises ValueError where it fails."""
    options = ["--width", str(columns)]
    if fonts:
        options += ["--skip-system-fonts", "--use-fonts-dir", str(fonts)]
    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder) / "theirs.png"
        command = [resvg, *options, str(path), str(target)]
        try:
            done = subprocess.run(
                command, capture_output=True, text=True, check=False, timeout=MOST_SECONDS
            )
        except subprocess.TimeoutExpired:
            raise ValueError(f"resvg: more than {MOST_SECONDS} s") from None
        if done.returncode or not target.exists():
            raise ValueError(f"resvg: {done.stderr.strip()[-100:]}")
        with Image.open(target) as file:
            straight = np.asarray(file.convert("RGBA"), np.float64)
    theirs = straight.copy()
    theirs[..., :3] *= straight[..., 3:] / 255.0
    return theirs


def side_by_side(ours: Pixels, theirs: Pixels) -> NDArray[np.uint8]:
    """Returns both on white, and their difference."""
    on_white = [side[..., :3] + 255.0 - side[..., 3:] for side in (ours, theirs)]
    sides = [*on_white, 255.0 - np.abs(ours - theirs).max(-1, keepdims=True).repeat(3, -1)]
    return np.clip(np.rint(np.concatenate(sides, 1)), 0, 255).astype(np.uint8)


def keep_sheet(target: Path, found: list[Compared]) -> None:
    """Writes the worst as one image, two of them in a row, each with its name below."""
    worst = [each for each in found if each.sheet is not None][:WORST]
    label = 14
    sheet = Image.new(
        "RGB", (6 * THUMBNAIL + 20, -(-len(worst) // 2) * (THUMBNAIL + label)), "#ccc"
    )
    pen = ImageDraw.Draw(sheet)
    for index, each in enumerate(worst):
        assert each.sheet is not None
        x, y = (index % 2) * (3 * THUMBNAIL + 20), index // 2 * (THUMBNAIL + label)
        picture = Image.fromarray(each.sheet)
        picture.thumbnail((3 * THUMBNAIL, THUMBNAIL), Image.Resampling.BOX)
        sheet.paste(picture, (x, y))
        pen.text((x, y + THUMBNAIL), f"{each.difference:.1f} {each.name}", "#000")
    sheet.save(target)


def told(found: list[Compared], report: Report) -> None:
    """Prints tables and verdicts."""
    done = [each for each in found if each.difference is not None]
    rows = [
        (each.name, f"{each.difference:.2f}", "; ".join(each.warnings)[:160])
        for each in done
        if each.difference is not None and each.difference > NEAR
    ]
    report.table(
        "Beyond 2/255", ("drawing", "mean difference in 1/255", "warnings"), rows, "beyond"
    )
    refused = [(each.name, each.refused) for each in found if each.refused]
    report.table("Not compared", ("drawing", "why"), refused, "not-compared")
    report.note(f"{sum(each.seconds for each in done):.1f} processor s for {len(done)} drawings")
    far = [each for each in done if (each.difference or 0.0) > FAR and not each.warnings]
    share = (len(done) - len(rows)) / max(len(done), 1)
    report.verdict(
        share >= SHARE,
        f"{len(done) - len(rows)} of {len(done)}, {share:.1%}, are within 2/255 (97 % asked)",
    )
    report.verdict(not far, f"{len(far)} are beyond 8/255 without a warning (0 asked)")


def arguments(parser: argparse.ArgumentParser) -> tuple[argparse.Namespace, list[Path]]:
    """Reads the arguments of programs that compare a folder of drawings, and finds these."""
    parser.add_argument("folder", type=Path)
    parser.add_argument("--resvg", default="resvg", help="the program (default: %(default)s)")
    parser.add_argument("--fonts", type=Path, help="a folder of fonts, for all programs")
    parser.add_argument("--sheet", type=Path, help="write the worst drawings to this image")
    parser.add_argument("--jobs", type=int, default=2, help="processes (default: %(default)s)")
    add_json_option(parser)
    options = parser.parse_args()
    paths = sorted(options.folder.rglob("*.svg"))
    if not paths:
        sys.exit(f"{options.folder} holds no SVG files")
    return options, paths


def main() -> None:
    """Compares and prints."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options, paths = arguments(parser)
    one = partial(compared, resvg=options.resvg, fonts=options.fonts)
    with multiprocessing.Pool(options.jobs) as pool:
        found = pool.map(one, paths, chunksize=4)
    found.sort(key=lambda each: -(each.difference or 0.0))
    report = Report()
    told(found, report)
    if options.sheet:
        keep_sheet(options.sheet, found)
    report.finish(options.json)


if __name__ == "__main__":
    main()
