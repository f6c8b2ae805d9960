# SPDX-License-Identifier: GPL-3.0-or-later

"""Updates the translation tables with the texts that Blender shows of the add-on.

A new text gets an empty entry, and a text that is no longer shown loses its entry.

usage: scripts/run blender --background --python-exit-code 1 --python scripts/messages.py
"""

import ast
import importlib
import json
import re
import sys
from collections.abc import Iterator
from pathlib import Path

import bpy

PACKAGE = "bl_ext.user_default.prefilter"
ROOT = Path(__file__).resolve().parents[1]
ADDON = ROOT / "addon"
SHARED = ROOT / "native/python/prefilter/workflows"
"""Modules that the add-on shares with the package's command."""
LABEL, TIP, TEXT, BUTTON = "label", "tip", "text", "button"
_BASES = (
    *(bpy.types.Operator, bpy.types.Panel, bpy.types.Menu, bpy.types.PropertyGroup),
    *(bpy.types.AddonPreferences, bpy.types.FileHandler, bpy.types.UIList),
)
_LABELED = (bpy.types.Operator, bpy.types.Panel, bpy.types.Menu, bpy.types.FileHandler)
_WITHOUT_PROPERTIES = (bpy.types.Panel, bpy.types.Menu, bpy.types.FileHandler)
_TRANSLATED = {"tr", "report", "marked", "Sentence"}
_COUNTED = ("1 {}", "{{}} {}s")
_SCALED = ("{{}} million {}s", "{{}} billion {}s")
"""Patterns by which wording.py formats counts."""
_DRAWING = {"draw": 2, "draw_main": 2, "note": 2, "subpanel": 2}
"""Functions that draw a text, and which argument it is."""
_SAYING = {"poll_message_set", "report"}
"""Methods that show a text as it is."""
_BUTTONS = {"operator", "prop", "label", "draw", "draw_main", "subpanel"}
"""Functions that draw a text into one line of a panel."""
_WIDE = re.compile(r".*\bmenus\.py|core/shortcuts\.py|preferences\.py")
"""Modules that draw menus and the preferences, where there is room."""
_DRAWN = {"text", "heading", "placeholder", "message"}
_SAID = {"activity", "makes", "required_object", "nothing"}


def shown() -> dict[str, list[str]]:
    """Returns the kind and the place of each text that Blender shows."""
    found: dict[str, list[str]] = {}
    for kind, text, where in (*registered(), *presets(), *written()):
        if any(letter.isalpha() for letter in text):
            found.setdefault(text, []).append(f"{kind} of {where}")
    return found


def registered() -> Iterator[tuple[str, str, str]]:
    """Yields kind, text and place of the labels and tips of classes and properties."""
    for one in classes():
        if issubclass(one, _LABELED):
            yield LABEL, one.bl_label, one.__name__
        if issubclass(one, _WITHOUT_PROPERTIES):
            continue
        rna = _rna(one)
        if issubclass(one, bpy.types.Operator):
            yield TIP, rna.description, one.__name__
        for item in _own_properties(one, rna):
            place = f"{one.__name__}.{item.identifier}"
            yield LABEL, item.name, place
            yield TIP, item.description, place
            for choice in getattr(item, "enum_items_static", ()):
                yield LABEL, choice.name, f"{place}.{choice.identifier}"
                yield TIP, choice.description, f"{place}.{choice.identifier}"


def classes() -> Iterator[type]:
    """Yields the registered classes of the add-on."""
    todo, seen = list(_BASES), set()
    while todo:
        one = todo.pop()
        if one in seen:
            continue
        seen.add(one)
        todo += one.__subclasses__()
        if one.__module__.startswith(PACKAGE) and getattr(one, "is_registered", False):
            yield one


def presets() -> Iterator[tuple[str, str, str]]:
    """Yields the labels of the presets that come with the add-on."""
    for path in (ADDON / "presets").rglob("*.py"):
        yield (
            LABEL,
            bpy.path.display_name(path.name, title_case=False),
            str(path.relative_to(ADDON)),
        )


def written() -> Iterator[tuple[str, str, str]]:
    """Yields the texts that the add-on's code draws and reports."""
    for node, place in nodes():
        for text in _texts(node):
            yield TEXT, text, place
        if isinstance(node, ast.Call) and _name(node) in _BUTTONS and not _WIDE.match(place):
            yield from ((BUTTON, text, place) for one in _drawn(node) for text in _constants(one))


def untranslated() -> Iterator[str]:
    """Yields the places where code composes or shows a sentence without `tr`."""
    for node, place in nodes():
        if not isinstance(node, ast.Call):
            continue
        said = [one for one in _drawn(node) if isinstance(one, ast.JoinedStr)]
        if getattr(node.func, "attr", "") in _SAYING:
            said += [one for one in node.args if isinstance(one, (ast.Constant, ast.JoinedStr))]
        if _name(node) == "Outcome":
            said += [one for one in node.args if isinstance(one, ast.JoinedStr)]
        if any(letter.isalpha() for one in said for text in _parts(one) for letter in text):
            yield place


def nodes() -> Iterator[tuple[ast.AST, str]]:
    """Yields the syntax nodes of the add-on's code, with file and line."""
    for path in (*sorted(ADDON.rglob("*.py")), *sorted(SHARED.rglob("*.py"))):
        place = path.relative_to(ADDON if path.is_relative_to(ADDON) else SHARED.parent)
        if place.parts[0] == "presets":
            continue
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            yield node, f"{place.as_posix()}:{getattr(node, 'lineno', 0)}"


def _texts(node: ast.AST) -> Iterator[str]:
    if isinstance(node, ast.Call):
        if _name(node) in _TRANSLATED and not isinstance(node.func, ast.Attribute):
            yield from _constants(node.args[0])
        if _name(node) in {"counted", "amount"} and len(node.args) > 1:
            for noun in _constants(node.args[1]):
                for text in _COUNTED + (_SCALED if _name(node) == "amount" else ()):
                    yield text.format(noun)
        for one in _drawn(node):
            yield from _constants(one)
    elif isinstance(node, ast.Assign) and _target(node) == "text":
        yield from _constants(node.value)
    elif isinstance(node, ast.ClassDef):
        for line in node.body:
            if isinstance(line, ast.Assign) and _target(line) in _SAID:
                yield from _constants(line.value)


def _drawn(call: ast.Call) -> Iterator[ast.expr]:
    """Yields the arguments of a call that Blender draws."""
    name = _name(call)
    if name in _DRAWING and len(call.args) > _DRAWING[name]:
        yield call.args[_DRAWING[name]]
    if isinstance(call.func, ast.Attribute) and name not in {"argument", "add_argument"}:
        yield from (one.value for one in call.keywords if one.arg in _DRAWN)


def _target(assignment: ast.Assign) -> str:
    return str(getattr(assignment.targets[0], "id", ""))


def _name(call: ast.Call) -> str:
    return str(getattr(call.func, "id", getattr(call.func, "attr", "")))


def _constants(node: ast.AST) -> Iterator[str]:
    """Yields the texts that an expression may be."""
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        yield node.value
    elif isinstance(node, ast.IfExp):
        yield from _constants(node.body)
        yield from _constants(node.orelse)


def _parts(node: ast.AST) -> Iterator[str]:
    """Yields the texts in an expression."""
    for one in node.values if isinstance(node, ast.JoinedStr) else [node]:
        if isinstance(one, ast.Constant) and isinstance(one.value, str):
            yield one.value


def _own_properties(one: type, rna: bpy.types.Struct) -> Iterator[bpy.types.Property]:
    """Yields the properties of a class that Blender shows."""
    inherited = {"name", *bpy.types.AddonPreferences.bl_rna.properties.keys()}
    for item in rna.properties:
        # Properties for internal use have no name, so Blender gives them the identifier.
        if item.name != item.identifier and item.identifier not in inherited:
            yield item


def _rna(one: type) -> bpy.types.Struct:
    if issubclass(one, bpy.types.Operator):
        module, _, name = one.bl_idname.partition(".")
        return getattr(getattr(bpy.ops, module), name).get_rna_type()
    return one.bl_rna


def main() -> None:
    """Writes the tables."""
    translations = importlib.import_module(f"{PACKAGE}.core.translations")
    texts = shown()
    for language in translations.LANGUAGES:
        path = ADDON / "translations" / f"{language}.json"
        before = json.loads(path.read_text(encoding="utf-8"))
        header = {translations.HEADER: before.pop(translations.HEADER)}
        after = {text: before.get(text, "") for text in sorted(texts)}
        table = json.dumps(header | after, ensure_ascii=False, indent=0)
        path.write_text(f"{table}\n", encoding="utf-8")
        empty = [text for text, translated in after.items() if not translated]
        print(f"{path}: {len(empty)} to translate, {len(before.keys() - texts)} removed")
        sys.stdout.writelines(f"  {text!r} ({texts[text][0]})\n" for text in empty)


if __name__ == "__main__":
    main()
