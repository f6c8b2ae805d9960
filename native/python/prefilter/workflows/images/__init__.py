# SPDX-License-Identifier: GPL-3.0-or-later

"""Resizing and resampling pictures, and making sampling tables."""
