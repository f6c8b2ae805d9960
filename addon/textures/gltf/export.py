# SPDX-License-Identifier: GPL-3.0-or-later

"""The textures of a glTF export: read as the exporter has them, fitted, and replaced."""

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from copy import copy
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import bpy
import numpy as np
import prefilter
from numpy.typing import NDArray
from prefilter.files.claims import temporary_folder
from prefilter.workflows.files import png
from prefilter.workflows.picture import scene_linear
from prefilter.workflows.textures import contents, lookups
from prefilter.workflows.textures.outputs import Outputs

from ...bridge import images, meshes
from ...bridge.files.staging import commit_all
from ...core.outcome import FAILURES, reason
from .. import source
from ..bake import Bake
from ..choices import TEXTURE_SPACE_FILTERS, Settings
from . import geometry, shader_nodes, uses
from .choices import GltfSettings
from .geometry import Part
from .uses import Use

_EXTENSION = "KHR_texture_basisu"
_WEBP = "EXT_texture_webp"
_MIME_TYPE = "image/ktx2"
_FILE = "texture.ktx2"
_WRAPS: dict[Any, str] = {33071: "clamp", 33648: "clamp"}
"""Wrap modes of samplers. Close to its edge, a mirrored image looks like a clamped one."""


@dataclass
class _Picture:
    """An image of the file in one role: all textures with the same bytes and the same filtering.

    Attributes:
        image: The exporter's image.
        data: The contents of its file.
        role: "color", "normal" or "data".
        threshold: The threshold of the alpha test; None for none.
        wraps: The wrap modes of both axes.
        suffix: A suffix that distinguishes it from the same image in other roles.
        textures: The exporter's textures, by the ids of their originals and their own.
        shown: Its uses, with the triangles that show it.
    """

    image: Any
    data: bytes
    role: str
    threshold: float | None
    wraps: tuple[str, str]
    suffix: str = ""
    textures: dict[int, Any] = field(default_factory=dict)
    shown: list[tuple[Use, Part]] = field(default_factory=list)

    @property
    def name(self) -> str:
        """Its name in messages and in the file."""
        return f"{self.image.name or 'Image'}{self.suffix}"

    def add(self, use: Use, part: Part, taken: dict[int, Any]) -> None:
        """Adds a use; copies its texture if another role uses that already."""
        texture = use.texture
        if id(texture) not in self.textures:
            own = copy(texture) if id(texture) in taken else texture
            self.textures[id(texture)] = self.textures[id(own)] = taken[id(own)] = own
        use.info.index = self.textures[id(texture)]
        self.shown.append((use, part))


class Export:
    """The textures of one export.

    Attributes:
        baked: The names of images with new levels.
        failed: The names of the other images.
        warnings: Warnings about images.
        notes: Remarks about images.
    """

    def __init__(self, settings: Settings, options: GltfSettings) -> None:
        """Stores the options, and the settings that the file does not determine itself."""
        self.baked: list[str] = []
        self.failed: list[str] = []
        self.warnings: list[str] = []
        self.notes: list[str] = []
        self._options = options
        self._parts: list[Part] = []
        self._colors: dict[str, NDArray[np.float32]] = {}
        self._settings = lookups.resolved(
            Settings(
                filter=settings.filter,
                lookups=settings.lookups,
                bounds=settings.bounds,
                seam_budget=settings.seam_budget,
                texture_format=options.texture_format,
                effort=options.effort,
                supercompression=options.supercompression,
                quality=options.quality,
                use_images=False,
                filepath=_FILE,
                threads=settings.threads,
            )
        )

    @classmethod
    def of(cls, scene: bpy.types.Scene) -> "Export":
        """Returns an export with the settings of a scene."""
        bake, gltf = scene.prefilter_bake, scene.prefilter_gltf
        settings = Settings(
            filter=bake.filter,
            lookups=bake.lookups,
            bounds=bake.bounds,
            seam_budget=bake.seam_budget,
        )
        names = ("texture_format", "effort", "supercompression", "quality", "fallback")
        options = GltfSettings(True, **{name: getattr(gltf, name) for name in names})
        return cls(settings, options)

    def add_scene(self, scene: Any) -> None:
        """Copies the triangles of a scene."""
        self._parts += geometry.parts(scene)

    def apply_nodes(self, image: Any, sockets: Any, export_settings: dict[str, Any]) -> None:
        """Applies the shader nodes after an image to its picture."""
        data = image.buffer_view or image.uri
        if not hasattr(data, "data"):
            return
        name, log = image.name or "Image", export_settings["log"]
        try:
            with temporary_folder() as folder:
                path = folder / "picture"
                path.write_bytes(data.data)
                with _opened(path, is_data=True) as opened:
                    texels = images.read(opened).stored
            changed, warnings = shader_nodes.changed_texels(texels, sockets, self._color_of)
        except FAILURES as error:
            changed, warnings = None, [f"nodes are ignored: {reason(error)}"]
        for text in warnings:
            self.warnings.append(f"texture '{name}': {text}")
            log.warning(f"Prefilter: {self.warnings[-1]}", popup=True)
        if changed is not None:
            picture = png.encoded((changed * 255 + 0.5).astype(np.uint8))
            _replace_data(image, picture, "image/png", export_settings)

    def _color_of(self, image: bpy.types.Image) -> NDArray[np.float32]:
        """Returns an image as shaders read it, cached because several inputs may use it."""
        if image.name_full not in self._colors:
            self._colors[image.name_full] = scene_linear(images.read(image))
        return self._colors[image.name_full]

    def replace_textures(self, export_settings: dict[str, Any]) -> None:
        """Fits all images; leaves a picture as it is, with a warning, if it cannot be fitted."""
        log, manager = export_settings["log"], bpy.context.window_manager
        pictures = self._pictures()
        manager.progress_begin(0, len(pictures))
        try:
            for number, picture in enumerate(pictures):
                manager.progress_update(number)
                try:
                    ktx2, bake = self._fit(picture)
                except FAILURES as error:
                    text = f"texture '{picture.name}' stays as it is: {reason(error)}"
                    log.warning(f"Prefilter: {text}", popup=True)
                    self.failed.append(picture.name)
                    self.warnings.append(text)
                    continue
                for text in bake.warnings:
                    log.warning(f"Prefilter: {text}")
                for text in bake.notes:
                    log.info(f"Prefilter: {text}")
                self.baked.append(picture.name)
                self.warnings += bake.warnings
                self.notes += bake.notes
                self._replace(picture, ktx2, export_settings)
        finally:
            manager.progress_end()

    def _pictures(self) -> list[_Picture]:
        pictures: dict[Any, _Picture] = {}
        taken: dict[int, Any] = {}
        for part in self._parts:
            for use in uses.uses(part.primitive):
                image = _image(use.texture)
                data = image and (image.buffer_view or image.uri)
                if not hasattr(data, "data"):
                    continue
                wraps = _wraps(use.texture.sampler)
                key = (data.data, use.role, use.covers, use.threshold, wraps)
                picture = _Picture(image, data.data, use.role, use.threshold, wraps)
                pictures.setdefault(key, picture).add(use, part, taken)
        _name_by_role(pictures.values())
        return list(pictures.values())

    def _fit(self, picture: _Picture) -> tuple[bytes, Bake]:
        """Returns a KTX 2 file, and the bake that made it."""
        content = picture.role
        with temporary_folder() as folder:
            texels = _read(picture, folder, is_data=content != "color")
            if picture.threshold is not None and content == "color" and texels.shape[2] == 4:
                content = "cutout"
            texels = contents.as_content(texels, content)
            settings = self._settings_of(picture, content)
            surfaces = _surfaces(picture)
            if not any(surface.area for surface in surfaces.surfaces):
                surfaces = meshes.ImageSurfaces()
                if settings.filter not in TEXTURE_SPACE_FILTERS:
                    settings = replace(settings, filter="ls-bilinear")
            target = folder / _FILE
            bake = Bake(source.on_surfaces(texels, surfaces, settings, content), Outputs(target))
            bake.compute(lambda _: True)
            try:
                commit_all(bake.staged_files)
            finally:
                bake.discard()
            return target.read_bytes(), bake

    def _settings_of(self, picture: _Picture, content: str) -> Settings:
        # Codebooks of colors lose details of normals, which would be visible as dents.
        is_coarse = prefilter.TEXEL_FORMATS[self._settings.texture_format].is_coarse
        return replace(
            self._settings,
            texture_format="uastc"
            if is_coarse and content == "normal"
            else self._settings.texture_format,
            content=content,
            threshold=self._settings.threshold if picture.threshold is None else picture.threshold,
            wrap=picture.wraps[0],
            wrap_v=picture.wraps[1],
        )

    def _replace(self, picture: _Picture, ktx2: bytes, export_settings: dict[str, Any]) -> None:
        from io_scene_gltf2.io.com.gltf2_io_extensions import Extension

        is_required = self._options.fallback == "none"
        image = _ktx2_image(picture, ktx2, export_settings)
        for texture in {id(texture): texture for texture in picture.textures.values()}.values():
            extensions = dict(texture.extensions or {})
            extensions.pop(_WEBP, None)
            extension = Extension(_EXTENSION, {"source": image}, is_required)
            texture.extensions = {**extensions, _EXTENSION: extension}
            if is_required:
                texture.source = None


def _name_by_role(pictures: Iterable[_Picture]) -> None:
    """Sets the suffixes of pictures of one image: their roles, with numbers for equal roles."""
    by_data: dict[bytes, list[_Picture]] = {}
    for picture in pictures:
        by_data.setdefault(picture.data, []).append(picture)
    for same in by_data.values():
        for number, picture in enumerate(same if len(same) > 1 else []):
            before = sum(other.role == picture.role for other in same[:number])
            picture.suffix = f"_{picture.role}" + (f"_{before + 1}" if before else "")


def _image(texture: Any) -> Any:
    """Returns the exporter's image of a texture."""
    if texture.source is not None:
        return texture.source
    webp = (texture.extensions or {}).get(_WEBP)
    return getattr(webp, "extension", {}).get("source")


@contextmanager
def _opened(path: Path, *, is_data: bool) -> Iterator[bpy.types.Image]:
    """Loads an image with straight alpha, and removes it at the end of the context."""
    try:
        image = bpy.data.images.load(str(path))
    except RuntimeError as error:
        raise OSError(str(error).strip()) from error
    try:
        image.alpha_mode = "CHANNEL_PACKED"
        if is_data:
            image.colorspace_settings.is_data = True
        yield image
    finally:
        bpy.data.images.remove(image)


def _read(picture: _Picture, folder: Path, *, is_data: bool) -> images.Picture:
    path = folder / "picture"
    path.write_bytes(picture.data)
    with _opened(path, is_data=is_data) as image:
        texels = images.read(image)
    name = picture.name
    covers = any(use.covers for use, _ in picture.shown)
    return replace(texels, name=name, full_name=name, covers=covers)


def _surfaces(picture: _Picture) -> meshes.ImageSurfaces:
    """Returns the surfaces that show an image, each once even if it shows it in several roles."""
    surfaces = meshes.ImageSurfaces()
    seen: set[Any] = set()
    for use, part in picture.shown:
        key = (id(part), use.tex_coord, use.transform)
        if key in seen:
            continue
        seen.add(key)
        surface: prefilter.Surface | None = part.surface(use.tex_coord, use.transform)
        if surface is not None:
            surfaces.surfaces.append(surface)
            surfaces.objects.append(part.name)
    return surfaces


def _wraps(sampler: Any) -> tuple[str, str]:
    """Returns the wrap modes of a sampler along both axes."""
    s, t = (_WRAPS.get(getattr(sampler, name, 0), "repeat") for name in ("wrap_s", "wrap_t"))
    return s, t


def _ktx2_image(picture: _Picture, ktx2: bytes, export_settings: dict[str, Any]) -> Any:
    """Returns an exporter's image for a KTX 2 file, in the buffer or in a separate file."""
    image = copy(picture.image)
    image.extensions = image.extras = None
    image.name = picture.name
    _replace_data(image, ktx2, _MIME_TYPE, export_settings, picture.suffix)
    return image


def _replace_data(
    image: Any, data: bytes, mime_type: str, export_settings: dict[str, Any], suffix: str = ""
) -> None:
    """Replaces the data of an exporter's image, in the buffer or in a separate file."""
    image.mime_type = mime_type
    if image.buffer_view is not None:
        image.buffer_view = type(image.buffer_view)(data)
        return
    kind = type(image.uri)
    if mime_type == _MIME_TYPE:
        kind = type("Ktx2Data", (kind,), {"file_extension": ".ktx2"})
    image.uri = kind(data, mime_type, f"{image.uri.name}{suffix}")
    if hasattr(image.uri, "set_adjusted_name"):
        from io_scene_gltf2.blender.exp.material.image import set_real_uri

        set_real_uri(image.uri, export_settings)
