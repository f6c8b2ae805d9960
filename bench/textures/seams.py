# SPDX-License-Identifier: GPL-3.0-or-later

"""Measures the effect of a seam budget on UV seams and on the error, over gathered models.

Usage: blender --background --python-exit-code 1 --python bench/textures/seams.py -- [MODEL...]
       (--help lists the options)

Models are imported by Blender's own importers, and read through the add-on's bridge, as in
quality.py. Per level and budget: prefilter.seam_contrast, the contrast of only those seams that the
image hides, and prefilter.mipmap_error. The first is checked by lookups with numpy along the seams,
which are found without the library. Ends with status 1 if a criterion of docs/benchmarks/mipmaps.md
does not hold.
"""

import argparse
import sys
from pathlib import Path

import numpy as np
import prefilter

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from bench.report import Report
from bench.textures import sampling, subjects
from bench.textures.sampling import Floats, Texels
from bench.textures.subjects import Subject

LEVELS = range(1, 8)
BUDGET = 0.01
FURTHER_BUDGETS = (0.003, 0.03)
# Seams across which the image steps by less than that share of its standard deviation are hidden.
HIDDEN = 0.1
AGREEMENT = 0.01
# Limits of the search for the best trade.
MOST_UNKNOWNS = 1024
POINTS = 1 << 16
MOST_SWEEPS = 500
STILL = 1e-5


def main() -> None:
    """Measures the models of the command line."""
    parser = subjects.argument_parser("seams.py", __doc__)
    parser.add_argument(
        "--budgets",
        type=float,
        nargs="*",
        default=FURTHER_BUDGETS,
        metavar="SHARE",
        help=f"seam budgets to measure beside 0 and {BUDGET:g} (default: %(default)s)",
    )
    options = subjects.parse(parser)
    report = Report()
    summary: list[list[str]] = []
    for model in options.models:
        for subject in subjects.load(options.data / model, options.wrap):
            measure(report, summary, subject, options)
    report.table(
        "Summary: contrast as a share of that without a budget, and how much the RMSE rises in "
        "percent, at levels 1 to 7",
        ["model", "hidden", "budget", "all seams", "hidden seams", "RMSE"],
        summary,
        "contrast",
    )
    report.finish(options.json)


def measure(
    report: Report, summary: list[list[str]], subject: Subject, options: argparse.Namespace
) -> None:
    """Adds the measurements of one subject to the report and the summary."""
    lines = sampling.seam_lines(subject.corners, subject.uvs, subject.parts)
    if not len(lines.lengths):
        (found,) = prefilter.seam_contrast([subject.image], subject.surfaces, wrap=subject.wrap)
        report.verdict(found == 0, f"{subject.name}: has no seams, and the library finds none")
        return
    hidden = hidden_lines(subject, lines)
    budgets = (0.0, *sorted({BUDGET, *options.budgets}))
    mipmaps = {budget: bake(subject, budget) for budget in budgets}
    of_all = {
        budget: prefilter.seam_contrast(levels, subject.surfaces, wrap=subject.wrap)
        for budget, levels in mipmaps.items()
    }
    of_hidden = {
        budget: np.array([hidden.contrast(level, subject.wrap) for level in levels])
        for budget, levels in mipmaps.items()
    }
    errors = {
        budget: prefilter.mipmap_error(
            levels, subject.image, subject.surfaces, LEVELS, wrap=subject.wrap
        )
        for budget, levels in mipmaps.items()
    }
    found = {
        "all seams": {budget: of_all[budget][1:] for budget in budgets},
        "hidden seams": {budget: of_hidden[budget][1:] for budget in budgets},
        "RMSE": errors,
    }
    share_hidden = hidden.lengths.sum() / lines.lengths.sum()
    own = of_all[0.0][0]
    report.table(
        f"{subject.name}: {len(lines.lengths)} edges on seams, {share_hidden:.0%} of their length "
        f"hidden in the image, whose own contrast is {own:.5f}",
        ["level", *(f"{name}, {b:g}" for name in found for b in budgets)],
        [
            [str(level), *(f"{found[name][b][k]:.5f}" for name in found for b in budgets)]
            for k, level in enumerate(LEVELS)
        ],
    )
    shares = {
        name: {b: values[b] / values[0.0] for b in budgets}
        for name, values in found.items()
        if share_hidden or name != "hidden seams"
    }
    for budget in budgets[1:]:
        row = [subject.name, f"{share_hidden:.0%}", f"{budget:.1%}"]
        for name in ("all seams", "hidden seams"):
            numbers = shares[name][budget] if name in shares else ()
            row.append(" ".join(f"{x:.2f}" for x in numbers))
        summary.append([*row, " ".join(f"{100 * (x - 1):.2f}" for x in shares["RMSE"][budget])])
    judge(report, subject.name, shares)
    check_by_sampling(report, subject, lines, mipmaps, of_all)
    if share_hidden:
        add_best_trades(report, subject, hidden, shares["hidden seams"], mipmaps[0.0])


def hidden_lines(subject: Subject, lines: sampling.SeamLines) -> sampling.SeamLines:
    """Returns the seams along which the image has about the same colors on both sides."""
    points = sampling.random_points(subject.corners, subject.uvs, POINTS)
    variance = sampling.lookup(subject.image, points, subject.wrap).var(axis=0).mean()
    return lines.where(lines.squares(subject.image, subject.wrap) <= HIDDEN**2 * variance)


def bake(subject: Subject, budget: float) -> list[Texels]:
    """Returns levels 0 to 7."""
    return prefilter.mipmaps(
        subject.image,
        subject.surfaces,
        wrap=subject.wrap,
        levels=LEVELS[-1] + 1,
        premultiplied=True,
        seam_budget=budget,
    )


def judge(report: Report, name: str, shares: dict[str, dict[float, Floats]]) -> None:
    """Adds whether the criterion holds."""
    for budget, values in shares["RMSE"].items():
        if budget == 0:
            continue
        rise = values.max() - 1
        report.verdict(
            rise <= budget,
            f"{name}: with a budget of {budget:.1%} the RMSE rises by at most that at every level "
            f"1 to 7 (found {rise:.4%})",
        )


def check_by_sampling(
    report: Report,
    subject: Subject,
    lines: sampling.SeamLines,
    mipmaps: dict[float, list[Texels]],
    contrasts: dict[float, Floats],
) -> None:
    """Adds whether lookups along the seams find the same contrast."""
    worst = 0.0
    for budget in (0.0, BUDGET):
        for k, level in enumerate(mipmaps[budget]):
            found = lines.contrast(level, subject.wrap)
            worst = max(worst, abs(found - contrasts[budget][k]) / contrasts[0.0][k])
    report.verdict(
        worst <= AGREEMENT,
        f"{subject.name}: lookups along the seams find the same contrast (within {worst:.2%} of "
        "that without a budget)",
    )


def add_best_trades(
    report: Report,
    subject: Subject,
    lines: sampling.SeamLines,
    shares: dict[float, Floats],
    levels: list[Texels],
) -> None:
    """Adds the least contrast that the budget can buy, at levels of few texels.

    Among all levels within the bounds, the minimizers of error^2 + multiplier contrast^2 have the
    lowest contrast for their error. So the multiplier that spends the budget gives the best trade.
    """
    points = sampling.random_points(subject.corners, subject.uvs, POINTS)
    truth = sampling.lookup(subject.image, points, subject.wrap)
    for k in LEVELS:
        height, width, channels = levels[k].shape
        if height * width > MOST_UNKNOWNS:
            continue
        taps = sampling.Taps(points, levels[k].shape, subject.wrap)
        area, goal = taps.normal_equations(truth)
        across = lines.matrix(levels[k].shape, subject.wrap)

        def error(texels: Floats, taps: sampling.Taps = taps) -> float:
            return float(np.sqrt(((taps.of_flat(texels) - truth) ** 2).mean()))

        def contrast(texels: Floats, across: Floats = across) -> float:
            return float(np.sqrt((texels * (across @ texels)).sum() / texels.shape[1]))

        start = levels[k].reshape(-1, channels).astype(float)
        texels = least_squares(area, goal, start)
        before = error(texels), contrast(texels)
        low, high = 1e-4, 1e4
        while high / low > 1.05:
            middle = np.sqrt(low * high)
            texels = least_squares(area + middle * across, goal, texels)
            if error(texels) > (1 + BUDGET) * before[0]:
                high = middle
            else:
                low = middle
        report.note(
            f"{subject.name}, level {k}: the least contrast of hidden seams for "
            f"{error(texels) / before[0] - 1:.2%} more RMSE is "
            f"{contrast(texels) / before[1]:.3f} of that without; found {shares[BUDGET][k - 1]:.3f}"
        )


def least_squares(matrix: Floats, goal: Floats, start: Floats) -> Floats:
    """Returns the texels in [0, 1] with the least square, by projected Gauss-Seidel."""
    texels = start.copy()
    (read,) = np.nonzero(np.diag(matrix) > 0)
    for _ in range(MOST_SWEEPS):
        before = texels.copy()
        for i in read:
            step = (goal[i] - matrix[i] @ texels) / matrix[i, i]
            texels[i] = np.minimum(np.maximum(texels[i] + step, 0), 1)
        if np.abs(texels - before).max() < STILL:
            break
    return texels


if __name__ == "__main__":
    main()
