# SPDX-License-Identifier: GPL-3.0-or-later

"""XML documents, parsed by expat within limits that exceed all honest files."""

import os
import re
import zlib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, TypeAlias
from xml.etree.ElementTree import Element
from xml.parsers import expat

from ...._border.input import as_path, open_file

SVG = "http://www.w3.org/2000/svg"
XLINK_HREF = "{http://www.w3.org/1999/xlink}href"
_SHEETS = ("style", "{http://www.w3.org/1999/xhtml}link")
_ATTRIBUTE = re.compile(r"([\w-]+)\s*=\s*(?:\"([^\"]*)\"|'([^']*)')")

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

MAX_DEPTH = 256
MAX_ELEMENTS = 250_000
MAX_ATTRIBUTES = 2_000_000
MAX_UNPACKED = 1 << 26
# Characters of an attribute, and of all text and style sheets together. Parsed values take many
# times that memory, except for a few attributes. Attributes of other namespaces are unlimited.
MAX_VALUE = 1 << 18
MAX_TEXT = 1 << 25
_MAX_VALUES = {"points": 1 << 24, **dict.fromkeys(("d", "href", XLINK_HREF), MAX_UNPACKED)}
_TEXT_AT_ONCE = 1 << 20
_UNPACKED_AT_ONCE = 1 << 20
# Clearer words for some errors of expat.
_WORDS = {
    expat.errors.codes[expat.errors.XML_ERROR_NO_ELEMENTS]: "the file ends in the middle",
    expat.errors.codes[expat.errors.XML_ERROR_INVALID_TOKEN]: "not well-formed XML",
    expat.errors.codes[expat.errors.XML_ERROR_SYNTAX]: "XML does not begin like that",
}
# Characters that entities may add to a file. Expat has such a limit only since 2.4.
_MAX_EXPANDED = 1 << 24
_ELEMENTS_PER_REPORT = 1000


Chunks: TypeAlias = Callable[[], Iterator[bytes]]
"""Returns the bytes of a file in chunks, at each call from the start."""


class _RefusedError(Exception):
    """Well-formed XML beyond a limit; the message says where."""


class SvgElement(Element):
    """An element with its line and parent. Tags of the SVG namespace have no prefix."""

    line = 0
    parent: "SvgElement | None" = None

    @property
    def address(self) -> str:
        """The value of `href` or `xlink:href`; empty if missing."""
        return self.get("href", self.get(XLINK_HREF, "")).strip()

    @property
    def href(self) -> str:
        """The id that `href` refers to in this file; empty if none."""
        target = self.address
        return target[1:] if target.startswith("#") else ""


class Document:
    """The elements of a file.

    Attributes:
        name: The file's name in messages.
        folder: The file's folder; None for markup.
        ids: Elements by id; the first wins.
        count: Number of elements.
        sheets: `style` and `link` elements.
        linked_sheets: Attributes and lines of `xml-stylesheet` instructions.
    """

    def __init__(
        self, parts: Chunks, name: str, encoding: str | None, report: Callable[[float], None]
    ) -> None:
        self.name = name
        self.folder: Path | None = None
        self.ids: dict[str, SvgElement] = {}
        self.count = 0
        self.sheets: list[SvgElement] = []
        self.linked_sheets: list[tuple[dict[str, str], int]] = []
        self._open: list[SvgElement] = []
        self._texts = 0
        self._attributes_left = MAX_ATTRIBUTES
        self._text_left = MAX_TEXT
        self._root: SvgElement | None = None
        self._references = sum(part.count(b"&") for part in parts())
        self._size = max(sum(map(len, parts())), 1)
        self._report = report
        parser = expat.ParserCreate(encoding, "}")
        self._parser = parser
        parser.buffer_text = True
        parser.buffer_size = _TEXT_AT_ONCE
        parser.StartElementHandler = self._start
        parser.EndElementHandler = self._end
        parser.CharacterDataHandler = self._text
        parser.EntityDeclHandler = self._entity
        parser.ProcessingInstructionHandler = self._instruction
        try:
            for part in parts():
                parser.Parse(part, False)
            parser.Parse(b"", True)
        except expat.ExpatError as error:
            what = _WORDS.get(error.code, expat.ErrorString(error.code))
            raise ValueError(
                f"{name}, line {error.lineno}, column {error.offset + 1}: {what}"
            ) from None
        except _RefusedError as error:
            raise ValueError(str(error)) from None
        except (LookupError, ValueError) as error:
            raise ValueError(f"{name}: its encoding cannot be read: {error}") from None
        if self._root is None or self._root.tag != "svg":
            tag = "nothing" if self._root is None else f"<{self._root.tag}>"
            raise ValueError(f"{name}: no SVG drawing: found {tag} for the outermost element")
        self.root: SvgElement = self._root

    def _start(self, name: str, attributes: dict[str, str]) -> None:
        line = self._parser.CurrentLineNumber
        if len(self._open) >= MAX_DEPTH:
            raise _RefusedError(
                f"{self.name}, line {line}: elements are nested more than {MAX_DEPTH} deep"
            )
        space, _, local = name.rpartition("}")
        tag = local if space in ("", SVG) else "{" + name
        element = SvgElement(
            tag, {("{" + key if "}" in key else key): value for key, value in attributes.items()}
        )
        element.line = line
        self._count(element)
        if self._open:
            element.parent = self._open[-1]
            self._open[-1].append(element)
        else:
            self._root = element
        self._open.append(element)
        self._texts += element.tag == "text"
        if tag in _SHEETS:
            self.sheets.append(element)
        if "id" in element.attrib:
            self.ids.setdefault(element.attrib["id"], element)
        if self.count % _ELEMENTS_PER_REPORT == 0:
            self._report(self._parser.CurrentByteIndex / self._size)

    def _count(self, element: SvgElement) -> None:
        """Counts an element and its attributes. Raises _RefusedError at a limit."""
        self.count += 1
        if self.count > MAX_ELEMENTS:
            raise self._refused(f"more than {MAX_ELEMENTS} elements")
        self._attributes_left -= len(element.attrib)
        if self._attributes_left < 0:
            raise self._refused(f"more than {MAX_ATTRIBUTES} attributes")
        for name, value in element.attrib.items():
            most = _MAX_VALUES.get(name, MAX_VALUE)
            if len(value) > most and (not name.startswith("{") or name in _MAX_VALUES):
                raise self._refused(
                    f"the attribute '{name[:40]}' has {len(value)} characters; at most {most} are "
                    "read"
                )

    def _refused(self, what: str) -> _RefusedError:
        return _RefusedError(f"{self.name}, line {self._parser.CurrentLineNumber}: {what}")

    def _end(self, name: str) -> None:
        self._texts -= self._open.pop().tag == "text"

    def _text(self, text: str) -> None:
        if not self._open or not (self._texts or self._open[-1].tag == "style"):
            return
        self._text_left -= len(text)
        if self._text_left < 0:
            raise self._refused(f"more than {MAX_TEXT} characters of text and style sheets")
        element = self._open[-1]
        if len(element):
            element[-1].tail = (element[-1].tail or "") + text
        else:
            element.text = (element.text or "") + text

    def _entity(self, name: str, parameter: bool, value: str | None, *rest: Any) -> None:
        if value is None:
            return  # External entities stay empty.
        if "&" in value or "%" in value or len(value) * self._references > _MAX_EXPANDED:
            raise _RefusedError(
                f"{self.name}, line {self._parser.CurrentLineNumber}: the entity '{name}' would "
                "make the file too large"
            )

    def _instruction(self, target: str, data: str) -> None:
        if target == "xml-stylesheet" and self._root is None:
            attributes = {name: one or other for name, one, other in _ATTRIBUTE.findall(data)}
            self.linked_sheets.append((attributes, self._parser.CurrentLineNumber))


def read_document(
    source: str | os.PathLike[str] | bytes, report: Callable[[float], None]
) -> Document:
    """Reads a file, plain or compressed, or markup. See `prefilter.read_svg`."""
    encoding = folder = None
    if isinstance(source, str) and source.lstrip("\ufeff \t\r\n").startswith("<"):
        # A str is no longer in the encoding that the markup declares.
        data, name, encoding = source.lstrip("\ufeff").encode("utf-8", "replace"), "source", "utf-8"
    elif isinstance(source, bytes | bytearray | memoryview):
        data, name = bytes(source), "source"
    elif isinstance(source, str | os.PathLike):
        try:
            path = as_path(source)
        except ValueError as error:
            raise ValueError(f"source{str(error).removeprefix('path')}") from None
        name, folder = f"'{path}'", Path(os.fsdecode(path)).parent
        with open_file(path) as file:
            data = file.read()
    else:
        raise ValueError(f"source: {source!r}; a path, markup, or bytes are needed")

    def parts() -> Iterator[bytes]:
        return decompress(data, name) if data[:2] == b"\x1f\x8b" else iter((data,))

    if not any(part.strip() for part in parts()):
        raise ValueError(f"{name} is empty")
    document = Document(parts, name, encoding, report)
    document.folder = folder
    return document


def decompress(data: bytes, name: str) -> Iterator[bytes]:
    """Yields decompressed chunks: a small file may expand without bound.

    Raises:
        ValueError: The result exceeds `MAX_UNPACKED`, or the data are damaged.
    """
    unpacker = zlib.decompressobj(wbits=31)
    count = 0
    while not unpacker.eof:
        try:
            part = unpacker.decompress(data, _UNPACKED_AT_ONCE)
        except zlib.error:
            raise ValueError(f"{name}: compressed, and damaged") from None
        data = unpacker.unconsumed_tail
        count += len(part)
        if count > MAX_UNPACKED:
            raise ValueError(f"{name}: more than {MAX_UNPACKED >> 20} MiB when unpacked")
        if not part and not unpacker.eof:
            raise ValueError(f"{name}: compressed, and ends early")
        yield part
