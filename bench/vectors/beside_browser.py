# SPDX-License-Identifier: GPL-3.0-or-later

"""Compares drawings with Chromium's and resvg's pictures.

Usage: scripts/run python3 -m bench.vectors.beside_browser FOLDER (--help lists options)

FOLDER holds drawings. Where a PNG stands beside one, as in resvg's own tests, it is resvg's picture
and says how large it is; for others resvg (`cargo install resvg`) draws one of about 512 x 512
pixels. Chromium (Debian's package) draws each without a window, with fonts of the same folder
alone. A difference is the mean over pixels and channels of premultiplied RGBA, in 1/255. What
counts is resvg's picture where it agrees with Chromium's, and Chromium's where it does not.
Drawings in which something is found that is not supported are told by themselves. The thirty that
differ most are kept as a sheet: ours, resvg's, Chromium's. Ends with status 1 if fewer than 97 %
of those without a warning are within 2.
"""

import argparse
import math
import multiprocessing
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw
from prefilter.shapes.svg_image import SvgPicture

from bench.report import Report
from bench.vectors.browser import Browser, Wanted, premultiplied
from bench.vectors.drawings import FAR, NEAR, SHARE, SIDE, arguments, referred

WORST = 30
THUMBNAIL = 200
LABEL = 14
AT_ONCE = 12
LONGEST_SIDE = 4000
Pixels = NDArray[np.float64]


@dataclass
class Compared:
    """A drawing beside both.

    Attributes:
        name: The file's path in its folder.
        warnings: Our warnings about unsupported features.
        resvg: Ours beside resvg's, in 1/255; NaN where that has none.
        browser: Ours beside Chromium's, in the same form.
        others: resvg's beside Chromium's.
        sheet: All three on white, side by side; None for those that agree.
    """

    name: str
    warnings: list[str]
    resvg: float
    browser: float
    others: float
    sheet: NDArray[np.uint8] | None = None

    @property
    def counting(self) -> float:
        """The difference that counts."""
        return self.resvg if self.others <= NEAR else self.browser


@dataclass
class Drawn:
    """Our picture and resvg's picture of a drawing."""

    wanted: Wanted
    ours: Pixels
    theirs: Pixels
    warnings: list[str]


def drawn(path: Path, resvg: str, fonts: Path | None) -> Drawn | str:
    """Draws a file by ours and by resvg; a text says why there is none."""
    try:
        picture = SvgPicture(path, "srgb", [fonts] if fonts else None, None)
        reference = path.with_suffix(".png")
        if reference.exists():
            with Image.open(reference) as file:
                theirs = premultiplied(np.asarray(file.convert("RGBA")))
            height, width = theirs.shape[:2]
            place, scale = None, width / picture.width
        else:
            columns = max(round(SIDE * math.sqrt(picture.width / picture.height)), 1)
            theirs = referred(path, resvg, fonts, min(columns, LONGEST_SIDE))
            height, width = theirs.shape[:2]
            scale = width / picture.width
            place = (scale, 0.0, height - scale * picture.height)
        made = picture.drawn(width, height, place, filter_name="box", threads=1, progress=None)
    except ValueError as error:
        return str(error)
    warnings = [str(each) for each in picture.warnings if each.kind == "unsupported"]
    ours = 255.0 * made[::-1].astype(np.float64)
    return Drawn(Wanted(path, width, height, scale), ours, theirs, warnings)


def compared(paths: list[Path], folder: Path, browser: Browser, draw: partial) -> list:
    """Some drawings beside both: a Compared each, or a name and why there is none."""
    done = {path: draw(path) for path in paths}
    shown = browser.shown(each.wanted for each in done.values() if isinstance(each, Drawn))
    found: list[Compared | tuple[str, str]] = []
    for path, each in done.items():
        name = path.relative_to(folder).with_suffix("").as_posix()
        photograph = shown.get(path)
        if isinstance(each, str) or photograph is None:
            found.append((name, each if isinstance(each, str) else "Chromium shows nothing"))
            continue
        sides = (each.ours, each.theirs, photograph)
        differences = [
            float(np.abs(sides[a] - sides[b]).mean()) for a, b in ((0, 1), (0, 2), (1, 2))
        ]
        one = Compared(name, each.warnings, *differences)
        if one.counting > NEAR / 2:
            one.sheet = side_by_side(sides)
        found.append(one)
    return found


def side_by_side(sides: tuple[Pixels, ...]) -> NDArray[np.uint8]:
    """Returns pictures on white next to each other, no larger than on the sheet."""
    parts = []
    for side in sides:
        on_white = np.clip(np.rint(side[..., :3] + 255.0 - side[..., 3:]), 0, 255)
        picture = Image.fromarray(on_white.astype(np.uint8))
        picture.thumbnail((THUMBNAIL, THUMBNAIL), Image.Resampling.BOX)
        parts.append(np.asarray(picture))
    return np.concatenate(parts, 1)


def keep_sheet(target: Path, found: list[Compared]) -> None:
    """Writes the worst as one image, two of them in a row, each with its name below."""
    worst = [each for each in found if each.sheet is not None][:WORST]
    wide, high = 3 * THUMBNAIL + 20, THUMBNAIL + LABEL
    sheet = Image.new("RGB", (2 * wide, max(-(-len(worst) // 2), 1) * high), "#ccc")
    pen = ImageDraw.Draw(sheet)
    for index, each in enumerate(worst):
        assert each.sheet is not None
        x, y = (index % 2) * wide, index // 2 * high
        sheet.paste(Image.fromarray(each.sheet), (x, y))
        label = f"{each.resvg:.1f} {each.browser:.1f} {each.name[-80:]}"
        pen.text((x, y + THUMBNAIL), label, "#000")
    sheet.save(target)


def told(found: list[Compared], failed: list[tuple[str, str]], report: Report) -> None:
    """Prints tables and verdicts."""
    plain = [each for each in found if not each.warnings]
    rows = []
    for name, group in (("all", found), ("without a warning", plain)):
        counts = [
            len(group),
            sum(each.resvg <= NEAR for each in group),
            sum(each.browser <= NEAR for each in group),
            sum(min(each.resvg, each.browser) <= NEAR for each in group),
            sum(each.counting <= NEAR for each in group),
            sum(each.others <= NEAR for each in group),
        ]
        rows.append((name, *map(str, counts)))
    columns = ("drawings", "number", "near resvg's", "near Chromium's", "near either")
    columns += ("near what counts", "resvg's near Chromium's")
    report.table("Within 2/255", columns, rows, "counts")
    off = [each for each in plain if each.counting > NEAR]
    report.table(
        "Without a warning, and farther from what counts",
        ("drawing", "from resvg's", "from Chromium's", "resvg's from Chromium's"),
        [
            (each.name, f"{each.resvg:.2f}", f"{each.browser:.2f}", f"{each.others:.2f}")
            for each in off
        ],
        "farther",
    )
    report.table("Not compared", ("drawing", "why"), failed, "not-compared")
    share = (len(plain) - len(off)) / max(len(plain), 1)
    text = f"{len(plain) - len(off)} of {len(plain)} without a warning, {share:.1%}"
    report.verdict(share >= SHARE, f"{text}, are within 2/255 of what counts (97 % asked)")
    far = sum(min(each.resvg, each.browser) > FAR for each in plain)
    report.verdict(far == 0, f"{far} of these are beyond 8/255 of both (0 asked)")


def main() -> None:
    """Compares and prints."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--browser", default="chromium", help="(default: %(default)s)")
    parser.add_argument("--kept", type=Path, help="a folder in which Chromium's pictures stay")
    options, paths = arguments(parser)
    work = partial(
        compared,
        folder=options.folder,
        browser=Browser(options.browser, options.fonts, options.kept),
        draw=partial(drawn, resvg=options.resvg, fonts=options.fonts),
    )
    batches = [paths[begin : begin + AT_ONCE] for begin in range(0, len(paths), AT_ONCE)]
    with multiprocessing.Pool(options.jobs) as pool:
        results = [each for batch in pool.imap(work, batches) for each in batch]
    found = [each for each in results if isinstance(each, Compared)]
    found.sort(key=lambda each: -min(each.counting, each.resvg))
    report = Report()
    told(found, [each for each in results if not isinstance(each, Compared)], report)
    if options.sheet:
        keep_sheet(options.sheet, found)
    report.finish(options.json)


if __name__ == "__main__":
    main()
