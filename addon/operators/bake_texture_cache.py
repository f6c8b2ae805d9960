"""`prefilter.bake_texture_cache`: PAM levels for Cycles, for every image of the scene."""

import bpy

from .. import texture_cache
from ..bridge import tx_files
from .background import BackgroundOperator, Work


class PREFILTER_OT_bake_texture_cache(BackgroundOperator, bpy.types.Operator):
    """Bakes PAM into Cycles' texture cache."""

    bl_idname = "prefilter.bake_texture_cache"
    bl_label = "Bake PAM into Texture Cache"
    bl_description = (
        "Make the texture cache of the scene's images, and replace its levels with ones that are "
        "right for the meshes that wear them. Overwrites cache files; when an image file changes, "
        "Blender makes its cache file anew, and it has to be baked again"
    )
    bl_options = {"REGISTER", "UNDO"}
    doing = "Baking PAM into the texture cache"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Tells whether this Blender has a texture cache, and there is an image to bake."""
        if cls.bl_idname in cls._running:
            cls.poll_message_set("It is running; press Esc to cancel it")
            return False
        if not tx_files.is_available():
            cls.poll_message_set(texture_cache.NEEDED)
            return False
        if context.scene is None or not bpy.data.images:
            cls.poll_message_set("There is no image in this file")
            return False
        return True

    def read(self, context: bpy.types.Context) -> Work:
        """Copies the surfaces of the scene."""
        depsgraph = context.evaluated_depsgraph_get()
        self._bake = texture_cache.CacheBake.read(context.scene, depsgraph)
        return self._bake.compute

    def finish(self, context: bpy.types.Context, result: None) -> str:
        """Puts the files into place."""
        del context, result
        outcome = self._bake.write()
        self.warn(outcome)
        return outcome.summary

    def discard(self) -> None:
        """Removes what was staged."""
        self._bake.discard()
