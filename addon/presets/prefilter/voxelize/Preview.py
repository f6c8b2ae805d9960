# SPDX-License-Identifier: GPL-3.0-or-later

import bpy

settings = bpy.context.scene.prefilter_voxelize

settings.resolution = "depth"
settings.depth = 6
settings.interpolant = "plane"
settings.faces = "triangles"
settings.adaptivity = 0.0
settings.use_cleanup = False
