# SPDX-License-Identifier: GPL-3.0-or-later

import bpy

settings = bpy.context.scene.prefilter_voxelize

settings.resolution = "depth"
settings.depth = 7
settings.interpolant = "sharp"
settings.faces = "triangles"
settings.adaptivity = 0.5
settings.use_close_holes = True
settings.holes = "smooth"
settings.use_cleanup = True
settings.use_materials = True
settings.use_uv_maps = True
settings.use_colors = True
settings.use_attributes = True
settings.use_smooth_shading = True
