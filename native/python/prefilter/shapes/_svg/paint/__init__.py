# SPDX-License-Identifier: GPL-3.0-or-later

"""Paints, clips, masks, markers and images of elements."""
