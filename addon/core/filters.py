# SPDX-License-Identifier: GPL-3.0-or-later

"""The filters of the library as choices."""

from prefilter.options.filters import LABELS, filters_for

__all__ = ("LABELS", "filters_for")
