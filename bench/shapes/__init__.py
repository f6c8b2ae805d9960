# SPDX-License-Identifier: GPL-3.0-or-later

"""Shapes to images: time, memory and error beside other rasterizers."""
