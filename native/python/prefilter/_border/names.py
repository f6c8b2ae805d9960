# SPDX-License-Identifier: GPL-3.0-or-later

"""Allowed names of arguments, for type checkers and editors; the library checks them."""

from typing import Literal, TypeAlias

Kernel: TypeAlias = Literal[
    "box", "tent", "bspline2", "mitchell", "lanczos2", "lanczos3", "gaussian"
]
RasterFilter: TypeAlias = Kernel | Literal["radial2", "radial3"]
ResizeFilter: TypeAlias = RasterFilter | Literal["least-squares"]
Fit: TypeAlias = Literal["ls-bilinear", "pam-box", "pam-bilinear", "pam-trilinear"]
Covered: TypeAlias = Literal[
    "box-covered",
    "tent-covered",
    "bspline2-covered",
    "mitchell-covered",
    "lanczos2-covered",
    "lanczos3-covered",
    "gaussian-covered",
]
MipmapFilterName: TypeAlias = Kernel | Covered | Fit

WrapMode: TypeAlias = Literal["clamp", "repeat", "border"]
Reader: TypeAlias = Literal["linear", "srgb-after"]
Encoding: TypeAlias = Literal["linear", "srgb"]
Ringing: TypeAlias = Literal["auto", "allow", "limit"]
Alpha: TypeAlias = Literal["straight", "premultiplied", "independent"]

DdsFormat: TypeAlias = Literal[
    "r8",
    "rg8",
    "rgba8",
    "rgba16f",
    "rgba32f",
    "bc1",
    "bc1-rgb",
    "bc3",
    "bc4",
    "bc5",
    "bc6h",
    "bc7",
]
Ktx2Format: TypeAlias = (
    DdsFormat
    | Literal[
        "etc2-rgb",
        "etc2-rgba",
        "eac-r11",
        "eac-rg11",
        "astc-4x4",
        "astc-6x6",
        "astc-8x8",
        "astc-4x4-hdr",
        "astc-6x6-hdr",
        "uastc",
        "etc1s",
    ]
)
Auto: TypeAlias = Literal["auto"]
ExrFormat: TypeAlias = Literal["half", "float"]
Effort: TypeAlias = Literal["fast", "normal", "best"]
Header: TypeAlias = Literal["auto", "dx10", "legacy"]
Supercompression: TypeAlias = Literal["none", "zstd"]

Wavelet: TypeAlias = Literal["haar", "d4"]
Direction: TypeAlias = Literal["auto", "given", "up", "viewpoint", "outward"]
Upward: TypeAlias = Literal["auto", "up", "outward"]
Returns: TypeAlias = Literal["all", "first", "last", "only"]
Against: TypeAlias = Literal["scans", "surface"]
