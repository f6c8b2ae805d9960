# SPDX-License-Identifier: GPL-3.0-or-later

"""Meshes to cells, and cells to a surface."""
