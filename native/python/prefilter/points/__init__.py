# SPDX-License-Identifier: GPL-3.0-or-later

"""Oriented points: files of scans, normals, and surfaces of them."""
