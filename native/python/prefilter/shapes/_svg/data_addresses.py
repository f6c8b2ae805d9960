# SPDX-License-Identifier: GPL-3.0-or-later

"""Addresses that hold what they refer to."""

import base64
import binascii
from urllib.parse import unquote_to_bytes


class UnusableError(Exception):
    """What an address leads to cannot be used; the message says why."""


def embedded(address: str) -> bytes:
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
