# SPDX-License-Identifier: GPL-3.0-or-later

"""Markup, style sheets and files, read into elements with their styles."""
