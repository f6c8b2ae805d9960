# SPDX-License-Identifier: GPL-3.0-or-later

"""Settings for sampling tables."""

from dataclasses import dataclass

from .images import TABLE_FILTERS
from .options import Choice, number, one_of, switch, text, threads

LANGUAGES = {
    "glsl": Choice("GLSL", "Shader code for OpenGL and Vulkan"),
    "hlsl": Choice("HLSL", "Shader code for Direct3D"),
    "osl": Choice("OSL", "Shader code for renderers with Open Shading Language"),
    "json": Choice("Table", "The table itself, to load again"),
}
SPECTRA = {
    "natural": Choice("Natural", "Images with edges and gradients, such as photographs"),
    "white": Choice("White Noise", "Images with as much detail of every size"),
}
TARGETS = {"filter": Choice("Same as Filter", "The filter of the levels"), **TABLE_FILTERS}


@dataclass(frozen=True)
class TableSettings:
    """Settings of `prefilter.SamplingTable.build`, and the output of the table."""

    filter: str = one_of(
        "lanczos2", "Filter", "Filter of the mipmap's levels", TABLE_FILTERS, metavar="FILTER"
    )
    target: str = one_of(
        "filter",
        "Target",
        "Filter to reproduce. With the levels of Tent, Box is the mean over a pixel",
        TARGETS,
        metavar="FILTER",
    )
    texels: int = number(
        8,
        "Texels",
        "Number of texels of the mipmap per sample. Trilinear interpolation reads 8",
        low=2,
        high=16,
        metavar="N",
    )
    grid: int = number(
        4,
        "Parts",
        "Number of parts of a texel along x and along y. Each part has its own set of texels",
        low=1,
        high=16,
        metavar="N",
    )
    slices: int = number(
        2,
        "Slices",
        "Number of parts of the step from one level to the next",
        low=1,
        high=16,
        metavar="N",
    )
    degree: int = number(
        1,
        "Degree",
        "Degree of the weights, polynomials in the place and the scale: 1 is linear, 2 quadratic",
        low=1,
        high=2,
        metavar="N",
    )
    ramp_weight: float = number(
        5.0,
        "Ramp Weight",
        "How much exact smooth gradients count against the error of the filter. At 0, "
        "samples of gradients step where the set of texels changes",
        low=0.0,
        high=1e6,
        display={"soft_max": 100.0, "precision": 2},
        metavar="WEIGHT",
    )
    spectrum: str = one_of(
        "natural", "Spectrum", "Images to be closest to the filter on", SPECTRA, metavar="SPECTRUM"
    )
    use_certify: bool = switch(
        False,
        "Certify",
        "Prove a bound on how far the sets of texels are from the best ones. May take minutes",
    )
    language: str = one_of("glsl", "Language", "Language or format to write", LANGUAGES, flag="")
    filepath: str = text(
        "",
        "File",
        "File to write; if empty, a text of this .blend file",
        subtype="FILE_PATH",
        flag="",
    )
    table: str = text(
        "",
        "Load",
        "Saved table to write in another language; if empty, a table is built",
        subtype="FILE_PATH",
        metavar="FILE",
    )
    threads: int = threads()

    @property
    def is_standard(self) -> bool:
        """Whether all settings match the tables that come with the package."""
        standard = TableSettings()
        names = ("grid", "slices", "degree", "ramp_weight", "spectrum", "use_certify")
        return all(getattr(self, name) == getattr(standard, name) for name in names)
