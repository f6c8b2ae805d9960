# SPDX-License-Identifier: GPL-3.0-or-later

"""Text, laid out as outlines of glyphs."""
