# SPDX-License-Identifier: GPL-3.0-or-later

"""What users read in their own language, by Blender's own mechanism.

A table a language, by the English text, lies in the folder translations/ of the add-on; docs/ and
the command line are English. Blender shows its own translation of a text where it has one in the
same context, such as "Mesh"; options have a context of their own, as a word may mean another thing
here.
"""

import json
from collections.abc import Callable
from pathlib import Path

import bpy

from .wording import Sentence

CONTEXT = "Prefilter"
"""The context of options, and of texts that Blender would take for others of its own."""
LANGUAGES = ("de_DE", "es", "fr_FR", "ja_JP", "zh_HANS")
"""What there are tables for, as Blender names them."""
FOLDER = Path(__file__).resolve().parents[1] / "translations"
_CONTEXTS = ("*", "Operator", CONTEXT)


def tr(text: str) -> str:
    """Returns a text of the interface as users read it; placeholders are filled in afterward."""
    return _translated(text, bpy.app.translations.pgettext_iface)


def report(text: str) -> str:
    """Returns a text of a report as users read it; placeholders are filled in afterward."""
    return _translated(text, bpy.app.translations.pgettext_rpt)


def reported(error: RuntimeError) -> str:
    """Returns what an operator has reported that has raised an error."""
    kind = bpy.app.translations.pgettext_rpt("Error")
    return str(error).strip().removeprefix(f"{kind}: ")


def _translated(text: str, translate: Callable[[str, str], str]) -> str:
    if not isinstance(text, Sentence):
        return translate(text, CONTEXT)
    values = [
        _translated(one, translate) if isinstance(one, Sentence) else one for one in text.values
    ]
    translated = translate(text.template, CONTEXT)
    return translated.format(*values) if values else translated


def marked(text: str) -> str:
    """Returns a text as it is: one that is handed to `tr` or `report` elsewhere."""
    return text


def table(language: str) -> dict[str, str]:
    """Returns the texts in a language, by those in English."""
    return json.loads((FOLDER / f"{language}.json").read_text(encoding="utf-8"))


def register() -> None:
    """Makes the tables known to Blender."""
    tables = {
        language: {
            (context, text): translated
            for text, translated in table(language).items()
            for context in _CONTEXTS
        }
        for language in LANGUAGES
    }
    bpy.app.translations.register(__package__, tables)


def unregister() -> None:
    """Takes them back."""
    bpy.app.translations.unregister(__package__)
