# SPDX-License-Identifier: GPL-3.0-or-later

"""Voxelizing meshes, and extracting surfaces."""
