# SPDX-License-Identifier: GPL-3.0-or-later

"""Blender <-> numpy: the only place that touches image, mesh and node buffers.

Bad input raises ValueError, a file that cannot be written raises OSError; both name what was found.
"""
