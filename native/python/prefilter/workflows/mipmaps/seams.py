# SPDX-License-Identifier: GPL-3.0-or-later

"""What the setting Seams does: the contrast of UV seams in each level, without it and with it."""

from collections.abc import Sequence


def note(image_name: str, without: Sequence[float], weighed: Sequence[float]) -> str:
    """Returns a line that compares contrasts of levels 1 and up; empty where there is no seam.

    Args:
        image_name: Whose levels they are.
        without: What `prefilter.seam_contrast` says of levels that do not heed seams.
        weighed: The same of those that do.
    """
    if not any(without):
        return ""
    pairs = enumerate(zip(without, weighed, strict=True), start=1)
    shown = ", ".join(f"{level}: {before:.3g} > {after:.3g}" for level, (before, after) in pairs)
    return f"Contrast across the seams of '{image_name}' by level, without and with Seams: {shown}"
