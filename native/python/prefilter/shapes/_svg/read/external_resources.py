# SPDX-License-Identifier: GPL-3.0-or-later

"""Resources that a drawing refers to: data addresses, and files in its folder."""

import base64
import binascii
from dataclasses import dataclass
from pathlib import Path, PureWindowsPath
from urllib.parse import unquote, unquote_to_bytes, urlsplit


class UnusableError(Exception):
    """A resource is missing or damaged; the message says why."""


class NotLocalError(Exception):
    """A resource outside the drawing's folder, which is not read; the message says why."""


@dataclass(frozen=True, slots=True)
class BaseFolder:
    """Folders for resolving addresses.

    Attributes:
        root: The drawing's folder; files outside it are not read.
        folder: The folder of the file with the address; relative addresses start here.
    """

    root: Path
    folder: Path


def read_address(
    address: str, base: BaseFolder | None, max_bytes: int
) -> tuple[bytes, Path | None]:
    """Reads a resource; returns its bytes, and its path if it is a file.

    Args:
        address: The address as written; not empty.
        base: Folders to resolve it; None if no files are read.
        max_bytes: Size limit of a file.

    Raises:
        ElsewhereError: NotLocalError: The address leads to another computer, or out of the folder.
        UnusableError: The file is missing or too large, or the data are damaged.
    """
    if address[:5].lower() == "data:":
        return _decode_data(address), None
    try:
        parts = urlsplit(address)
    except ValueError:
        raise UnusableError("as its address is damaged") from None
    name = unquote(parts.path)
    # Windows reports names with a null character as missing files.
    if "\0" in name:
        raise UnusableError("as its address is damaged")
    # On Windows, resolving a path such as //computer/folder contacts that computer.
    if parts.scheme or parts.netloc or PureWindowsPath(name).drive:
        raise NotLocalError("as it is neither in the file nor in its folder")
    if base is None:
        raise NotLocalError("as it is not in the file, and that has no folder")
    try:
        path = (base.folder / name).resolve()
        if not path.is_relative_to(base.root.resolve()):
            raise NotLocalError("as it is neither in the file nor in its folder")
        if not path.is_file():
            raise UnusableError(f"as there is no file '{name[:100]}'")
        if path.stat().st_size > max_bytes:
            raise UnusableError(f"as it is larger than {max_bytes >> 20} MiB")
        return path.read_bytes(), path
    except (OSError, ValueError) as error:
        raise UnusableError(f"as it cannot be read: {error}") from None


def _decode_data(address: str) -> bytes:
    """Decodes a `data:` address. Raises UnusableError if it is damaged."""
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
