# SPDX-License-Identifier: GPL-3.0-or-later

"""What Blender's glTF exporter calls while it works."""

from typing import Any

import bpy

from .properties import GROUP

_KEY = "prefilter"


def glTF2_pre_export_callback(export_settings: dict[str, Any]) -> None:  # noqa: N802
    """Begins an export if the scene wants mipmaps; pictures are then to come without loss."""
    settings = getattr(bpy.context.scene, GROUP, None)
    if settings is None or not settings.use_mipmaps:
        return
    if export_settings["gltf_image_format"] == "NONE":
        return
    from .export import Export

    export_settings[_KEY] = Export.of(bpy.context.scene)
    export_settings["gltf_image_format"] = "AUTO"
    export_settings["gltf_add_webp"] = False
    export_settings["gltf_webp_fallback"] = True
    export_settings["gltf_keep_original_textures"] = False


class glTF2ExportUserExtension:
    """Hooks; the exporter finds the class by its name."""

    def gather_scene_hook(self, scene: Any, _: bpy.types.Scene, export_settings: Any) -> None:
        """Copies what the file shows of a scene, before the exporter compresses it."""
        if _KEY in export_settings:
            export_settings[_KEY].add_scene(scene)

    def gather_gltf_hook(
        self, _active: int, _scenes: Any, _animations: Any, export_settings: Any
    ) -> None:
        """Puts KTX 2 files in the place of pictures."""
        if _KEY in export_settings:
            export_settings[_KEY].replace_textures(export_settings)
