# SPDX-License-Identifier: GPL-3.0-or-later

"""Textures and the levels that are made of them."""
