# SPDX-License-Identifier: GPL-3.0-or-later

"""Shader source, in GLSL, HLSL and OSL, that samples textures by a table."""
