# SPDX-License-Identifier: GPL-3.0-or-later

"""Compares drawings with resvg's reference images of its own tests.

Usage: python3 bench/shapes/resvg_references.py [FOLDER] (--help lists the options)

FOLDER holds SVG files, each beside the PNG that resvg made of it. Each file is drawn by
prefilter.rasterize_svg at the size of its PNG, with the fonts in the folder `fonts` beside FOLDER,
as in resvg's tests, or in the folder given by --fonts. The difference is the mean over pixels and
channels of premultiplied RGBA, in 1/255. Files with unsupported features are listed by themselves,
and so are refused files. Ends with status 1 if fewer than 95 % of the others agree within 2/255;
a few that resvg draws otherwise than SVG 2 says do not count.
"""

import argparse
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import prefilter
from PIL import Image

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from bench.report import Report, add_json_option

DATA = Path(__file__).resolve().parents[3] / "shared/data/svg/resvg"
LIMIT = 2.0
SHARE = 0.95
# Where a gradient has no colors or no area, SVG 2 and browsers paint nothing.
OTHERWISE = {"invalid-gradientTransform", "invalid-FuncIRI-with-a-fallback-color"}
OTHERWISE |= {"invalid-FuncIRI-with-a-currentColor-fallback"}


@dataclass
class Compared:
    """A drawing beside its reference.

    Attributes:
        path: The drawing's path.
        difference: The mean absolute difference, in 1/255.
        worst: The largest difference at a pixel, in 1/255.
        unsupported: Its unsupported features, in words.
        ours: (height, width, 4), premultiplied, in 0..255, the top row first.
        theirs: In the same form.
    """

    path: Path
    difference: float
    worst: float
    unsupported: str
    ours: np.ndarray
    theirs: np.ndarray


def compared(path: Path, fonts: list[Path] | None) -> Compared:
    """Draws a file at the size of the PNG beside it, and compares both."""
    with Image.open(path.with_suffix(".png")) as file:
        straight = np.asarray(file.convert("RGBA"), np.float64)
    theirs = straight.copy()
    theirs[..., :3] *= straight[..., 3:] / 255.0
    height, width = theirs.shape[:2]
    ours = np.zeros((height, width, 4))
    try:
        drawn, warnings = prefilter.rasterize_svg(path, width, height, fonts=fonts)
        ours = 255.0 * drawn[::-1].astype(np.float64)
        unsupported = [
            f"{each.name} {each.effect}" for each in warnings if each.kind == "unsupported"
        ]
    except ValueError as error:
        unsupported = [f"refused: {error}"]
    difference = np.abs(ours - theirs)
    return Compared(
        path,
        float(difference.mean()),
        float(difference.max()),
        "; ".join(unsupported),
        ours,
        theirs,
    )


def keep_pictures(target: Path, found: list[Compared]) -> None:
    """Writes each as ours, theirs and the difference side by side on white."""
    target.mkdir(parents=True, exist_ok=True)
    for each in found:
        on_white = [side[..., :3] + 255.0 - side[..., 3:] for side in (each.ours, each.theirs)]
        sides = [*on_white, np.abs(each.ours - each.theirs)[..., :3]]
        row = np.clip(np.rint(np.concatenate(sides, 1)), 0, 255).astype(np.uint8)
        Image.fromarray(row).save(target / f"{each.path.parent.name}-{each.path.stem}.png")


def main() -> int:
    """Compares all files, and says how many agree."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folder", type=Path, nargs="?", default=DATA)
    add_json_option(parser)
    parser.add_argument("--fonts", type=Path, help="a folder of fonts for text")
    parser.add_argument("--pictures", type=Path, help="keep pictures of what differs there")
    options = parser.parse_args()
    drawings = sorted(options.folder.rglob("*.svg"))
    paths = [path for path in drawings if path.with_suffix(".png").exists()]
    if not paths:
        parser.error(f"{options.folder} holds no SVG files beside PNG files")
    folder = options.fonts or options.folder.resolve().parent / "fonts"
    fonts = [folder] if options.fonts or folder.is_dir() else None
    began = time.perf_counter()
    found = [compared(path, fonts) for path in paths]
    seconds = time.perf_counter() - began
    report = Report()
    supported = [each for each in found if not each.unsupported]
    agreeing = [each for each in supported if each.difference <= LIMIT]
    differing = [each for each in supported if each.difference > LIMIT]

    def name(each: Compared) -> str:
        return each.path.relative_to(each.path.parents[2]).with_suffix("").as_posix()

    report.table(
        "Supported features only, and further than 2/255 from the reference",
        ("file", "mean difference in 1/255"),
        [(name(each), f"{each.difference:.2f}") for each in differing],
        "others",
    )
    report.table(
        "With features that are not supported",
        ("file", "what", "mean difference in 1/255"),
        [
            (name(each), each.unsupported, f"{each.difference:.2f}")
            for each in found
            if each.unsupported
        ],
    )
    report.note(f"{len(found)} files read and drawn in {seconds:.1f} s")
    report.note(
        f"{len(agreeing)} of the {len(supported)} with supported features only agree; half of them "
        f"within {np.median([each.difference for each in agreeing]):.3f}/255"
    )
    near = sum(each.difference <= LIMIT for each in found)
    report.note(f"{near} of all {len(found)} agree, {near / len(found):.1%}")
    other = sum(each.path.stem in OTHERWISE for each in differing)
    report.note(f"{other} of these are drawn otherwise by SVG 2 and browsers, and do not count")
    share = len(agreeing) / (len(supported) - other)
    report.verdict(share >= SHARE, f"{share:.1%} agree within {LIMIT:g}/255 (at least {SHARE:.0%})")
    if options.pictures:
        keep_pictures(options.pictures, differing)
    report.finish(options.json)
    return 0


if __name__ == "__main__":
    sys.exit(main())
