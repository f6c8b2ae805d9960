# SPDX-License-Identifier: GPL-3.0-or-later

"""Fonts, read by fontTools: folders, selection by family and style, shaping, and glyphs."""
