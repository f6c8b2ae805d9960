# SPDX-License-Identifier: GPL-3.0-or-later

"""Panels in sidebars, and entries in Image > Prefilter."""

from ...core.registration import registration
from . import plane, resample, resize, sampling_table

register, unregister = registration(resample, resize, plane, sampling_table)
