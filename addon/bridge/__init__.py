# SPDX-License-Identifier: GPL-3.0-or-later

"""Conversion between Blender's datablocks and numpy; only this package uses their buffers.

Bad input raises ValueError, a file that cannot be written OSError.
"""
