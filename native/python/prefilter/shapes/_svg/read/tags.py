# SPDX-License-Identifier: GPL-3.0-or-later

"""Which elements group others, paint, or are not drawn."""

GRADIENTS = ("linearGradient", "radialGradient")
GROUPS = ("g", "a", "svg", "symbol", "switch")
OTHER_PAINTS = ("hatch", "meshgradient", "solidcolor")
NOT_DRAWN = frozenset(
    (
        *("defs", "marker", "clipPath", "mask", "filter", "pattern", *GRADIENTS),
        *("title", "desc", "metadata", "style", "script", "view", "cursor"),
        *("animate", "animateColor", "animateMotion", "animateTransform", "set"),
        *("font", "font-face", "color-profile", *OTHER_PAINTS),
    )
)
