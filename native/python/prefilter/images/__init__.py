# SPDX-License-Identifier: GPL-3.0-or-later

"""Images: mipmaps, color encodings, resizing, and the texels that surfaces use."""
