# SPDX-License-Identifier: GPL-3.0-or-later

"""What the add-on and the command do alike, with pictures as arrays and no Blender."""
