# SPDX-License-Identifier: GPL-3.0-or-later

"""Occupancy octrees and grids: what they are made of, their files, and surfaces of them."""
