# SPDX-License-Identifier: GPL-3.0-or-later

"""Seeing mipmaps: levels drawn in the editor, their errors as a figure, the weights of texels."""

from ...core.registration import registration
from . import on_model, overlay, preview, state, wipe

register, unregister = registration(state, preview, overlay, on_model, wipe)
