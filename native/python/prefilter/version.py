# SPDX-License-Identifier: GPL-3.0-or-later

"""The version of the package; also that of the extension."""

from ._native import VERSION

__all__ = ["VERSION"]
