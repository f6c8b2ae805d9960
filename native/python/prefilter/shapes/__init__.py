# SPDX-License-Identifier: GPL-3.0-or-later

"""Vector shapes: rasterization, and SVG drawings."""
