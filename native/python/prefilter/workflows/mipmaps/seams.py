# SPDX-License-Identifier: GPL-3.0-or-later

"""Report on the setting Seams: contrast across UV seams in each level, without and with it."""

from collections.abc import Sequence


def note(image_name: str, without: Sequence[float], weighed: Sequence[float]) -> str:
    """Returns a line that compares contrasts of levels 1 and up; empty without seams.

    Args:
        image_name: The image's name.
        without: Results of `prefilter.seam_contrast` for levels without seam weights.
        weighed: The same for levels with seam weights.
    """
    if not any(without):
        return ""
    pairs = enumerate(zip(without, weighed, strict=True), start=1)
    shown = ", ".join(f"{level}: {before:.3g} > {after:.3g}" for level, (before, after) in pairs)
    return f"Contrast across the seams of '{image_name}' by level, without and with Seams: {shown}"
