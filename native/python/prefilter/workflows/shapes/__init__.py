# SPDX-License-Identifier: GPL-3.0-or-later

"""Rasterizing vector shapes."""
