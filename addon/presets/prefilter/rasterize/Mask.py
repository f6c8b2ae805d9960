# SPDX-License-Identifier: GPL-3.0-or-later

import bpy

settings = bpy.context.scene.prefilter_rasterize

settings.color = "mask"
settings.background = "transparent"
settings.overlap = "cover"
settings.pixel_type = "byte"
