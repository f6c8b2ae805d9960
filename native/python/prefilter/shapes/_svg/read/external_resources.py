# SPDX-License-Identifier: GPL-3.0-or-later

"""What addresses in a drawing lead to: data in themselves, and files in the drawing's folder."""

import base64
import binascii
from dataclasses import dataclass
from pathlib import Path, PureWindowsPath
from urllib.parse import unquote, unquote_to_bytes, urlsplit


class UnusableError(Exception):
    """What an address leads to cannot be used; the message says why."""


class ElsewhereError(Exception):
    """What others may show; the message says why it is not read here."""


@dataclass(frozen=True, slots=True)
class Place:
    """Where addresses lead from.

    Attributes:
        root: The folder of the drawing: nothing outside of it is read.
        folder: Where relative addresses begin: that of the file that they stand in.
    """

    root: Path
    folder: Path


def read_address(address: str, place: Place | None, most_bytes: int) -> tuple[bytes, Path | None]:
    """The bytes that an address leads to, and the file that they are in, if they are in one.

    Args:
        address: As it stands in the file; not empty.
        place: Where it leads from; None where no files are read.
        most_bytes: How large a file may be.

    Raises:
        ElsewhereError: It leads to another computer, or out of the folder.
        UnusableError: There is no such file, or it is too large, or the data are damaged.
    """
    if address[:5].lower() == "data:":
        return _embedded(address), None
    try:
        parts = urlsplit(address)
    except ValueError:
        raise UnusableError("as its address is damaged") from None
    name = unquote(parts.path)
    # Windows tells of no file, and that by a name with a zero in it.
    if "\0" in name:
        raise UnusableError("as its address is damaged")
    # Asking Windows for a path such as //computer/folder would ask that computer.
    if parts.scheme or parts.netloc or PureWindowsPath(name).drive:
        raise ElsewhereError("as it is neither in the file nor in its folder")
    if place is None:
        raise ElsewhereError("as it is not in the file, and that has no folder")
    try:
        path = (place.folder / name).resolve()
        if not path.is_relative_to(place.root.resolve()):
            raise ElsewhereError("as it is neither in the file nor in its folder")
        if not path.is_file():
            raise UnusableError(f"as there is no file '{name[:100]}'")
        if path.stat().st_size > most_bytes:
            raise UnusableError(f"as it is larger than {most_bytes >> 20} MiB")
        return path.read_bytes(), path
    except (OSError, ValueError) as error:
        raise UnusableError(f"as it cannot be read: {error}") from None


def _embedded(address: str) -> bytes:
    """The bytes that an address `data:` holds. Raises UnusableError where these are damaged."""
    head, comma, body = address[5:].partition(",")
    if not comma:
        raise UnusableError("as its data are damaged")
    data = unquote_to_bytes(body)
    if head.strip().lower().endswith("base64"):
        try:
            data = base64.b64decode(b"".join(data.split()))
        except binascii.Error:
            raise UnusableError("as its data are damaged") from None
    return data
