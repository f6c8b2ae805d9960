# SPDX-License-Identifier: GPL-3.0-or-later

"""Settings for rasterizing shapes."""

from dataclasses import dataclass

from .filters import filters_for
from .options import Choice, number, one_of, rgba, switch, text, threads

LARGEST_SIDE = 1 << 16

SOURCES = {
    "auto": Choice(
        "Automatic", "The selected curves and texts; without any, the UV map of the active mesh"
    ),
    "curves": Choice("Curves and Texts", "The areas that the selected curves and texts fill"),
    "uv": Choice(
        "UV Map", "A mask of the area that the faces of the active mesh cover in its UV map"
    ),
    "svg": Choice("SVG File", "The drawing in an SVG file"),
}
FILTERS = filters_for(
    "raster",
    {
        "box": "The exact share of each pixel that a shape covers",
        "tent": "Soft",
        "bspline2": "Softer",
        "gaussian": "Isotropic; softer",
        "mitchell": "A little softer than Box, with fewer stairs; little ringing",
        "lanczos2": "Sharper than Mitchell, with some ringing",
        "lanczos3": "Sharpest, with ringing around edges",
        "radial2": "Like Lanczos 2, but isotropic",
        "radial3": "Like Lanczos 3, but isotropic",
    },
)
RESOLUTIONS = {
    "side": Choice(
        "Longer Side", "As wide or as high as this, and the other side as the shapes have it"
    ),
    "size": Choice("Size", "An image of this size, into which the shapes are fitted"),
    "density": Choice("Pixels per Unit", "Fit the image to the shapes, plus the margin"),
}
VIEWS = {
    "object": Choice("Active Object", "Along the Z axis of the active object"),
    "top": Choice("Top", "Down along the Z axis of the world"),
    "front": Choice("Front", "Along the Y axis of the world"),
    "right": Choice("Right", "Against the X axis of the world"),
    "camera": Choice("Camera", "The view of the scene's camera, in its frame"),
}
COLORS = {
    "material": Choice(
        "Materials",
        "The base color and alpha of each material, white without one; the colors of an SVG file",
    ),
    "white": Choice("White", "White shapes"),
    "mask": Choice("Mask", "White shapes on black, without alpha, in the color space Non-Color"),
}
BACKGROUNDS = {
    "transparent": Choice("Transparent", "Nothing: alpha says how much of a pixel is covered"),
    "color": Choice("Color", "A color around the shapes and in their holes"),
}
OVERLAPS = {
    "cover": Choice("Cover", "The nearer shape hides the other, as far as it is opaque"),
    "add": Choice(
        "Add", "Colors and alpha are added. Faster, and correct if shapes do not overlap"
    ),
}
LIGHTS = {
    "srgb": Choice(
        "As in Browsers", "Colors mix as they are encoded for display, as in web browsers"
    ),
    "linear": Choice("Linear Light", "Colors mix as light does, as in renders"),
}
PIXEL_TYPES = {
    "byte": Choice("8 Bit", "Whole numbers, sRGB-encoded"),
    "half": Choice("Half Float", "16-bit floats, scene-linear"),
    "float": Choice("Float", "32-bit floats, scene-linear"),
}
ALPHAS = {
    "auto": Choice(
        "Automatic", "As Blender stores images: straight for 8 bits, premultiplied for floats"
    ),
    "straight": Choice("Straight", "Colors are not multiplied by alpha"),
    "premultiplied": Choice("Premultiplied", "Colors are multiplied by alpha"),
}


@dataclass(frozen=True)
class RasterizeSettings:
    """Settings of `prefilter.rasterize`."""

    source: str = one_of("auto", "Source", "What to rasterize", SOURCES, flag="")
    filepath: str = text(
        "", "SVG File", "File for the source SVG File", subtype="FILE_PATH", flag=""
    )
    font_folder: str = text(
        "",
        "Fonts",
        "Folder with the fonts for text in SVG files. If empty, the fonts of the system",
        subtype="DIR_PATH",
        flag="--fonts",
        metavar="FOLDER",
    )
    filter: str = one_of(
        "box",
        "Filter",
        "How shapes are weighted around the center of a pixel",
        FILTERS,
        metavar="FILTER",
    )
    resolution: str = one_of(
        "side", "Resolution", "How to specify the size of the image", RESOLUTIONS, flag=""
    )
    side: int = number(
        1024,
        "Longer Side",
        "Width or height of the image, whichever is greater; the other follows from the shapes",
        low=1,
        high=LARGEST_SIDE,
        subtype="PIXEL",
        metavar="N",
    )
    width: int = number(
        1024, "Width", "Width of the image", low=1, high=LARGEST_SIDE, subtype="PIXEL", metavar="N"
    )
    height: int = number(
        1024,
        "Height",
        "Height of the image",
        low=1,
        high=LARGEST_SIDE,
        subtype="PIXEL",
        metavar="N",
    )
    density: float = number(
        512.0,
        "Pixels per Unit",
        "Number of pixels per unit of the world, or of the SVG file",
        low=0.0,
        is_above=True,
        display={"soft_max": 4096.0, "precision": 2},
        flag_description="Pixels per unit of the world, or of the SVG file, instead of a size",
        metavar="N",
    )
    margin: float = number(
        8.0,
        "Margin",
        "Pixels to leave free around the shapes",
        low=0.0,
        high=LARGEST_SIDE / 2,
        subtype="PIXEL",
        display={"soft_max": 64.0, "precision": 1},
        metavar="PIXELS",
    )
    uv_margin: float = number(
        0.0,
        "UV Margin",
        "How many pixels beyond their borders the charts of a UV map reach, as in bakes",
        low=0.0,
        high=LARGEST_SIDE / 2,
        subtype="PIXEL",
        display={"soft_max": 64.0, "precision": 1},
        metavar="PIXELS",
    )
    view: str = one_of(
        "object", "View", "Direction from which curves and texts are seen", VIEWS, metavar="VIEW"
    )
    tile: int = number(
        1001,
        "UDIM Tile",
        "The tile of UV space that the mask shows; 1001 is from 0 to 1",
        low=1001,
        high=2000,
        metavar="N",
    )
    color: str = one_of("material", "Color", "What shapes look like", COLORS, metavar="COLOR")
    background: str = one_of(
        "transparent", "Background", "What shows where no shape is", BACKGROUNDS, flag=""
    )
    background_color: tuple[float, float, float, float] = rgba(
        (1.0, 1.0, 1.0, 1.0),
        "Background Color",
        "The color of the background",
        flag="--background",
        flag_description="Color of the background, as #RRGGBB or #RRGGBBAA (default: transparent)",
        metavar="COLOR",
    )
    overlap: str = one_of(
        "cover", "Overlap", "What shows where shapes overlap", OVERLAPS, metavar="MODE"
    )
    light: str = one_of(
        "srgb", "Blending", "How translucent colors of an SVG file mix", LIGHTS, metavar="LIGHT"
    )
    pixel_type: str = one_of(
        "byte", "Pixel Type", "Type of the numbers in a pixel", PIXEL_TYPES, metavar="TYPE"
    )
    alpha: str = one_of(
        "auto", "Alpha", "How colors are stored where alpha is below 1", ALPHAS, metavar="ALPHA"
    )
    use_bleed: bool = switch(
        True,
        "Bleed",
        "Fill pixels whose alpha is 0 with the colors around them, so that lookups between "
        "pixels do not darken edges. For straight alpha",
    )
    image_name: str = text(
        "",
        "Image Name",
        "Name of the image. If empty, it is named after the active object or the file",
        flag="",
    )
    threads: int = threads()
