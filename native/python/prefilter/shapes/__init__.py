# SPDX-License-Identifier: GPL-3.0-or-later

"""Shapes in a plane: rasterized, and read from drawings."""
