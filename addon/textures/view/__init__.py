# SPDX-License-Identifier: GPL-3.0-or-later

"""Display of mipmaps: levels drawn in editors, their errors as a figure, texel weights."""

from ...core.registration import registration
from . import on_model, overlay, preview, state, wipe

register, unregister = registration(state, preview, overlay, on_model, wipe)
