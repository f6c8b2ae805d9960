# SPDX-License-Identifier: GPL-3.0-or-later

"""Where a user finds mipmaps: the Image and UV editors, the 3D view."""

from ...core.registration import registration
from . import image_editor, model, on_model, seeing

register, unregister = registration(image_editor, model, on_model, seeing)
