# SPDX-License-Identifier: GPL-3.0-or-later

"""Rules of style sheets, in a drawing and in files that it refers to."""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import cssselect2
import tinycss2

from ..model.limits import TooLargeError
from ..model.values import parse_url
from ..model.warnings import Warnings
from .document import Document, SvgElement
from .external_resources import BaseFolder, NotLocalError, UnusableError, read_address
from .media_queries import matches_screen
from .text_style import FontRule

MAX_BYTES = 1 << 22
"""Bytes of all style sheet files together; a file counts each time it is read."""
MAX_CHARACTERS = 1 << 22
"""Characters of all style sheets in a drawing, without quoted texts and addresses, which may hold
entire fonts.
"""
_QUOTED = re.compile(r"url\([^)]*\)|\"[^\"]*\"|'[^']*'", re.IGNORECASE)
MAX_IMPORTED = 16
"""Largest depth of imports."""
_MIN_COUNTED_BYTES = 1 << 10
# Compounds of a selector, and depth of nested functions. Each is a loop within the next when
# matching.
_MAX_PARTS, _MAX_NESTED = 32, 8
_BEFORE_IMPORTS = ("charset", "layer")
_WITHOUT_RULES = ("charset", "keyframes", "-webkit-keyframes", "namespace")


@dataclass(frozen=True, slots=True)
class _Sheet:
    """Origin of rules.

    Attributes:
        line: Line in the drawing of the element or reference.
        base: Folders to resolve addresses.
        files: The chain of importing files.
        is_inline: Whether the rules are in the drawing itself, so that their lines count
            from `line`.
    """

    line: int
    base: BaseFolder | None
    files: tuple[Path, ...] = ()
    is_inline: bool = False
    depth: int = 0

    def line_of(self, rule: Any) -> int:
        """Returns the line of a rule, or of the reference to its file."""
        return self.line + getattr(rule, "source_line", 1) - 1 if self.is_inline else self.line


class StyleRules:
    """The style rules of a document, in cascading order.

    Attributes:
        matcher: Finds the declarations that apply to an element.
        is_empty: Whether no rule applies to elements.
    """

    def __init__(self, document: Document, warnings: Warnings) -> None:
        self.matcher = cssselect2.Matcher()
        self.font_rules: list[FontRule] = []
        self.is_empty = True
        self._warnings = warnings
        self._bytes_left = MAX_BYTES
        self._characters_left = MAX_CHARACTERS
        folder = document.folder
        base = None if folder is None else BaseFolder(folder, folder)
        for attrib, line in document.linked_sheets:
            self._link("xml-stylesheet", attrib, _Sheet(line, base))
        for element in document.sheets:
            self._add_element(element, base)

    def _add_element(self, element: SvgElement, base: BaseFolder | None) -> None:
        sheet = _Sheet(element.line, base, is_inline=True)
        if element.tag != "style":
            if "stylesheet" in element.get("rel", "").lower().split():
                self._link("<link>", element.attrib, sheet)
        elif _is_css(element.attrib) and self._matches(
            "<style>", element.get("media", ""), element.line
        ):
            text = element.text or ""
            self._characters_left -= len(_QUOTED.sub("", text))
            if self._characters_left < 0:
                raise TooLargeError(f"style sheets of more than {MAX_CHARACTERS >> 20} MiB")
            self._add(tinycss2.parse_stylesheet(text, True, True), sheet)

    def _link(self, name: str, attrib: Mapping[str, str], sheet: _Sheet) -> None:
        """Adds a linked style sheet."""
        is_other = attrib.get("alternate", "no") == "yes" or "alternate" in attrib.get("rel", "")
        is_css = _is_css(attrib) and not is_other
        if is_css and self._matches(name, attrib.get("media", ""), sheet.line):
            self._add_file(name, attrib.get("href", "").strip(), sheet)

    def _matches(self, name: str, query: str | Sequence[Any], line: int) -> bool:
        holds = matches_screen(query)
        if holds is None:
            text = query if isinstance(query, str) else tinycss2.serialize(query)
            self._warnings.unsupported(f"{name} for '{text.strip()[:60]}'", "ignored", line)
        return bool(holds)

    def _add_file(self, name: str, address: str, sheet: _Sheet) -> None:
        """Adds the style sheet at an address."""
        shown_address = address if address[:5].lower() != "data:" else "data:"
        name = f"{name} '{shown_address[:60]}'"
        try:
            if not address or address.startswith("#"):
                raise UnusableError("as it refers to no style sheet")
            data, path = read_address(address, sheet.base, MAX_BYTES)
            if path is not None and path in sheet.files:
                raise UnusableError("as it imports itself")
            if sheet.depth >= MAX_IMPORTED:
                raise UnusableError(f"as more than {MAX_IMPORTED} import each other")
            self._bytes_left -= max(len(data), _MIN_COUNTED_BYTES)
            if self._bytes_left < 0:
                raise UnusableError(
                    f"as style sheets are larger than {MAX_BYTES >> 20} MiB together"
                )
        except NotLocalError as error:
            self._warnings.unsupported(name, f"ignored, {error}", sheet.line)
            return
        except UnusableError as error:
            self._warnings.broken(name, f"ignored, {error}", sheet.line)
            return
        base = None
        if path is not None and sheet.base is not None:
            base = BaseFolder(sheet.base.root, path.parent)
        files = sheet.files if path is None else (*sheet.files, path)
        rules, _ = tinycss2.parse_stylesheet_bytes(data, skip_comments=True, skip_whitespace=True)
        self._add(rules, _Sheet(sheet.line, base, files, depth=sheet.depth + 1))

    def _add(self, rules: Iterable[Any], sheet: _Sheet) -> None:
        may_import = True
        for rule in rules:
            line = sheet.line_of(rule)
            if rule.type == "at-rule":
                self._add_at_rule(rule, line, sheet, may_import)
                may_import = may_import and rule.lower_at_keyword in (*_BEFORE_IMPORTS, "import")
                continue
            may_import = False
            if rule.type == "error":
                self._warnings.broken("style sheet", f"ignored a rule: {rule.message}", line)
            elif _is_slow_selector(rule.prelude):
                selector = tinycss2.serialize(rule.prelude).strip()
                self._warnings.unsupported(f"selector '{selector[:40]}'", "ignored", line)
            else:
                self._add_rule(rule, line)

    def _add_rule(self, rule: Any, line: int) -> None:
        try:
            selectors = cssselect2.compile_selector_list(rule.prelude)
        except cssselect2.SelectorError as error:
            self._warnings.broken("style sheet", f"ignored a rule: {error}", line)
            return
        declarations = tuple(read_declarations(rule.content))
        for selector in selectors:
            self.matcher.add_selector(selector, declarations)
        self.is_empty = False

    def _add_at_rule(self, rule: Any, line: int, sheet: _Sheet, may_import: bool) -> None:
        keyword = rule.lower_at_keyword
        if keyword == "font-face" and rule.content is not None:
            descriptors = {name: value for name, value, _ in read_declarations(rule.content)}
            self.font_rules.append(FontRule(line, descriptors, sheet.base))
        elif keyword == "media" and rule.content is not None:
            if self._matches("@media", rule.prelude, line):
                self._add(tinycss2.parse_rule_list(rule.content, True, True), sheet)
        elif keyword == "import":
            if may_import:
                self._import(rule, _Sheet(line, sheet.base, sheet.files, depth=sheet.depth))
            else:
                self._warnings.broken("@import", "ignored, as it follows other rules", line)
        elif keyword not in _WITHOUT_RULES:
            self._warnings.unsupported(f"@{keyword}", "ignored", line)

    def _import(self, rule: Any, sheet: _Sheet) -> None:
        tokens = [each for each in rule.prelude if each.type not in ("whitespace", "comment")]
        address = parse_url(tokens[0]) if tokens else None
        if tokens and tokens[0].type == "string":
            address = tokens[0].value
        if address is None:
            self._warnings.broken("@import", "ignored, as it refers to no style sheet", sheet.line)
        elif self._matches("@import", tokens[1:], sheet.line):
            self._add_file("@import", address.strip(), sheet)


def _is_css(attrib: Mapping[str, str]) -> bool:
    return attrib.get("type", "text/css").strip().lower() in ("text/css", "")


def read_declarations(content: Any) -> Iterator[tuple[str, str, bool]]:
    """Yields name, value and importance of the declarations in a rule."""
    for node in tinycss2.parse_blocks_contents(content, True, True):
        if node.type == "declaration":
            # Names of custom properties are case-sensitive.
            name = node.name if node.name.startswith("--") else node.lower_name
            yield name, tinycss2.serialize(node.value).strip(), node.important


def _is_slow_selector(prelude: list[Any], depth: int = 0) -> bool:
    """Returns whether matching a selector would visit all siblings or descendants, or has many
    compounds.
    """
    parts = 0
    for before, token in zip([None, *prelude], prelude, strict=False):
        parts = 0 if token == "," else parts + (token.type == "whitespace" or token in (">", "+"))
        if token == "~" or parts > _MAX_PARTS or depth > _MAX_NESTED:
            return True
        if before == ":" and token.type == "ident" and token.lower_value.endswith("-of-type"):
            return True
        if token.type == "function" and token.lower_name not in ("not", "is", "where"):
            return True
        if token.type == "function" and _is_slow_selector(token.arguments, depth + 1):
            return True
    return False
