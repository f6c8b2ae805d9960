"""What a user may choose for a bake, and how the choices are presented."""

from dataclasses import dataclass

from ..core.choices import Choice

FILTERS = {
    "pam-bilinear": Choice(
        "PAM Bilinear", "Best fit over the surface, for readers that interpolate between texels"
    ),
    "pam-trilinear": Choice(
        "PAM Trilinear",
        "Best fit of all levels together, for readers that interpolate between levels too, as GPUs",
    ),
    "pam-box": Choice("PAM Box", "Average of the surface under each texel"),
    "box": Choice("Box", "Average of four texels, whether a face uses them or not"),
    "tent": Choice("Tent", "Smoother than Box, whether a face uses the texels or not"),
    "lanczos3": Choice("Lanczos 3", "Sharper than Box, whether a face uses the texels or not"),
    "box-covered": Choice("Box, Covered Texels", "Box over the texels that a face touches"),
    "tent-covered": Choice("Tent, Covered Texels", "Tent over the texels that a face touches"),
    "lanczos3-covered": Choice(
        "Lanczos 3, Covered Texels", "Lanczos 3 over the texels that a face touches"
    ),
}
TEXTURE_SPACE_FILTERS = frozenset({"box", "tent", "lanczos3"})

_MODES = {
    "clamp": Choice("Clamp", "The border texels go on"),
    "repeat": Choice("Repeat", "The image tiles the plane"),
    "border": Choice("Border", "Black and transparent"),
}
WRAPS = {
    "auto": Choice("As in Material", "What the Image Texture nodes of the image say"),
    **_MODES,
}
WRAPS_V = {"same": Choice("Same as U", "The same as along U"), **_MODES}
BOUNDS = {
    "auto": Choice(
        "Automatic",
        "0 to 1 for images of integers, 0 and up for others; wider where the image goes beyond",
    ),
    "unit": Choice("0 to 1", "Values stay between 0 and 1"),
    "positive": Choice("0 and Up", "Values stay at or above 0"),
    "none": Choice("None", "Values may leave the range of the image"),
}

READERS = {
    "linear": Choice(
        "Linear Light", "GPUs, and float textures everywhere: texels are decoded, then interpolated"
    ),
    "srgb-after": Choice(
        "Encoded",
        "Cycles on 8-bit sRGB images: encoded texels are interpolated, then decoded. Other images "
        "are read as linear light all the same",
    ),
}

CONTENTS = {
    "auto": Choice(
        "Automatic",
        "A normal map where a Normal Map node reads the image, data where its color space is "
        "Non-Color, else color",
    ),
    "color": Choice("Color", "Filtered as light, with alpha as coverage"),
    "data": Choice(
        "Data", "Roughness, masks, packed channels: values as they are stored, each by itself"
    ),
    "normal": Choice("Normal Map", "Filtered as vectors, which keep the length 1"),
    "cutout": Choice(
        "Cut-Out", "Color whose alpha test keeps as much of the surface at every level"
    ),
}
OBJECTS = {
    "all": Choice("All Users", "All visible objects of the scene that use the image"),
    "selected": Choice(
        "Selected", "The selected objects and those in Edit Mode, as far as they use the image"
    ),
}
TEXTURE_FORMATS = {
    "auto": Choice("Automatic", "Bytes for byte images, half floats for float images"),
    "rgba8": Choice("8-Bit", "Four bytes a texel, uncompressed"),
    "rgba16f": Choice("Half Float", "Scene-linear, 8 bytes a texel, for high dynamic range"),
    "rgba32f": Choice("Float", "Scene-linear, 16 bytes a texel"),
    "bc1": Choice("BC1", "Compressed color, half a byte a texel; alpha is 0 or 1"),
    "bc3": Choice("BC3", "Compressed color and alpha, a byte a texel"),
    "bc4": Choice("BC4", "Compressed red channel, half a byte a texel: masks, roughness"),
    "bc5": Choice("BC5", "Compressed red and green channels, a byte a texel: normal maps"),
}
ROUGHNESS_CHANNELS = {
    "all": Choice("All", "The image holds nothing but roughness"),
    "red": Choice("Red", "The red channel holds roughness"),
    "green": Choice("Green", "The green channel holds roughness, as in glTF files"),
    "blue": Choice("Blue", "The blue channel holds roughness"),
}


@dataclass(frozen=True)
class Settings:
    """What to bake and where to put it.

    Attributes:
        filter: A key of `FILTERS`.
        wrap: A key of `WRAPS`: what lies outside of the image along u.
        wrap_v: A key of `WRAPS_V`: the same along v.
        bounds: A key of `BOUNDS`.
        reader: A key of `READERS`: how the levels of an 8-bit sRGB image are looked up.
        objects: A key of `OBJECTS`: which objects count.
        levels: How many levels to make, the image itself included; 0 for all.
        use_images: Whether to write an image datablock for each level.
        filepath: A mip-mapped file to write; empty for none. It gets every level.
        threads: How many threads to use; 0 for all.
        use_subdivision_limit: Whether objects with a Catmull-Clark modifier on top count as their
            limit surface.
        importance: The name of a vertex group or attribute that areas are multiplied by; empty for
            none.
        seam_weight: How much it counts that the two sides of UV seams agree; see
            `prefilter.mipmaps`.
        use_frames: Whether to average over the frames below, instead of taking the current one.
        frame_start: The first frame.
        frame_end: The last frame.
        frame_step: How far the frames are apart.
        content: A key of `CONTENTS`: what the image holds.
        threshold: The alpha from which on a cut-out is shown; above 0, at most 1.
        roughness: The name of an image that gets what a normal map's levels lose; empty for none.
        roughness_channel: A key of `ROUGHNESS_CHANNELS`.
        roughness_filepath: A mip-mapped file of the roughness to write; empty for none.
        texture_format: A key of `TEXTURE_FORMATS`: how a DDS or KTX 2 file holds texels.
    """

    filter: str = "pam-bilinear"
    wrap: str = "auto"
    wrap_v: str = "same"
    bounds: str = "auto"
    reader: str = "linear"
    objects: str = "all"
    levels: int = 0
    use_images: bool = True
    filepath: str = ""
    threads: int = 0
    use_subdivision_limit: bool = True
    importance: str = ""
    seam_weight: float = 0.0
    use_frames: bool = False
    frame_start: int = 1
    frame_end: int = 250
    frame_step: int = 1
    content: str = "auto"
    threshold: float = 0.5
    roughness: str = ""
    roughness_channel: str = "all"
    roughness_filepath: str = ""
    texture_format: str = "auto"
