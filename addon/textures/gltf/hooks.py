# SPDX-License-Identifier: GPL-3.0-or-later

"""The hooks that Blender's glTF exporter and importer call."""

from collections.abc import Iterator
from contextlib import contextmanager
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import bpy

from .properties import GROUP, IMPORT_GROUP

if TYPE_CHECKING:
    from .export import Export

_KEY = "prefilter"
_overrides: "list[Export]" = []


@contextmanager
def exporting(export: "Export") -> Iterator[None]:
    """Makes the exporter use `export` within the context, instead of the settings of the scene."""
    _overrides.append(export)
    try:
        yield
    finally:
        _overrides.pop()


def _export_of_scene(scene: bpy.types.Scene) -> "Export | None":
    settings = getattr(scene, GROUP, None)
    if settings is None or not settings.use_mipmaps:
        return None
    from .export import Export

    return Export.of(scene)


def glTF2_pre_export_callback(export_settings: dict[str, Any]) -> None:  # noqa: N802
    """Starts an export if the scene has Prefilter Mipmaps on, with lossless pictures."""
    if export_settings["gltf_image_format"] == "NONE":
        return
    export = _overrides[-1] if _overrides else _export_of_scene(bpy.context.scene)
    if export is None:
        return
    export_settings[_KEY] = export
    export_settings["gltf_image_format"] = "AUTO"
    export_settings["gltf_add_webp"] = False
    export_settings["gltf_webp_fallback"] = True
    export_settings["gltf_keep_original_textures"] = False


class glTF2ExportUserExtension:
    """Hooks of an export; the exporter finds the class by its name."""

    def gather_image_hook(self, image: Any, *others: Any) -> None:
        """Applies the nodes between an image and the shader.

        The last two arguments are the shader's inputs and the settings; Blender 5.2 added another
        argument before them.
        """
        sockets, export_settings = others[-2:]
        if _KEY in export_settings:
            export_settings[_KEY].apply_nodes(image, sockets, export_settings)

    def gather_scene_hook(self, scene: Any, _: bpy.types.Scene, export_settings: Any) -> None:
        """Copies the triangles of a scene before the exporter compresses them."""
        if _KEY in export_settings:
            export_settings[_KEY].add_scene(scene)

    def gather_gltf_hook(
        self, _active: int, _scenes: Any, _animations: Any, export_settings: Any
    ) -> None:
        """Replaces pictures by KTX 2 files."""
        if _KEY in export_settings:
            export_settings[_KEY].replace_textures(export_settings)


class glTF2ImportUserExtension:
    """Hooks of an import; the importer finds the class by its name."""

    def __init__(self) -> None:
        """Announces KHR_texture_basisu, without which the importer refuses files that require
        it."""
        self.extensions = [SimpleNamespace(name="KHR_texture_basisu", required=True)]
        self._import: Any = None

    def gather_import_gltf_before_hook(self, gltf: Any) -> None:
        """Starts an import."""
        from .imports import Import, show_ktx2

        settings = getattr(bpy.context.scene, IMPORT_GROUP, None)
        self._import = Import(keep_levels=settings is not None and settings.keep_levels)
        show_ktx2(gltf)

    def gather_import_image_before_hook(self, image: Any, gltf: Any) -> None:
        """Replaces a KTX 2 file by a PNG file."""
        self._import.replace_image(image, gltf)

    def gather_import_image_after_hook(self, image: Any, blender_image: Any, _gltf: Any) -> None:
        """Stores the imported image."""
        self._import.add_image(image, blender_image)

    def gather_import_scene_after_animation_hook(self, _gltf_scene: Any, _: Any, gltf: Any) -> None:
        """Makes level images, after the materials have set the color spaces of images."""
        self._import.keep_levels(gltf)
