# SPDX-License-Identifier: GPL-3.0-or-later

"""Colors as users of commands write them; the package reads them."""

from prefilter.options.colors import Color, from_hex, to_hex

__all__ = ("Color", "from_hex", "to_hex")
