# SPDX-License-Identifier: GPL-3.0-or-later

"""The panels on mipmaps, in the Image and UV editors and the 3D view."""

from ...core.registration import registration
from . import image_editor, inspection, model, on_model

register, unregister = registration(image_editor, model, on_model, inspection)
