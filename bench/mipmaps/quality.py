"""Measures how far the levels of each filter are from their image, over gathered models.

Usage: blender --background --python-exit-code 1 --python bench/mipmaps/quality.py -- [MODEL...]
       (--help lists the options)

Models are imported by Blender's own importers, and read through the add-on's bridge, so that what
is measured is what a user gets: the extension has to be installed and enabled. Ends with status 1
if a criterion of docs/benchmarks.md does not hold.

The error is prefilter.mipmap_error, which is exact: the RMSE over the surface and the channels, in
scene-linear values, between bilinear lookups of a level and of the image. It is checked by a second
method that shares nothing with it: lookups with numpy at random points of the surface.
"""

import argparse
import sys
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import prefilter

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from bench.mipmaps import maketx_levels, sampling, subjects
from bench.mipmaps.sampling import Floats, Texels
from bench.mipmaps.subjects import Subject
from bench.report import Report

SUBJECT = "pam-bilinear"
TRILINEAR = "pam-trilinear"
MAKETX = ("maketx box", "maketx lanczos3")
FILTERS = (
    "box",
    "tent",
    "lanczos3",
    *MAKETX,
    "box-covered",
    "tent-covered",
    "lanczos3-covered",
    "pam-box",
    SUBJECT,
    TRILINEAR,
)
LEVELS = range(1, 7)
LEAST_SQUARES = (SUBJECT, TRILINEAR)  # All others are rivals.
GAIN = 0.12
PAINTED_MODEL = "spot"
PAINTED_GAIN = 0.25
AGREEMENT = 5.0  # Standard errors by which the two methods may differ.


@dataclass
class Errors:
    """What was found of one subject.

    Attributes:
        levels: Of each filter, the errors at the whole levels 1 to 6.
        all_values: Of each filter, the root mean square of the errors at all mip values, 0 to the
            last level, of trilinear lookups.
    """

    levels: dict[str, Floats] = field(default_factory=dict)
    all_values: dict[str, float] = field(default_factory=dict)


@dataclass
class Summary:
    """Rows of the tables over all subjects.

    Attributes:
        shares: The errors of pam-bilinear as shares of lanczos3, by level.
        trilinear: The errors over all mip values, by filter.
        means: The mean share of lanczos3 of each model, as it was gathered.
    """

    shares: list[list[str]] = field(default_factory=list)
    trilinear: list[list[str]] = field(default_factory=list)
    means: list[float] = field(default_factory=list)


def main() -> None:
    """Measures the models of the command line."""
    options = parse()
    report, summary = Report(), Summary()
    filters = FILTERS
    if not maketx_levels.is_available():
        print("maketx: not found, and left out")
        filters = tuple(name for name in FILTERS if name not in MAKETX)
    for model in options.models:
        for subject in subjects.load(options.data / model, options.wrap):
            measure(report, summary, subject, filters, GAIN, options)
            if model == PAINTED_MODEL:
                measure_painted(report, summary, subject, filters, options)
    head = ["model", *(f"level {level}" for level in LEVELS), "mean", "unbounded", "worst"]
    report.table(
        f"Summary: {SUBJECT} / lanczos3; its mean without bounds, which no levels can go below; "
        "the worst share of the best rival",
        head,
        summary.shares,
    )
    report.table(
        "Summary: RMSE over all mip values, trilinear lookups",
        ["model", "mip values", *filters, "/ best other"],
        summary.trilinear,
    )
    if summary.means:
        mean = np.mean(summary.means)
        report.verdict(
            mean <= 1 - GAIN,
            f"{SUBJECT} is at least {GAIN:.0%} below lanczos3 on average over the models "
            f"(found {1 - mean:.1%})",
        )
    report.finish(options.markdown)


def parse() -> argparse.Namespace:
    """Reads the arguments after Blender's `--`."""
    parser = subjects.argument_parser("quality.py", __doc__)
    parser.add_argument(
        "--samples",
        type=int,
        default=1 << 20,
        help="points of the second method; 0: leave it out (default: %(default)s)",
    )
    parser.add_argument(
        "--bytes",
        action="store_true",
        help="round the levels as 8-bit images keep them; without it they are floats",
    )
    return subjects.parse(parser)


def measure(
    report: Report,
    summary: Summary,
    subject: Subject,
    filters: tuple[str, ...],
    gain: float,
    options: argparse.Namespace,
) -> None:
    """Adds the errors of one subject to the report and the summary."""
    mipmaps = {name: bake(subject, name) for name in filters}
    if options.bytes:
        for made in mipmaps.values():
            made[1:] = [subject.rounded(level) for level in made[1:]]
    errors = exact_errors(subject, mipmaps)
    ours, reference = errors.levels[SUBJECT], errors.levels["lanczos3"]
    best = np.min([errors.levels[name] for name in filters if name not in LEAST_SQUARES], axis=0)
    share = ours / reference
    add_tables(report, subject, errors, best, rounded=options.bytes)
    unbounded = prefilter.mipmap_error(
        bake(subject, SUBJECT, bounds=None)[: LEVELS[-1] + 1],
        subject.image,
        subject.surfaces,
        LEVELS,
        wrap=subject.wrap,
    )
    summary.shares.append(
        [
            subject.name,
            *(f"{x:.3f}" for x in share),
            f"{share.mean():.3f}",
            f"{(unbounded / reference).mean():.3f}",
            f"{(ours / best).max():.3f}",
        ]
    )
    if gain == GAIN:
        summary.means.append(share.mean())
    name = subject.name
    report.verdict(
        all((ours < errors.levels[other]).all() for other in filters if other != SUBJECT),
        f"{name}: {SUBJECT} has the lowest error at every level 1 to 6 "
        f"({1 - (ours / best).max():.1%} at least below all but {TRILINEAR})",
    )
    report.verdict(
        share.mean() <= 1 - gain,
        f"{name}: {SUBJECT} is at least {gain:.0%} below lanczos3 on average over levels 1 to 6 "
        f"(found {1 - share.mean():.1%})",
    )
    rest = {name: error for name, error in errors.all_values.items() if name != TRILINEAR}
    closest = min(rest, key=rest.get)
    ratio = errors.all_values[TRILINEAR] / rest[closest]
    summary.trilinear.append(
        [
            name,
            f"0 to {len(mipmaps[SUBJECT]) - 1}",
            *(f"{errors.all_values[name]:.5f}" for name in filters),
            f"{ratio:.4f}",
        ]
    )
    report.verdict(
        ratio < 1,
        f"{name}: {TRILINEAR} has the lowest error over all mip values "
        f"({1 - ratio:.2%} below {closest})",
    )
    if options.samples:
        check_by_sampling(report, subject, mipmaps, errors, options.samples)


def bake(
    subject: Subject, name: str, bounds: tuple[float, float] | None = (0.0, 1.0)
) -> list[Texels]:
    """Returns all levels, down to one texel."""
    if name in MAKETX:
        made = maketx_levels.levels(
            subject.image, filter=name.removeprefix("maketx "), wrap=subject.wrap
        )
        # What other filters get too.
        return [level.clip(*bounds) for level in made]
    return prefilter.mipmaps(
        subject.image,
        subject.surfaces,
        filter=name,
        wrap=subject.wrap,
        bounds=bounds,
        premultiplied=True,
    )


def exact_errors(subject: Subject, mipmaps: dict[str, list[Texels]]) -> Errors:
    """Returns the errors from moments."""
    found = Errors()
    for name, levels in mipmaps.items():
        last = len(levels) - 1
        halves = np.arange(2 * last + 1) / 2
        errors = prefilter.mipmap_error(
            levels, subject.image, subject.surfaces, halves, wrap=subject.wrap
        )
        found.levels[name] = errors[2 * LEVELS[0] : 2 * LEVELS[-1] + 1 : 2]
        # Simpson's rule is exact: the square is quadratic in between two levels.
        low, middle, high = errors[:-2:2] ** 2, errors[1:-1:2] ** 2, errors[2::2] ** 2
        found.all_values[name] = float(np.sqrt(((low + 4 * middle + high) / 6).mean()))
    return found


def add_tables(
    report: Report, subject: Subject, errors: Errors, best: Floats, *, rounded: bool
) -> None:
    """Adds the errors at the levels, and over all mip values, to the report."""
    ours = errors.levels[SUBJECT]
    ratios = {"/ best rival": ours / best, "/ lanczos3": ours / errors.levels["lanczos3"]}
    rows = [
        [
            str(level),
            *(f"{found[k]:.5f}" for found in errors.levels.values()),
            *(f"{ratio[k]:.3f}" for ratio in ratios.values()),
        ]
        for k, level in enumerate(LEVELS)
    ]
    blanks = [""] * len(errors.levels)
    rows.append(["mean", *blanks, *(f"{ratio.mean():.3f}" for ratio in ratios.values())])
    rows.append(["all", *(f"{error:.5f}" for error in errors.all_values.values()), "", ""])
    height, width, channels = subject.image.shape
    triangles = sum(surface.triangle_count for surface in subject.surfaces)
    title = (
        f"{subject.name}: {width} x {height} x {channels}, {triangles} triangles, "
        f"wrap {subject.wrap}: "
        f"RMSE over the surface{', levels in 8 bits' if rounded else ''}"
    )
    report.table(title, ["level", *errors.levels, *ratios], rows)


def measure_painted(
    report: Report,
    summary: Summary,
    subject: Subject,
    filters: tuple[str, ...],
    options: argparse.Namespace,
) -> None:
    """Measures a subject with its unused texels magenta, in two meanings of unused."""
    height, width = subject.image.shape[:2]
    touched = subjects.touched_texels(subject.uvs, width, height, subject.wrap)
    # A bilinear lookup beside a chart's edge reads one texel further.
    read = subjects.dilated(touched, subject.wrap)
    for used, which in ((touched, "touches"), (read, "reads")):
        print(f"\nmagenta: the {(~used).mean():.1%} of texels that no triangle {which}")
        name = f"{subject.name}, texels that no triangle {which} magenta"
        painted = subject.painted(name, ~used)
        measure(report, summary, painted, filters, PAINTED_GAIN, options)


def check_by_sampling(
    report: Report,
    subject: Subject,
    mipmaps: dict[str, list[Texels]],
    errors: Errors,
    samples: int,
) -> None:
    """Estimates the errors from random points, and adds both to the report."""
    points = sampling.random_points(subject.corners, subject.uvs, samples)
    values = sampling.random_mip_values(samples, len(mipmaps[SUBJECT]) - 1)
    rows, worst = [], 0.0
    closest = {SUBJECT: np.inf, TRILINEAR: np.inf}
    for level in (*LEVELS, None):
        if level is None:
            lowest, exact = TRILINEAR, errors.all_values
            squares = sampling.squared_errors(mipmaps, points, subject.wrap, values)
        else:
            lowest = SUBJECT
            exact = {name: found[level - LEVELS[0]] for name, found in errors.levels.items()}
            squares = sampling.squared_errors(mipmaps, points, subject.wrap, level=level)
        cells = ["all" if level is None else str(level)]
        for name, found in squares.items():
            estimate = np.sqrt(found.mean())
            deviation = standard_error(found) / (2 * estimate)
            worst = max(worst, abs(estimate - exact[name]) / deviation)
            cells.append(f"{estimate:.5f}")
            if name != lowest:
                above = found - squares[lowest]
                closest[lowest] = min(closest[lowest], above.mean() / standard_error(above))
        rows.append(cells)
    title = f"{subject.name}: the same by {samples} random points"
    report.table(title, ["level", *mipmaps], rows)
    for name, least in closest.items():
        report.verdict(
            least > 0,
            f"{subject.name}: {name} has the lowest error in these, too "
            f"(at least {least:.1f} standard errors of the difference below any other)",
        )
    report.verdict(
        worst <= AGREEMENT,
        f"{subject.name}: the exact and the sampled errors agree "
        f"(at most {worst:.1f} standard errors apart)",
    )


def standard_error(samples: Floats) -> float:
    """Returns that of the mean of samples."""
    return float(samples.std() / np.sqrt(len(samples)))


if __name__ == "__main__":
    main()
