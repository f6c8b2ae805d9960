# SPDX-License-Identifier: GPL-3.0-or-later

"""Occupancy octrees and grids: voxelization, files, and surfaces."""
