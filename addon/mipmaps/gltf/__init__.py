# SPDX-License-Identifier: GPL-3.0-or-later

"""Fitted mipmaps in what Blender's own glTF exporter writes."""
