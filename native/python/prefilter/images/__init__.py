# SPDX-License-Identifier: GPL-3.0-or-later

"""Images: their mipmaps, colors, sizes, and which of their texels are used."""
