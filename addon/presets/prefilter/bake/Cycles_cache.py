# SPDX-License-Identifier: GPL-3.0-or-later

import bpy

settings = bpy.context.scene.prefilter_bake

settings.result = "file"
settings.file_format = "tx"
settings.filter = "pam-bilinear"
settings.reader = "srgb-after"
settings.lookups = "supersampled"
settings.texture_format = "auto"
settings.supercompression = "none"
