# SPDX-License-Identifier: GPL-3.0-or-later

import bpy

settings = bpy.context.scene.prefilter_reconstruct

settings.resolution = "depth"
settings.depth = 10
settings.wavelet = "haar"
settings.use_smooth = True
settings.use_fit = True
settings.use_watertight = True
settings.trim = 0.0
settings.isovalue = "auto"
settings.points = "hide"
