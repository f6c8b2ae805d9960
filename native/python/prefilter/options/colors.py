# SPDX-License-Identifier: GPL-3.0-or-later

"""Colors in command-line notation: #RRGGBB or #RRGGBBAA, in sRGB."""

import re
from collections.abc import Sequence

Color = tuple[float, float, float, float]
"""Scene-linear red, green and blue, and alpha; colors are not multiplied by alpha."""

_HEX = re.compile(r"#?([0-9a-fA-F]{6})([0-9a-fA-F]{2})?")


def from_hex(text: str) -> Color | None:
    """Parses a color; None if the text is not one."""
    match = _HEX.fullmatch(text.strip())
    if match is None:
        return None
    import numpy as np  # Imported late: most commands need no numpy to start.

    import prefilter

    numbers = bytes.fromhex(match[1] + (match[2] or "ff"))
    values = prefilter.to_linear(np.array([[list(numbers)]], np.float32) / 255)[0, 0]
    red, green, blue, alpha = (float(value) for value in values)
    return red, green, blue, alpha


def to_hex(color: Sequence[float]) -> str:
    """Returns a color as #RRGGBB, or with its alpha where it is not opaque."""
    import numpy as np

    import prefilter

    encoded = prefilter.to_srgb(np.array([[tuple(color)]], np.float32))[0, 0]
    numbers = bytes(np.rint(np.clip(np.nan_to_num(encoded), 0.0, 1.0) * 255).astype(np.uint8))
    return f"#{(numbers[:3] if numbers[3] == 255 else numbers).hex()}"
