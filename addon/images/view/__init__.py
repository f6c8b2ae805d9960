# SPDX-License-Identifier: GPL-3.0-or-later

"""Drawing in the Image editor: the preview plane, and the corners that are dragged."""

from ...core.registration import registration
from . import overlay, pins, plane, state, wipe

register, unregister = registration(state, plane, overlay, pins, wipe)
