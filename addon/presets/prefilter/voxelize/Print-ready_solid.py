# SPDX-License-Identifier: GPL-3.0-or-later

import bpy

settings = bpy.context.scene.prefilter_voxelize

settings.resolution = "depth"
settings.depth = 9
settings.interpolant = "sharp"
settings.faces = "triangles"
settings.adaptivity = 0.1
settings.thickness = 2.0
settings.gap = 2.0
settings.use_close_holes = True
settings.holes = "smooth"
settings.use_cleanup = True
