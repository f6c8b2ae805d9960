# SPDX-License-Identifier: GPL-3.0-or-later

"""SVG drawings: from a file to a tree, and from the tree to shapes or to pixels.

Folders, from the bottom up; each imports only those above it in this list:

- `model`: the tree of outlines, images and groups, and values: lengths, colors, transforms.
- `read`: XML, style sheets, referenced files, and the context in which an element is read.
- `text`: characters, fonts and glyphs, laid out as outlines.
- `paint`: fill and stroke, patterns, clip paths, masks, markers and images of elements.
- `filters`: filter elements read into steps, and steps applied to pixels.
- `draw`: documents made into trees, and trees made into shapes or images.

Units: attributes and outlines are in user units of their element, with y downwards. `matrix` of an
item in the tree leads from these to user units of the root `svg` (CSS pixels if it has no
`viewBox`); boxes and clips are in the latter. Only `draw` and the modules of `filters` that work on
layers use pixels of the image, with y upwards, row 0 at the bottom, and colors premultiplied.

XML is parsed by expat, CSS by tinycss2 and cssselect2, fonts by fontTools.
"""
