# SPDX-License-Identifier: GPL-3.0-or-later

"""The rules of style sheets: those in a drawing, and in files beside it."""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import cssselect2
import tinycss2

from ..model.limits import TooLargeError
from ..model.values import url_of
from ..model.warnings import Warnings
from .document import Document, SvgElement
from .external_resources import ElsewhereError, Place, UnusableError, read_address
from .media_queries import holds_for_screens
from .text_style import FontRule

MOST_BYTES = 1 << 22
"""Of all style sheets in files, together; sheets that are read again count again."""
MOST_WRITTEN = 1 << 22
"""Characters of all style sheets in a drawing, but for quoted texts and addresses, which may hold
whole fonts."""
_QUOTED = re.compile(r"url\([^)]*\)|\"[^\"]*\"|'[^']*'", re.IGNORECASE)
MOST_IMPORTED = 16
"""Style sheets that import each other."""
_LEAST_COUNTED = 1 << 10
# Parts of a selector, and functions in functions: each is a loop in the next.
_MOST_PARTS, _MOST_NESTED = 32, 8
_BEFORE_IMPORTS = ("charset", "layer")
_WITHOUT_RULES = ("charset", "keyframes", "-webkit-keyframes", "namespace")


@dataclass(frozen=True, slots=True)
class _Sheet:
    """Where rules stand.

    Attributes:
        line: Of the element or the reference that brought them, in the drawing.
        place: Where addresses in them lead from.
        files: Of the sheets that imported each other, from the first.
        is_here: Whether they are in the drawing itself, so that lines count from that one.
    """

    line: int
    place: Place | None
    files: tuple[Path, ...] = ()
    is_here: bool = False
    depth: int = 0

    def line_of(self, rule: Any) -> int:
        """Where a rule is, or what brought it."""
        return self.line + getattr(rule, "source_line", 1) - 1 if self.is_here else self.line


class StyleRules:
    """The rules of a document, in the order in which they count.

    Attributes:
        matcher: Finds those of an element, each with its declarations.
        font_rules: The rules `@font-face`.
        is_empty: Whether there is none for elements.
    """

    def __init__(self, document: Document, warnings: Warnings) -> None:
        self.matcher = cssselect2.Matcher()
        self.font_rules: list[FontRule] = []
        self.is_empty = True
        self._warnings = warnings
        self._left = MOST_BYTES
        self._written_left = MOST_WRITTEN
        folder = document.folder
        place = None if folder is None else Place(folder, folder)
        for said, line in document.linked_sheets:
            self._link("xml-stylesheet", said, _Sheet(line, place))
        for element in document.sheets:
            self._add_element(element, place)

    def _add_element(self, element: SvgElement, place: Place | None) -> None:
        sheet = _Sheet(element.line, place, is_here=True)
        if element.tag != "style":
            if "stylesheet" in element.get("rel", "").lower().split():
                self._link("<link>", element.attrib, sheet)
        elif _is_css(element.attrib) and self._holds(
            "<style>", element.get("media", ""), element.line
        ):
            text = element.text or ""
            self._written_left -= len(_QUOTED.sub("", text))
            if self._written_left < 0:
                raise TooLargeError(f"style sheets of more than {MOST_WRITTEN >> 20} MiB")
            self._add(tinycss2.parse_stylesheet(text, True, True), sheet)

    def _link(self, name: str, said: Mapping[str, str], sheet: _Sheet) -> None:
        """Adds the rules of a file that the drawing refers to."""
        is_other = said.get("alternate", "no") == "yes" or "alternate" in said.get("rel", "")
        is_css = _is_css(said) and not is_other
        if is_css and self._holds(name, said.get("media", ""), sheet.line):
            self._add_file(name, said.get("href", "").strip(), sheet)

    def _holds(self, name: str, query: str | Sequence[Any], line: int) -> bool:
        holds = holds_for_screens(query)
        if holds is None:
            text = query if isinstance(query, str) else tinycss2.serialize(query)
            self._warnings.unsupported(f"{name} for '{text.strip()[:60]}'", "ignored", line)
        return bool(holds)

    def _add_file(self, name: str, address: str, sheet: _Sheet) -> None:
        """Adds the rules that an address in a sheet leads to."""
        told = address if address[:5].lower() != "data:" else "data:"
        name = f"{name} '{told[:60]}'"
        try:
            if not address or address.startswith("#"):
                raise UnusableError("as it refers to no style sheet")
            data, path = read_address(address, sheet.place, MOST_BYTES)
            if path is not None and path in sheet.files:
                raise UnusableError("as it imports itself")
            if sheet.depth >= MOST_IMPORTED:
                raise UnusableError(f"as more than {MOST_IMPORTED} import each other")
            self._left -= max(len(data), _LEAST_COUNTED)
            if self._left < 0:
                raise UnusableError(
                    f"as style sheets are larger than {MOST_BYTES >> 20} MiB together"
                )
        except ElsewhereError as error:
            self._warnings.unsupported(name, f"ignored, {error}", sheet.line)
            return
        except UnusableError as error:
            self._warnings.broken(name, f"ignored, {error}", sheet.line)
            return
        place = None
        if path is not None and sheet.place is not None:
            place = Place(sheet.place.root, path.parent)
        files = sheet.files if path is None else (*sheet.files, path)
        rules, _ = tinycss2.parse_stylesheet_bytes(data, skip_comments=True, skip_whitespace=True)
        self._add(rules, _Sheet(sheet.line, place, files, depth=sheet.depth + 1))

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
            elif _takes_long(rule.prelude):
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
        declarations = tuple(declarations_in(rule.content))
        for selector in selectors:
            self.matcher.add_selector(selector, declarations)
        self.is_empty = False

    def _add_at_rule(self, rule: Any, line: int, sheet: _Sheet, may_import: bool) -> None:
        keyword = rule.lower_at_keyword
        if keyword == "font-face" and rule.content is not None:
            said = {name: value for name, value, _ in declarations_in(rule.content)}
            self.font_rules.append(FontRule(line, said, sheet.place))
        elif keyword == "media" and rule.content is not None:
            if self._holds("@media", rule.prelude, line):
                self._add(tinycss2.parse_rule_list(rule.content, True, True), sheet)
        elif keyword == "import":
            if may_import:
                self._import(rule, _Sheet(line, sheet.place, sheet.files, depth=sheet.depth))
            else:
                self._warnings.broken("@import", "ignored, as it follows other rules", line)
        elif keyword not in _WITHOUT_RULES:
            self._warnings.unsupported(f"@{keyword}", "ignored", line)

    def _import(self, rule: Any, sheet: _Sheet) -> None:
        tokens = [each for each in rule.prelude if each.type not in ("whitespace", "comment")]
        address = url_of(tokens[0]) if tokens else None
        if tokens and tokens[0].type == "string":
            address = tokens[0].value
        if address is None:
            self._warnings.broken("@import", "ignored, as it refers to no style sheet", sheet.line)
        elif self._holds("@import", tokens[1:], sheet.line):
            self._add_file("@import", address.strip(), sheet)


def _is_css(said: Mapping[str, str]) -> bool:
    return said.get("type", "text/css").strip().lower() in ("text/css", "")


def declarations_in(content: Any) -> Iterator[tuple[str, str, bool]]:
    """Yields names, values, and whether they are important, of the contents of a rule."""
    for node in tinycss2.parse_blocks_contents(content, True, True):
        if node.type == "declaration":
            # The case of variables counts.
            name = node.name if node.name.startswith("--") else node.lower_name
            yield name, tinycss2.serialize(node.value).strip(), node.important


def _takes_long(prelude: list[Any], depth: int = 0) -> bool:
    """Whether a selector looks at all siblings or descendants of elements, or has many parts."""
    parts = 0
    for before, token in zip([None, *prelude], prelude, strict=False):
        parts = 0 if token == "," else parts + (token.type == "whitespace" or token in (">", "+"))
        if token == "~" or parts > _MOST_PARTS or depth > _MOST_NESTED:
            return True
        if before == ":" and token.type == "ident" and token.lower_value.endswith("-of-type"):
            return True
        if token.type == "function" and token.lower_name not in ("not", "is", "where"):
            return True
        if token.type == "function" and _takes_long(token.arguments, depth + 1):
            return True
    return False
