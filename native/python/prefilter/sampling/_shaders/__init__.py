# SPDX-License-Identifier: GPL-3.0-or-later

"""Shader source that samples textures by a table: GLSL, HLSL and OSL with the table's numbers."""
