# SPDX-License-Identifier: GPL-3.0-or-later

"""Seeing sampling tables on a plane with the image on it, and corners that are dragged."""

from ...core.registration import registration
from . import kept, overlay, pins, state, wipe

register, unregister = registration(state, kept, overlay, pins, wipe)
