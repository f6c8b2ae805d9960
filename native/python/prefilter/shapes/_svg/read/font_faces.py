# SPDX-License-Identifier: GPL-3.0-or-later

"""Fonts of `@font-face` rules."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import tinycss2

from ..._fonts.faces import Face, UnreadableFontError, read_embedded_face
from ..._fonts.woff import MAX_BYTES
from ..model.values import parse_url
from ..model.warnings import Warnings
from .external_resources import NotLocalError, UnusableError, read_address
from .text_style import DEFAULT_TEXT_STYLE, FontRule, inherit_text_style

_NAMES = ("font-weight", "font-style", "font-stretch")


def read_font_faces(rules: Sequence[FontRule], warnings: Warnings) -> list[Face]:
    """Reads the fonts of rules; unusable ones cause warnings."""
    faces = []
    for rule in rules:
        family = rule.descriptors.get("font-family", "").strip().strip("\"'")
        if not family or "src" not in rule.descriptors:
            warnings.broken("@font-face", "ignored", rule.line)
            continue
        face = _read(rule, family, warnings)
        if face is not None:
            faces.append(_with_descriptors(face, family, rule.descriptors))
    # Later rules take precedence.
    return faces[::-1]


def _read(rule: FontRule, family: str, warnings: Warnings) -> Face | None:
    """Reads the first usable font in the `src` list."""
    name = f"@font-face '{family[:60]}'"
    reason = "as it is not in the file"
    tokens = tinycss2.parse_component_value_list(rule.descriptors["src"], skip_comments=True)
    for address in map(parse_url, tokens):
        if not address or address.startswith("#"):
            continue
        try:
            return read_embedded_face(read_address(address, rule.base, MAX_BYTES)[0], family)
        except (NotLocalError, UnusableError) as error:
            reason = str(error)
        except UnreadableFontError as error:
            reason = f"as it cannot be read: {error}"
    warnings.unsupported(name, f"ignored, {reason}", rule.line)
    return None


def _with_descriptors(face: Face, family: str, descriptors: Mapping[str, str]) -> Face:
    """Applies a rule's descriptors to a face, over those in its file."""
    properties = {name: descriptors[name] for name in _NAMES if name in descriptors}
    low, high = descriptors.get("font-weight", ""), ""
    if len(low.split()) == 2:
        low, high = low.split()
        properties["font-weight"] = low
    style = inherit_text_style(properties, DEFAULT_TEXT_STYLE, 16.0)
    heaviest = (
        inherit_text_style({"font-weight": high}, style, 16.0).weight if high else style.weight
    )
    return replace(
        face,
        family=family,
        families=frozenset((family.lower(),)),
        weight=(style.weight, max(heaviest, style.weight)),
        stretch=(style.stretch, style.stretch),
        slant=style.slant,
    )
