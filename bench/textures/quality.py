# SPDX-License-Identifier: GPL-3.0-or-later

"""Measures how far the levels of each filter are from their image, over gathered models.

Usage: blender --background --python-exit-code 1 --python bench/textures/quality.py -- [MODEL...]
       (--help lists the options)

Models are imported by Blender's own importers and read through the add-on's bridge, so the figures
are a user's results: the extension has to be installed and enabled. Ends with status 1
if a criterion of docs/benchmarks/mipmaps.md does not hold.

The error is the RMSE over the surface and the channels, in scene-linear values, between bilinear
lookups of a level and of the image. All filters are compared by lookups with numpy at the same
random points of the surface. Those that the tables name then get the exact error,
prefilter.mipmap_error, which shares nothing with the lookups: each method checks the other.
"""

import argparse
import sys
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import prefilter

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from bench.report import Report
from bench.textures import maketx_levels, sampling, subjects
from bench.textures.rivals import DILATED, Rivals, is_least_squares
from bench.textures.sampling import Floats, Texels
from bench.textures.subjects import Subject

SUBJECT = "pam-bilinear"
TRILINEAR = "pam-trilinear"
REFERENCE = "lanczos3"
PAM = (SUBJECT, TRILINEAR)  # All others are rivals.
LEVELS = range(1, 7)
BOUNDS = (0.0, 1.0)
GAIN = 0.12
PAINTED_MODEL = "spot"
PAINTED_GAIN = 0.25
AGREEMENT = 5.0  # Standard errors by which the two methods may differ.
CHANCE = 3.0  # Standard errors by which an equal filter may seem better at random points.


@dataclass
class Errors:
    """The errors on one subject, by one of the methods.

    Attributes:
        levels: Of each filter, the errors at the whole levels 1 to 6.
        all_values: Of each filter, the root mean square of the errors at all mip values, 0 to the
            last level, of trilinear lookups.
    """

    levels: dict[str, Floats] = field(default_factory=dict)
    all_values: dict[str, float] = field(default_factory=dict)


@dataclass
class Sampled(Errors):
    """The errors on one subject, by lookups at random points.

    Attributes:
        deviations: The standard errors of `levels`.
        all_deviations: Those of `all_values`.
        lead: By how many standard errors of the difference pam-bilinear is below any other filter
            at any level, and pam-trilinear over all mip values.
    """

    deviations: dict[str, Floats] = field(default_factory=dict)
    all_deviations: dict[str, float] = field(default_factory=dict)
    lead: dict[str, float] = field(default_factory=dict)


@dataclass
class Summary:
    """Rows of the tables over all subjects.

    Attributes:
        sources: The causes of the gain, by model.
        gains: The errors of pam-bilinear as shares of the lowest of all rivals, by level.
        trilinear: The errors over all mip values.
        means: The mean share of lanczos3 of each model, as it was gathered.
        shares: Of each filter, the same of each of these models, by lookups.
    """

    sources: list[list[str]] = field(default_factory=list)
    gains: list[list[str]] = field(default_factory=list)
    trilinear: list[list[str]] = field(default_factory=list)
    means: list[float] = field(default_factory=list)
    shares: dict[str, list[float]] = field(default_factory=dict)


def main() -> None:
    """Measures the models of the command line."""
    options = parse()
    report, summary = Report(), Summary()
    if not maketx_levels.is_available():
        print("maketx: not found, and left out")
    for model in options.models:
        for subject in subjects.load(options.data / model, options.wrap):
            measure(report, summary, subject, GAIN, options)
            if model == PAINTED_MODEL:
                measure_painted(report, summary, subject, options)
    add_summary(report, summary)
    if summary.means:
        mean = np.mean(summary.means)
        report.verdict(
            mean <= 1 - GAIN,
            f"{SUBJECT} is at least {GAIN:.0%} below {REFERENCE} on average over the models "
            f"(found {1 - mean:.1%})",
        )
    report.finish(options.json)


def parse() -> argparse.Namespace:
    """Reads the arguments after Blender's `--`."""
    parser = subjects.argument_parser("quality.py", __doc__)
    parser.add_argument(
        "--samples",
        type=int,
        default=1 << 18,
        help="points at which filters are looked up (default: %(default)s)",
    )
    parser.add_argument(
        "--bytes",
        action="store_true",
        help="round the levels as 8-bit images keep them; without it they are floats",
    )
    return subjects.parse(parser)


def measure(
    report: Report, summary: Summary, subject: Subject, gain: float, options: argparse.Namespace
) -> None:
    """Adds the errors of one subject to the report and the summary."""
    rivals = Rivals.of(subject)
    mipmaps = {name: rivals.levels(name, BOUNDS) for name in rivals.names()}
    mipmaps |= {name: fitted(subject, name) for name in PAM}
    if options.bytes:
        for made in mipmaps.values():
            made[1:] = [subject.rounded(level) for level in made[1:]]
    sampled = sampled_errors(subject, mipmaps, options.samples)
    others = [name for name in rivals.names() if not is_least_squares(name)]
    meshless = [name for name in rivals.names() if is_least_squares(name)]
    best = [min(others, key=lambda name: sampled.levels[name][k]) for k in range(len(LEVELS))]
    best_of_all = min(others, key=sampled.all_values.__getitem__)
    shown = dict.fromkeys([REFERENCE, *best, best_of_all, *meshless, *PAM])
    errors = exact_errors(subject, {name: mipmaps[name] for name in shown})
    add_shares(summary, subject, errors, best, meshless)
    add_levels(report, subject, errors, best, meshless, rounded=options.bytes)
    ours = errors.levels[SUBJECT]
    rest = [name for name in shown if name not in PAM]
    closest = np.min([errors.levels[name] for name in rest], axis=0)
    share = (ours / errors.levels[REFERENCE]).mean()
    if gain == GAIN:
        summary.means.append(share)
        for name, found in sampled.levels.items():
            shares = found / sampled.levels[REFERENCE]
            summary.shares.setdefault(name, []).append(shares.mean())
    name = subject.name
    report.verdict(
        bool((ours < closest).all()) and sampled.lead[SUBJECT] > -CHANCE,
        f"{name}: {SUBJECT} has the lowest error at every level 1 to 6 "
        f"({1 - (ours / closest).max():.2%} at least below all but {TRILINEAR}; by lookups "
        f"{sampled.lead[SUBJECT]:.1f} standard errors of the difference)",
    )
    report.verdict(
        share <= 1 - gain,
        f"{name}: {SUBJECT} is at least {gain:.0%} below {REFERENCE} on average over levels 1 to 6 "
        f"(found {1 - share:.1%})",
    )
    rest.append(SUBJECT)
    closest = min(rest, key=errors.all_values.__getitem__)
    ratio = errors.all_values[TRILINEAR] / errors.all_values[closest]
    low = min(meshless, key=errors.all_values.__getitem__)
    summary.trilinear.append(
        [
            name,
            f"0 to {len(mipmaps[SUBJECT]) - 1}",
            f"{errors.all_values[REFERENCE]:.5f}",
            best_of_all,
            *(f"{errors.all_values[found]:.5f}" for found in (best_of_all, low, *PAM)),
            f"{ratio:.4f}",
        ]
    )
    report.verdict(
        ratio < 1 and sampled.lead[TRILINEAR] > -CHANCE,
        f"{name}: {TRILINEAR} has the lowest error over all mip values ({1 - ratio:.2%} below "
        f"{closest}; by lookups {sampled.lead[TRILINEAR]:.1f} standard errors of the difference)",
    )
    check(report, subject, errors, sampled)


def fitted(
    subject: Subject, name: str, bounds: tuple[float, float] | None = BOUNDS
) -> list[Texels]:
    """Returns all levels of a fit over the surface."""
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


def sampled_errors(subject: Subject, mipmaps: dict[str, list[Texels]], samples: int) -> Sampled:
    """Returns the errors by lookups at random points, the same for all filters."""
    points = sampling.random_points(subject.corners, subject.uvs, samples)
    values = sampling.random_mip_values(samples, len(mipmaps[SUBJECT]) - 1)
    found = Sampled(lead={SUBJECT: np.inf, TRILINEAR: np.inf})
    by_level: list[dict[str, Floats]] = []
    for level in (*LEVELS, None):
        mips = {"mip_values": values} if level is None else {"level": level}
        squares = sampling.squared_errors(mipmaps, points, subject.wrap, **mips)
        lowest = TRILINEAR if level is None else SUBJECT
        for name, square in squares.items():
            if name != lowest:
                above = square - squares[lowest]
                found.lead[lowest] = min(found.lead[lowest], above.mean() / standard_error(above))
        by_level.append(
            {
                name: np.array([np.sqrt(square.mean()), standard_error(square)])
                for name, square in squares.items()
            }
        )
    for name in mipmaps:
        rmse, deviations = np.transpose([one[name] for one in by_level])
        deviations /= 2 * rmse
        found.levels[name], found.deviations[name] = rmse[:-1], deviations[:-1]
        found.all_values[name], found.all_deviations[name] = rmse[-1], deviations[-1]
    return found


def check(report: Report, subject: Subject, errors: Errors, sampled: Sampled) -> None:
    """Adds whether both methods found the same."""
    worst = 0.0
    for name, exact in errors.levels.items():
        apart = np.abs(sampled.levels[name] - exact) / sampled.deviations[name]
        apart_over_all = abs(sampled.all_values[name] - errors.all_values[name])
        worst = max(worst, apart.max(), apart_over_all / sampled.all_deviations[name])
    report.verdict(
        worst <= AGREEMENT,
        f"{subject.name}: the exact and the sampled errors agree "
        f"(at most {worst:.1f} standard errors apart)",
    )


def add_shares(
    summary: Summary, subject: Subject, errors: Errors, best: list[str], meshless: list[str]
) -> None:
    """Adds to the summary what pam-bilinear gains, and how much of it without the mesh."""
    reference, ours = errors.levels[REFERENCE], errors.levels[SUBJECT]
    other = np.array([errors.levels[name][k] for k, name in enumerate(best)])
    fit = np.min([errors.levels[name] for name in meshless], axis=0)
    unbounded = prefilter.mipmap_error(
        fitted(subject, SUBJECT, bounds=None)[: LEVELS[-1] + 1],
        subject.image,
        subject.surfaces,
        LEVELS,
        wrap=subject.wrap,
    )
    means = [(found / reference).mean() for found in (other, fit, ours, unbounded)]
    summary.sources.append(
        [
            subject.name,
            *(f"{mean:.3f}" for mean in means),
            f"{(ours / other).mean():.3f}",
            f"{(ours / fit).mean():.3f}",
            f"{(1 - means[1]) / (1 - means[2]):.0%}",
        ]
    )
    gains = ours / np.minimum(other, fit)
    summary.gains.append(
        [subject.name, *(f"{x:.3f}" for x in gains), f"{gains.mean():.3f}", f"{gains.max():.3f}"]
    )


def add_levels(
    report: Report,
    subject: Subject,
    errors: Errors,
    best: list[str],
    meshless: list[str],
    *,
    rounded: bool,
) -> None:
    """Adds the errors at the levels to the report."""
    rows = []
    for k, (level, other) in enumerate(zip(LEVELS, best, strict=True)):
        fit = min(meshless, key=lambda name, k=k: errors.levels[name][k])
        names = [REFERENCE, other, fit, *PAM]
        reference, rival, least, ours, trilinear = (errors.levels[name][k] for name in names)
        rows.append(
            [
                str(level),
                f"{reference:.5f}",
                f"{rival:.5f}",
                other,
                f"{least:.5f}{'*' if fit.endswith(DILATED) else ''}",
                f"{ours:.5f}",
                f"{trilinear:.5f}",
                f"{ours / rival:.3f}",
                f"{ours / least:.3f}",
            ]
        )
    height, width, channels = subject.image.shape
    triangles = sum(surface.triangle_count for surface in subject.surfaces)
    title = (
        f"{subject.name}: {width} x {height} x {channels}, {triangles} triangles, "
        f"wrap {subject.wrap}: "
        f"RMSE over the surface{', levels in 8 bits' if rounded else ''}"
    )
    head = ["level", REFERENCE, "best other", "", "ls-bilinear", *PAM, "/ other", "/ ls"]
    report.table(title, head, rows, subject.name)


def measure_painted(
    report: Report, summary: Summary, subject: Subject, options: argparse.Namespace
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
        measure(report, summary, painted, PAINTED_GAIN, options)


def add_summary(report: Report, summary: Summary) -> None:
    """Adds the tables over all subjects."""
    report.table(
        f"Mean shares of {REFERENCE} over levels 1 to 6; {SUBJECT} as shares of others; how much "
        f"of its gain over {REFERENCE} least squares have without the mesh",
        [
            "model",
            "best other",
            "ls-bilinear",
            SUBJECT,
            "unbounded",
            "/ other",
            "/ ls",
            "without mesh",
        ],
        summary.sources,
        "gain",
    )
    report.table(
        f"{SUBJECT} / the lowest of all others",
        ["model", *(f"level {level}" for level in LEVELS), "mean", "closest"],
        summary.gains,
        "levels",
    )
    report.table(
        "RMSE over all mip values, trilinear lookups",
        ["model", "mip values", REFERENCE, "best other", "", "ls-bilinear", *PAM, "/ best"],
        summary.trilinear,
        "trilinear",
    )
    rows = []
    for name in summary.shares:
        if not name.endswith(DILATED):
            cells = [cell for one in (name, name + DILATED) for cell in spread(summary, one)]
            rows.append([name, *cells])
    report.table(
        f"Mean shares of {REFERENCE} over levels 1 to 6, by lookups: over the models, the least "
        "and the most of one",
        ["filter", "mean", "least", "most", "dilated: mean", "least", "most"],
        rows,
        "filters",
    )


def spread(summary: Summary, name: str) -> list[str]:
    """Returns the mean, the least and the most share of a filter; blanks where there is none."""
    found = np.array(summary.shares.get(name, []))
    return (
        [f"{x:.3f}" for x in (found.mean(), found.min(), found.max())] if found.size else [""] * 3
    )


def standard_error(samples: Floats) -> float:
    """Returns the standard error of the mean of samples."""
    return float(samples.std() / np.sqrt(len(samples)))


if __name__ == "__main__":
    main()
