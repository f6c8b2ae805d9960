# SPDX-License-Identifier: GPL-3.0-or-later

"""What users may set, each option declared once.

Blender's properties, and the flags of both commands, are made of these declarations.
"""
