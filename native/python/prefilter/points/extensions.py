# SPDX-License-Identifier: GPL-3.0-or-later

"""File name extensions of points; imports nothing, as Blender needs them at every start."""

POINT_EXTENSIONS = (
    *(".ply", ".pcd", ".pts", ".xyz", ".xyzn", ".asc", ".txt", ".csv", ".ptx", ".obj"),
    *(".ply.gz", ".las", ".laz", ".e57"),
)
"""File name extensions that `read_points` accepts; the library opens those of the first line."""
