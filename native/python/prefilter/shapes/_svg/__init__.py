# SPDX-License-Identifier: GPL-3.0-or-later

"""What reading SVG takes: XML by expat, style sheets and values by tinycss2 and cssselect2."""
