# SPDX-License-Identifier: GPL-3.0-or-later

import bpy

settings = bpy.context.scene.prefilter_resize

settings.filter = "lanczos3"
settings.use_constrained = True
settings.wrap = "repeat"
