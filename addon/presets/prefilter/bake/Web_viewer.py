# SPDX-License-Identifier: GPL-3.0-or-later

import bpy

settings = bpy.context.scene.prefilter_bake

settings.result = "file"
settings.file_format = "ktx2"
settings.filter = "pam-bilinear"
settings.reader = "linear"
settings.lookups = "one-lookup"
settings.texture_format = "uastc"
settings.supercompression = "zstd"
