# SPDX-License-Identifier: GPL-3.0-or-later

"""Names of color spaces. Loads no numpy, so that commands that find all up to date start fast.

Canonical names are those of the ASWF Color Interop Forum, such as "lin_ap1_scene": curve,
primaries, and whether values are scene- or display-referred. Blender and others use aliases.
"""

import re

AUTO = "auto"
"""The color space that a file declares."""
DATA = "data"
"""Values that are not colors."""
REC709_LINEAR = "lin_rec709_scene"
SRGB = "srgb_rec709_scene"

_WHITE_D65, _WHITE_D60, _WHITE_E = (0.3127, 0.3290), (0.32168, 0.33767), (1 / 3, 1 / 3)
CHROMATICITIES: dict[str, tuple[float, ...]] = {
    "rec709": (0.64, 0.33, 0.30, 0.60, 0.15, 0.06, *_WHITE_D65),
    "p3d65": (0.680, 0.320, 0.265, 0.690, 0.150, 0.060, *_WHITE_D65),
    "rec2020": (0.708, 0.292, 0.170, 0.797, 0.131, 0.046, *_WHITE_D65),
    "adobergb": (0.64, 0.33, 0.21, 0.71, 0.15, 0.06, *_WHITE_D65),
    "ap1": (0.713, 0.293, 0.165, 0.830, 0.128, 0.044, *_WHITE_D60),
    "ap0": (0.73470, 0.26530, 0.0, 1.0, 0.00010, -0.07700, *_WHITE_D60),
}
"""x and y of red, green, blue and white, by the name of the primaries."""
REC709 = CHROMATICITIES["rec709"]

_ALIASES = {
    "srgb": SRGB,
    "srgb texture": SRGB,
    "srgb - texture": SRGB,
    "utility - srgb - texture": SRGB,
    "srgb encoded rec.709 (srgb)": SRGB,
    "srgb_texture": SRGB,
    "linear": REC709_LINEAR,
    "linear rec.709": REC709_LINEAR,
    "linear rec.709 (srgb)": REC709_LINEAR,
    "utility - linear - srgb": REC709_LINEAR,
    "utility - linear - rec.709": REC709_LINEAR,
    "lin_rec709": REC709_LINEAR,
    "lin_srgb": REC709_LINEAR,
    "acescg": "lin_ap1_scene",
    "aces - acescg": "lin_ap1_scene",
    "lin_ap1": "lin_ap1_scene",
    "aces2065-1": "lin_ap0_scene",
    "aces - aces2065-1": "lin_ap0_scene",
    "lin_ap0": "lin_ap0_scene",
    "display p3": "srgb_p3d65_scene",
    "linear p3-d65": "lin_p3d65_scene",
    "linear dci-p3 d65": "lin_p3d65_scene",
    "linear rec.2020": "lin_rec2020_scene",
    "lin_rec2020": "lin_rec2020_scene",
    "lin_p3d65": "lin_p3d65_scene",
    "adobe rgb": "g22_adobergb_scene",
    "raw": DATA,
    "non-color": DATA,
    "utility - raw": DATA,
}
_GAMMA = re.compile(r"Gamma(\d+(?:\.\d+)?)")
EXAMPLES = ("sRGB", "Linear Rec.709", "ACEScg", "Display P3", "Adobe RGB", "data")
"""Names shown in the help of commands."""


_PATTERN = re.compile(r"(lin|srgbe?|g[1-9]\d)_(\w+?)(?:_(?:scene|display))?")


def canonical(name: str) -> str:
    """Returns the Color Interop Forum's name for an alias; other names unchanged."""
    return _ALIASES.get(name.strip().lower(), name.strip())


def parts(name: str) -> tuple[str, str] | None:
    """Returns the names of a space's curve and primaries; None if unknown.

    A curve is "lin", "srgb" or "srgbe"; "g22" and the like for ten times an exponent; or "Gamma"
    followed by the exponent itself.
    """
    known = canonical(name)
    gamma = _GAMMA.fullmatch(known)
    if gamma is not None:
        return (known, "rec709") if float(gamma[1]) > 0.0 else None
    match = _PATTERN.fullmatch(known)
    if match is None or match[2] not in CHROMATICITIES:
        return None
    return match[1], match[2]


def is_known(name: str) -> bool:
    """Tells whether colors of the named space can be converted."""
    return parts(name) is not None


def is_data_name(name: str) -> bool:
    """Tells whether a name means that values are not colors."""
    return canonical(name).lower() == DATA


def checked_name(name: str) -> str:
    """Returns the name of a space, as given by a flag, if it is known.

    Raises:
        ValueError: The name is unknown.
    """
    if name != AUTO and not is_data_name(name) and not is_known(name):
        raise ValueError(
            f"found '{name}'; {AUTO}, {', '.join(EXAMPLES)}, or a name of the Color Interop Forum "
            f"such as lin_ap1_scene or srgb_p3d65_scene is needed"
        )
    return name


def chromaticities_of(name: str) -> tuple[float, ...] | None:
    """Returns x and y of red, green, blue and white of a linear space; None if unknown."""
    names = parts(name)
    return CHROMATICITIES[names[1]] if names is not None and names[0] == "lin" else None


def interop_name(name: str) -> str:
    """Returns the Color Interop Forum's name of a space; empty if there is none."""
    known = canonical(name)
    if known == DATA:
        return DATA
    return known if is_known(known) else ""
