# SPDX-License-Identifier: GPL-3.0-or-later

"""Seeing sampling tables: a plane with the image on it, read trilinearly and by a table."""

from ...core.registration import registration
from . import kept, overlay, state

register, unregister = registration(state, kept, overlay)
