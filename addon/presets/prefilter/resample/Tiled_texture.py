# SPDX-License-Identifier: GPL-3.0-or-later

import bpy

settings = bpy.context.scene.prefilter_resample

settings.method = "exact"
settings.filter = "lanczos2"
settings.wrap = "repeat"
