# SPDX-License-Identifier: GPL-3.0-or-later

"""Checks of pictures against Pillow, which decodes them by its own code, and drawings by resvg."""

import io
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageCms, ImageOps, UnidentifiedImageError

from bench.field.checks.messages import warnings

Floats = NDArray[np.float64]

MIN_BLOCK_PIXELS = 12
"""Smallest block side, in pixels of the result: pictures are compared by means over blocks, because
a filter blurs the borders."""
MAX_BLOCKS = 4
MAX_BLOCK_DIFFERENCE = 0.03
"""In linear light. It allows for byte files, which clip a filter's overshoots at lines."""
MAX_DRAWING_DIFFERENCE = 8 / 255
RESVG_WIDTH = 1024
"""About the width of the compared picture, whose longer side is this by default."""
Image.MAX_IMAGE_PIXELS = None
_TURNS = {
    2: Image.Transpose.FLIP_LEFT_RIGHT,
    3: Image.Transpose.ROTATE_180,
    4: Image.Transpose.FLIP_TOP_BOTTOM,
    5: Image.Transpose.TRANSPOSE,
    6: Image.Transpose.ROTATE_270,
    7: Image.Transpose.TRANSVERSE,
    8: Image.Transpose.ROTATE_90,
}
"""How Pillow turns a picture upright, by its EXIF orientation."""


def check_resized(run: Any, truth: Mapping[str, Any]) -> list[str]:
    """Checks a picture of half the size: its sides, channels, depth, orientation and colors."""
    if run.target.suffix == ".exr":
        return _check_light(run, truth)
    made = Image.open(run.target)
    try:
        source = Image.open(run.source)
        source.load()
    except (UnidentifiedImageError, OSError, ValueError, SyntaxError):
        return []
    findings = []
    upright = _upright(source, run.source)
    # A copied orientation tag would turn the result in viewers.
    shown = ImageOps.exif_transpose(made)
    right = tuple(max(1, round(side / 2)) for side in upright.size)
    if any(abs(a - b) > 1 for a, b in zip(shown.size, right, strict=True)):
        findings.append(f"size: {shown.size} is shown; {right} are right")
    if _is_gray(source) and not _is_gray(made):
        findings.append(f"channels: {source.mode} became {made.mode}")
    if _bits(source) > 8 >= _bits(made):
        findings.append(f"depth: {_bits(source)} bits became {_bits(made)}")
    if "A" not in made.mode and _has_visible_alpha(upright):
        findings.append(f"alpha: {source.mode} became {made.mode}")
    if min(shown.size) < MIN_BLOCK_PIXELS or source.mode in ("F", "I") or _is_premultiplied(source):
        return findings
    # A shared profile keeps colors outside sRGB comparable without clipping.
    converts = upright.info.get("icc_profile") != shown.info.get("icc_profile")
    blocks = min(MAX_BLOCKS, min(shown.size) // MIN_BLOCK_PIXELS)
    means = [_block_means(image, blocks, converts=converts) for image in (upright, shown)]
    difference = np.abs(means[0] - means[1]).max()
    if difference > MAX_BLOCK_DIFFERENCE and not warnings(run):
        findings.append(f"colors: means of blocks differ by {difference:.3f} of 1")
    return findings


def check_drawn(run: Any, truth: Mapping[str, Any]) -> list[str]:
    """Checks a drawing: against the area or the color that it must have, or against resvg."""
    picture = np.asarray(Image.open(run.target).convert("RGBA"), float) / 255
    findings = []
    if "covered_share" in truth:
        # Crop the margin that the command leaves around shapes.
        rows, columns = np.nonzero(picture[..., 3] > 0)
        if not len(rows):
            return ["empty: nothing is drawn"]
        box = (rows.max() - rows.min() + 1) * (columns.max() - columns.min() + 1)
        share = picture[..., 3].sum() / box
        if abs(share - truth["covered_share"]) > 0.01:
            findings.append(f"area: {share:.3f} of its box; {truth['covered_share']:.3f} is right")
    if "color" in truth:
        opaque = picture[picture[..., 3] == 1][:, :3]
        if not len(opaque):
            findings.append("color: no pixel is opaque")
        elif np.abs(opaque.mean(axis=0) - truth["color"]).max() > 2 / 255:
            found = np.round(255 * opaque.mean(axis=0))
            findings.append(f"color: {found}; {np.round(255 * np.array(truth['color']))} is right")
    if not truth and not (picture[..., 3] > 0).any() and not warnings(run):
        findings.append("empty: nothing is drawn, and nothing is said")
    if not truth and (second := _by_resvg(run.source)) is not None:
        findings += _compare_drawings(picture, second, run)
    return findings


def _upright(image: Image.Image, path: Path) -> Image.Image:
    """Returns a picture turned upright by its orientation.

    Pillow turns TIFF files by itself while it loads them, and in some modes twice.
    """
    if image.format != "TIFF":
        return ImageOps.exif_transpose(image)
    import OpenImageIO as oiio

    config = oiio.ImageSpec()
    config.attribute("oiio:UnassociatedAlpha", 1)
    reader = oiio.ImageInput.open(str(path), config)
    turn = _TURNS.get(reader.spec().get_int_attribute("Orientation", 1))
    pixels = np.asarray(reader.read_image("uint8"))
    stored = Image.fromarray(pixels[..., 0] if pixels.shape[2] == 1 else pixels)
    upright = stored if turn is None else stored.transpose(turn)
    upright.info = dict(image.info)
    return upright


def _check_light(run: Any, truth: Mapping[str, Any]) -> list[str]:
    import OpenImageIO as oiio

    means = []
    for path in (run.source, run.target):
        buffer = oiio.ImageBuf(str(path))
        values = np.asarray(buffer.get_pixels(oiio.FLOAT), float)
        if values.size == 0:
            return []
        means.append((values[..., : min(3, values.shape[2])], buffer.spec().channelnames))
    (source, names), (made, made_names) = means
    findings = []
    if not np.isfinite(made).all() and np.isfinite(source).all():
        findings.append("not finite: the source is")
    if len(names) != len(made_names) and not warnings(run):
        findings.append(f"channels: {','.join(names)} became {','.join(made_names)}")
    del truth
    return findings


def _is_gray(image: Image.Image) -> bool:
    return image.mode in ("L", "LA", "La", "1", "I;16", "I;16B", "I", "F")


def _bits(image: Image.Image) -> int:
    if isinstance(getattr(image, "fp", None), io.IOBase) and image.format == "PNG":
        return int(Path(image.filename).read_bytes()[24])
    return 16 if image.mode.startswith("I") else 8


def _is_premultiplied(image: Image.Image) -> bool:
    """Tells whether a TIFF file has associated alpha, which Pillow takes for straight alpha."""
    return image.format == "TIFF" and image.tag_v2.get(338) == (1,)  # ExtraSamples


def _has_visible_alpha(image: Image.Image) -> bool:
    if image.mode not in ("RGBA", "LA", "PA") and "transparency" not in image.info:
        return False
    return bool(np.asarray(image.convert("RGBA"))[..., 3].min() < 250)


def _block_means(image: Image.Image, blocks: int, *, converts: bool) -> Floats:
    """Returns means over blocks of linear light times alpha, and of alpha."""
    values = _in_srgb(image) if converts else _as_stored(image)
    alpha = values[..., 3:]
    light = np.where(values <= 0.04045, values / 12.92, ((values + 0.055) / 1.055) ** 2.4)
    stacked = np.concatenate([light[..., :3] * alpha, alpha], axis=2).astype(np.float32)
    # Blocks end within pixels: Pillow's box filter weights these.
    channels = [
        np.asarray(Image.fromarray(stacked[..., c]).resize((blocks, blocks), Image.Resampling.BOX))
        for c in range(4)
    ]
    return np.stack(channels, axis=2).astype(float)


def _as_stored(image: Image.Image) -> Floats:
    """Returns RGBA from 0 to 1, whatever the profile."""
    if image.mode.startswith("I"):
        gray = np.asarray(image, float) / 65535
        return np.stack([gray, gray, gray, np.ones_like(gray)], axis=2)
    return np.asarray(image.convert("RGBA"), float) / 255


def _in_srgb(image: Image.Image) -> Floats:
    """Returns RGBA in sRGB from 0 to 1, by the profile that a picture has."""
    profile = image.info.get("icc_profile")
    if not profile or image.mode.startswith("I"):
        return _as_stored(image)
    alpha = image.convert("RGBA").getchannel("A")
    colors = image if image.mode in ("RGB", "L", "CMYK") else image.convert("RGBA").convert("RGB")
    try:
        colors = ImageCms.profileToProfile(
            colors, io.BytesIO(profile), ImageCms.createProfile("sRGB"), outputMode="RGB"
        )
    except ImageCms.PyCMSError:
        return _as_stored(image)
    rgba = colors.convert("RGB")
    rgba.putalpha(alpha)
    return np.asarray(rgba, float) / 255


def _by_resvg(path: Path) -> Floats | None:
    try:
        import resvg_py
    except ImportError:
        return None
    try:
        drawn = bytes(resvg_py.svg_to_bytes(svg_path=str(path), width=RESVG_WIDTH))
        return np.asarray(Image.open(io.BytesIO(drawn)).convert("RGBA"), float) / 255
    except Exception:  # What another renderer refuses is no reference.
        return None


def _compare_drawings(picture: Floats, second: Floats, run: Any) -> list[str]:
    """Compares the visible parts of two drawings, cropped and scaled to the same size."""
    cut = [_visible(one) for one in (picture, second)]
    if any(one is None for one in cut):
        is_lost = cut[0] is None and cut[1] is not None
        return ["empty: resvg draws something"] if is_lost and not warnings(run) else []
    side = 128
    same = [
        np.asarray(
            Image.fromarray(np.uint8(255 * one)).convert("RGBa").resize((side, side), Image.BOX),
            float,
        )
        / 255
        for one in cut
        if one is not None
    ]
    difference = float(np.abs(same[0] - same[1]).mean())
    if difference > MAX_DRAWING_DIFFERENCE and not warnings(run):
        return [f"drawing: it differs from resvg's by {255 * difference:.1f} of 255 on average"]
    return []


def _visible(picture: Floats) -> Floats | None:
    rows, columns = np.nonzero(picture[..., 3] > 0.5 / 255)
    if not len(rows):
        return None
    return picture[rows.min() : rows.max() + 1, columns.min() : columns.max() + 1]
