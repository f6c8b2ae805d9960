# SPDX-License-Identifier: GPL-3.0-or-later

"""Every text that users see is in the tables of all languages, and these hold no others."""

import functools
import importlib
import json
import re
import string
import sys
from pathlib import Path

import blf
import bpy
import pytest
from conftest import PACKAGE

ROOT = Path(__file__).resolve().parents[2]
sys.path.append(str(ROOT / "scripts"))

import messages  # noqa: E402

translations = importlib.import_module(f"{PACKAGE}.core.translations")
for_languages = pytest.mark.parametrize("language", translations.LANGUAGES)
POINTS = 11
"""The size of Blender's letters at a scale of 1."""
BUTTON_ROOM = 190
"""Pixels for the text of a button with an icon, in a sidebar that is 266 wide."""


shown = functools.cache(messages.shown)


@for_languages
def test_tables_have_every_shown_text(language):
    # scripts/messages.py adds and removes entries; a translation is then to be written.
    table = translations.table(language)
    assert len(shown()) > 700
    missing = {text: places[0] for text, places in shown().items() if not table.get(text)}
    assert not missing, f"not translated into {language}: {missing}"
    unused = [text for text in table if text not in shown()]
    assert not unused, f"in {language}, and shown nowhere: {unused}"


@for_languages
def test_the_header_says_that_no_native_speaker_has_reviewed_the_table(language):
    header, _ = next(iter(json.loads(path_of(language).read_text(encoding="utf-8")).items()))
    assert header == translations.HEADER
    assert translations.HEADER not in translations.table(language)


def path_of(language):
    return translations.FOLDER / f"{language}.json"


@for_languages
def test_tables_are_sorted(language):
    assert list(translations.table(language)) == sorted(translations.table(language))


@for_languages
def test_placeholders_are_the_same(language):
    wrong = {}
    for text, translated in translations.table(language).items():
        try:
            same = filled_in(text) == filled_in(translated)
        except ValueError:  # Fields with numbers and fields without.
            same = False
        if not same:
            wrong[text] = translated
    assert not wrong


def filled_in(text):
    """Returns the values that a text contains, in any order."""
    names = [name for _, name, _, _ in string.Formatter().parse(text) if name is not None]
    values = [f"<{i}>" for i in range(len(names))]
    named = {name: f"<{name}>" for name in names if name and not name.isdigit()}
    return sorted(re.findall(r"<\w+>", text.format(*values, **named)))


def test_sentences_are_translated_before_they_are_filled_in():
    assert not list(messages.untranslated())


@for_languages
def test_buttons_and_titles_fit(language):
    table = translations.table(language)
    labels = {text for kind, text, _ in messages.written() if kind == messages.BUTTON}
    labels |= {
        one.bl_label
        for one in messages.classes()
        if issubclass(one, (bpy.types.Operator, bpy.types.Panel))
    }
    blf.size(0, POINTS)
    wide = {label: blf.dimensions(0, table[label])[0] for label in labels if table.get(label)}
    assert len(wide) > 60
    assert not {label: table[label] for label, one in wide.items() if one > BUTTON_ROOM}


def test_long_texts_wrap_where_letters_are_wide(addon):
    wrapped = addon("core.sidebar").wrapped
    assert wrapped("four words of English", 10) == ["four words", "of English"]
    assert [len(line) for line in wrapped("\u8868" * 12, 10)] == [5, 5, 2]


@pytest.fixture
def german():
    view = bpy.context.preferences.view
    try:
        view.language = "de_DE"
    except TypeError:
        pytest.skip("this Blender has no languages")
    view.use_translate_interface = view.use_translate_tooltips = view.use_translate_reports = True
    yield
    view.language = "DEFAULT"


def test_texts_are_shown_in_the_language_of_the_user(addon, german):
    said = addon("core.translations")
    assert said.tr("Wipe") == "Wischer"
    assert said.report("{} canceled").format(said.report("Voxelizing")).endswith("abgebrochen")
    sentence = addon("core.wording").Sentence
    inner = sentence("{} files", 3)
    assert said.report(sentence("Baked {} of {} images", inner, "Images")) == (
        "3 Dateien von Images Bildern gebacken"  # Only what is a sentence is translated.
    )
    assert said.reported(RuntimeError("Fehler: Objekt 'Cube' ist weg\n")) == "Objekt 'Cube' ist weg"
    with pytest.raises(RuntimeError, match="In dieser Datei ist kein Bild"):
        bpy.ops.prefilter.resize_image()


def test_texts_are_english_once_the_add_on_is_disabled(addon, german):
    said = addon("core.translations")
    said.unregister()
    try:
        assert said.tr("Wipe") == "Wipe"
    finally:
        said.register()


def test_results_are_reported_in_the_language_of_the_user(german, capfd):
    bpy.ops.mesh.primitive_cube_add()
    bpy.context.active_object.name = "Scene"
    bpy.ops.prefilter.voxelize(depth=4)
    out = capfd.readouterr().out
    assert "'Scene' in 16³ Zellen von" in out
    assert "Dreiecke, Volumen" in out
    assert "voxelisiert" in out
