# SPDX-License-Identifier: GPL-3.0-or-later

"""Translation of the interface and of reports, by Blender's own mechanism.

The folder translations/ of the add-on has one table per language, keyed by the English text; docs/
and the command line are English. Blender prefers its own translation of a text in the same context,
such as "Mesh"; options have a separate context, because a word may have another meaning here. No
native speaker has reviewed the tables yet; their first entry says so.
"""

import json
from collections.abc import Callable
from pathlib import Path

import bpy

from .wording import Sentence

CONTEXT = "Prefilter"
"""The context of options, and of texts that Blender would confuse with its own."""
LANGUAGES = ("de_DE", "es", "fr_FR", "ja_JP", "zh_HANS")
"""The languages with tables, by Blender's names."""
FOLDER = Path(__file__).resolve().parents[1] / "translations"
HEADER = ""
"""The key of the first entry of a table, a note about the table."""
_CONTEXTS = ("*", "Operator", CONTEXT)


def tr(text: str) -> str:
    """Translates a text of the interface; fill in placeholders afterward."""
    return _translated(text, bpy.app.translations.pgettext_iface)


def report(text: str) -> str:
    """Translates a text of a report; fill in placeholders afterward."""
    return _translated(text, bpy.app.translations.pgettext_rpt)


def reported(error: RuntimeError) -> str:
    """Returns the report of an operator that raised an error, without Blender's prefix."""
    kind = bpy.app.translations.pgettext_rpt("Error")
    return str(error).strip().removeprefix(f"{kind}: ")


def _translated(text: str, translate: Callable[[str, str], str]) -> str:
    if not isinstance(text, Sentence):
        return translate(text, CONTEXT)
    values = [
        _translated(value, translate) if isinstance(value, Sentence) else value
        for value in text.values
    ]
    translated = translate(text.template, CONTEXT)
    return translated.format(*values) if values else translated


def marked(text: str) -> str:
    """Returns the text unchanged: marks it for translation by a later `tr` or `report`."""
    return text


def table(language: str) -> dict[str, str]:
    """Returns the translations into a language, by the English text, without the header."""
    texts = json.loads((FOLDER / f"{language}.json").read_text(encoding="utf-8"))
    return {text: translated for text, translated in texts.items() if text != HEADER}


def register() -> None:
    """Registers the tables with Blender."""
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
    """Unregisters them."""
    bpy.app.translations.unregister(__package__)
