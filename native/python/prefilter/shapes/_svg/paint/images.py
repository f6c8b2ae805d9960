# SPDX-License-Identifier: GPL-3.0-or-later

"""Images, embedded or in files of the drawing's folder."""

from collections.abc import Callable
from typing import Protocol

import numpy as np
import numpy.typing as npt

from ...affine import Matrix, compose, translation
from ..model.gradients import Colors
from ..model.limits import TooLargeError
from ..model.tree import Clip, Group, Picture, make_box_clip, transform_box
from ..model.values import Length
from ..model.view_boxes import ViewBox, fit_view_box
from ..read.context import Context, Sources
from ..read.document import SvgElement
from ..read.external_resources import BaseFolder, NotLocalError, UnusableError, read_address
from ..read.image_files import ImageError, decode_image, image_extension, image_size
from ..read.nesting import VISIBLE_OVERFLOW
from ..read.page import Page

_ZERO, _AUTO = Length(0.0), Length(-1.0)
_PIXELATED = ("pixelated", "crisp-edges", "optimizespeed", "-moz-crisp-edges")
MAX_BYTES = 1 << 28


class NestedDrawing(Protocol):
    """A nested drawing."""

    @property
    def page(self) -> Page:
        """The drawing's page."""

    def build(self, matrix: Matrix, clips: tuple[Clip, ...], target: Group, colors: Colors) -> None:
        """Adds its items to a group; the matrix leads from its units to the tree's."""


Read = Callable[[bytes, str], NestedDrawing]
"""Reads a nested drawing from its bytes and its name in messages."""
Contents = npt.NDArray[np.uint8] | NestedDrawing
Bounds = tuple[float, float, float, float]
"""Left, top, width, height."""


class Images:
    """The images of a drawing, each read once."""

    def __init__(self, read: Read) -> None:
        self._read = read
        self._known: dict[SvgElement, Contents | Exception] = {}

    def contents(self, element: SvgElement, sources: Sources) -> Contents:
        """Returns texels or a nested drawing. Raises the reason if there are none."""
        if element not in self._known:
            try:
                self._known[element] = self._contents(element, sources)
            except (NotLocalError, UnusableError, ImageError, ValueError) as error:
                self._known[element] = error
        contents = self._known[element]
        if isinstance(contents, Exception):
            raise contents
        return contents

    def _contents(self, element: SvgElement, sources: Sources) -> Contents:
        data, name = _read_bytes(element, sources)
        if image_extension(data):
            width, height = image_size(data)
            sources.budget.take_texels(width * height)
            return decode_image(data)
        if data.lstrip(b"\xef\xbb\xbf \t\r\n")[:1] == b"<" or data[:2] == b"\x1f\x8b":
            return self._read(data, name)
        raise NotLocalError("as it is neither PNG, JPEG, GIF, WebP nor SVG")


def draw_image(element: SvgElement, context: Context, sources: Sources, images: Images) -> None:
    """Draws an `image` element."""
    if context.style.visibility == "visible":
        place_image(element, None, context, sources, images)


def place_image(
    element: SvgElement, box: Bounds | None, context: Context, sources: Sources, images: Images
) -> None:
    """Draws the image that an element refers to.

    Args:
        box: Left, top, width and height; None for those of the element's attributes.
        context: The context within the element.
    """
    try:
        contents = images.contents(element, sources)
        if isinstance(contents, np.ndarray):
            own_size = float(contents.shape[1]), float(contents.shape[0])
        else:
            own_size = contents.page.width, contents.page.height
        bounds = _image_box(element, own_size, context, sources) if box is None else box
        if bounds[2] > 0.0 and bounds[3] > 0.0:
            _draw(element, contents, own_size, bounds, context, sources)
    except TooLargeError:
        raise
    except NotLocalError as error:
        sources.warnings.unsupported(f"<{element.tag}>", f"left out, {error}", element.line)
    except (UnusableError, ImageError, ValueError) as error:
        sources.warnings.broken(f"<{element.tag}>", f"left out, {error}", element.line)


def _image_box(
    element: SvgElement, own: tuple[float, float], context: Context, sources: Sources
) -> Bounds:
    """Returns an image's box. Missing sides follow from its proportions."""
    x, y = (sources.pixels(element, key, _ZERO, context.units) for key in ("x", "y"))
    width, height = (
        sources.pixels(element, key, _AUTO, context.units) for key in ("width", "height")
    )
    if width < 0.0 and height < 0.0:
        width, height = own
    ratio = own[0] / own[1]
    width = height * ratio if width < 0.0 else width
    height = width / ratio if height < 0.0 else height
    return x, y, width, height


def _draw(
    element: SvgElement,
    contents: Contents,
    own: tuple[float, float],
    box: Bounds,
    context: Context,
    sources: Sources,
) -> None:
    declared = sources.sheets.declared(element)
    x, y, width, height = box
    aspect = declared.get("preserveAspectRatio", "")
    if not isinstance(contents, np.ndarray) and not contents.page.has_size:
        # In browsers, a drawing without a size fills the box.
        own = own if aspect.strip() == "none" else (width, height)
    own_width, own_height = own
    page = ViewBox(0.0, 0.0, own_width, own_height)
    view_matrix = compose(translation(x, y), fit_view_box(page, aspect, width, height))
    matrix = compose(context.matrix, view_matrix)
    clips = context.clips
    if declared.get("overflow", "hidden") not in VISIBLE_OVERFLOW and aspect.strip().endswith(
        "slice"
    ):
        clips = (*clips, make_box_clip((x, y, x + width, y + height), context.matrix))
    if isinstance(contents, np.ndarray):
        unit = compose(matrix, (own_width, 0.0, 0.0, own_height, 0.0, 0.0))
        context.target.items.append(
            Picture(
                contents,
                unit,
                context.style.image_rendering in _PIXELATED,
                context.colors.is_linear,
                clips,
                transform_box((0.0, 0.0, 1.0, 1.0), unit),
                element.line,
            )
        )
    else:
        group = Group(is_isolated=True, line=element.line)
        context.target.items.append(group)
        clips = (*clips, make_box_clip((0.0, 0.0, own_width, own_height), matrix))
        view_matrix = fit_view_box(contents.page.view, contents.page.aspect, own_width, own_height)
        contents.build(compose(matrix, view_matrix), clips, group, context.colors)


def _read_bytes(element: SvgElement, sources: Sources) -> tuple[bytes, str]:
    """Returns the bytes that an image refers to, and their name in messages."""
    address = element.address
    if not address or address.startswith("#"):
        raise UnusableError("as it refers to no image")
    folder = sources.folder
    base = None if folder is None else BaseFolder(folder, folder)
    data, path = read_address(address, base, MAX_BYTES)
    return data, "<image>" if path is None else path.name
