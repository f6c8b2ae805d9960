# SPDX-License-Identifier: GPL-3.0-or-later

"""Hexadecimal colors of the command line."""

from prefilter.options.colors import Color, from_hex, to_hex

__all__ = ("Color", "from_hex", "to_hex")
