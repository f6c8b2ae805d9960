# SPDX-License-Identifier: GPL-3.0-or-later

"""Triangle meshes: surfaces with UVs, charts, measures, nearest points, closed and solid meshes."""
