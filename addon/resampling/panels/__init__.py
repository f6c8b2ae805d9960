# SPDX-License-Identifier: GPL-3.0-or-later

"""Where a user finds the operators: sidebars, and Image > Prefilter."""

from ...core.registration import registration
from . import plane, resample, resize, sampling_table

register, unregister = registration(resample, resize, plane, sampling_table)
