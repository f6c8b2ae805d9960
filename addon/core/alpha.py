# SPDX-License-Identifier: GPL-3.0-or-later

"""Straight and associated alpha of texels."""

from prefilter.workflows.alpha import associated, at_most_opaque, unassociated

__all__ = ("associated", "at_most_opaque", "unassociated")
