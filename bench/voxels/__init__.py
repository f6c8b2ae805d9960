# SPDX-License-Identifier: GPL-3.0-or-later

"""Meshes to voxels, and voxels to meshes."""
