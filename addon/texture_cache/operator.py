# SPDX-License-Identifier: GPL-3.0-or-later

"""`prefilter.bake_texture_cache`: PAM levels for Cycles, for every image of the scene."""

from typing import TYPE_CHECKING

import bpy
from bpy.props import BoolProperty

from ..core.operator import WorkOperator
from ..core.operator_hooks import LONG_WORK
from ..core.preferences import preference
from ..core.translations import CONTEXT, tr

if TYPE_CHECKING:
    from .bake import CacheBake


ICON = "FILE_CACHE"


class PREFILTER_OT_bake_texture_cache(WorkOperator, bpy.types.Operator):
    """Bakes PAM into Cycles' texture cache."""

    bl_idname = "prefilter.bake_texture_cache"
    bl_label = "Bake into Texture Cache"
    bl_description = (
        "Generate the texture cache of the scene's images, and replace its levels with "
        "parameterization-aware mipmaps (PAM), fitted to the meshes that use the images. "
        "Overwrites cache files. When an image file changes, Blender generates its cache again, "
        "and you need to bake again"
    )
    bl_options = {"REGISTER", "UNDO"}
    use_unpack: BoolProperty(
        name="Unpack Images",
        translation_context=CONTEXT,
        description="Write packed images to the folder textures beside the .blend file first, and "
        "use these files: Cycles caches only files",
        default=False,
        options={"SKIP_SAVE"},
    )

    use_others: BoolProperty(
        name="Without Packed Images",
        translation_context=CONTEXT,
        description="Bake the images that are files, and do not ask about packed ones",
        default=False,
        options={"HIDDEN", "SKIP_SAVE"},
    )

    activity = "Baking PAM into the texture cache"
    queue_name = LONG_WORK

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Returns whether this Blender has a texture cache, and the file has an image."""
        from ..bridge.files import tx
        from .bake import NEEDED

        if not tx.is_available():
            cls.poll_message_set(tr(NEEDED))
            return False
        if context.scene is None or not bpy.data.images:
            cls.poll_message_set(tr("There is no image in this file"))
            return False
        return True

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Bakes; first asks how to handle packed images."""
        from . import states

        if bpy.app.background or self.use_unpack or self.use_others:
            return super().invoke(context, event)
        images = states.current_states(context)
        packed = sum(image.state == "packed" for image in images)
        if not packed:
            return super().invoke(context, event)
        _ask(context, packed, len(images))
        return {"CANCELLED"}

    def read_work(self, context: bpy.types.Context) -> "CacheBake":
        """Copies the surfaces of the scene."""
        from .bake import CacheBake

        depsgraph = context.evaluated_depsgraph_get()
        return CacheBake.read(
            context.scene, depsgraph, unpack=self.use_unpack, threads=preference("threads", 0)
        )


def _ask(context: bpy.types.Context, packed: int, total: int) -> None:
    """Opens a menu with the choices for packed images, which Cycles does not cache."""

    def draw(menu: bpy.types.Menu, _: bpy.types.Context) -> None:
        name = PREFILTER_OT_bake_texture_cache.bl_idname
        menu.layout.operator_context = "INVOKE_DEFAULT"
        unpacking = menu.layout.operator(name, text="Unpack and Bake", icon="PACKAGE")
        unpacking.use_unpack = True
        if packed < total:
            without_packed = menu.layout.operator(name, text="Bake the Other Images", icon=ICON)
            without_packed.use_others = True

    title = tr("{} of {} images are packed, and Cycles caches only files").format(packed, total)
    context.window_manager.popup_menu(draw, title=title, icon="QUESTION")


register, unregister = bpy.utils.register_classes_factory((PREFILTER_OT_bake_texture_cache,))
