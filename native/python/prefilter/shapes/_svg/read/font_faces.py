# SPDX-License-Identifier: GPL-3.0-or-later

"""Fonts in a drawing itself: `@font-face`."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import tinycss2

from ..._fonts.faces import Face, UnreadableFontError, face_in
from ..._fonts.woff import MOST_BYTES
from ..model.values import url_of
from ..model.warnings import Warnings
from .external_resources import ElsewhereError, UnusableError, read_address
from .text_style import USUAL_TEXT, FontRule, text_style_below

_NAMES = ("font-weight", "font-style", "font-stretch")


def own_faces(rules: Sequence[FontRule], warnings: Warnings) -> list[Face]:
    """The fonts of rules; warns of those that cannot be had."""
    found = []
    for rule in rules:
        family = rule.said.get("font-family", "").strip().strip("\"'")
        if not family or "src" not in rule.said:
            warnings.broken("@font-face", "ignored", rule.line)
            continue
        face = _read(rule, family, warnings)
        if face is not None:
            found.append(_described(face, family, rule.said))
    # What is said later counts.
    return found[::-1]


def _read(rule: FontRule, family: str, warnings: Warnings) -> Face | None:
    """The first font of a list that is in the file, or beside it."""
    name = f"@font-face '{family[:60]}'"
    reason = "as it is not in the file"
    tokens = tinycss2.parse_component_value_list(rule.said["src"], skip_comments=True)
    for address in map(url_of, tokens):
        if not address or address.startswith("#"):
            continue
        try:
            return face_in(read_address(address, rule.place, MOST_BYTES)[0], family)
        except (ElsewhereError, UnusableError) as error:
            reason = str(error)
        except UnreadableFontError as error:
            reason = f"as it cannot be read: {error}"
    warnings.unsupported(name, f"ignored, {reason}", rule.line)
    return None


def _described(face: Face, family: str, said: Mapping[str, str]) -> Face:
    """A face as its rule describes it, whatever its file says."""
    told = {name: said[name] for name in _NAMES if name in said}
    low, high = said.get("font-weight", ""), ""
    if len(low.split()) == 2:
        low, high = low.split()
        told["font-weight"] = low
    style = text_style_below(told, USUAL_TEXT, 16.0)
    heaviest = text_style_below({"font-weight": high}, style, 16.0).weight if high else style.weight
    return replace(
        face,
        family=family,
        families=frozenset((family.lower(),)),
        weight=(style.weight, max(heaviest, style.weight)),
        stretch=(style.stretch, style.stretch),
        slant=style.slant,
    )
