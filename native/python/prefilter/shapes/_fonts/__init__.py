# SPDX-License-Identifier: GPL-3.0-or-later

"""Fonts: where they are, which one a text asks for, and their glyphs, read by fontTools."""
