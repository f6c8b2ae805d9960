# SPDX-License-Identifier: GPL-3.0-or-later

"""Declarations of all options that users can set.

Blender's properties and the flags of both command lines derive from them.
"""
