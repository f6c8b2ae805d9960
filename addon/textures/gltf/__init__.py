# SPDX-License-Identifier: GPL-3.0-or-later

"""Fitted mipmaps in files of Blender's glTF exporter, and KTX 2 files in its importer."""
