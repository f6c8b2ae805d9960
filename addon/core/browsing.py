# SPDX-License-Identifier: GPL-3.0-or-later

"""Operators that work on files, and ask for them in the file browser."""

import bpy

from .operator import BackgroundOperator


class BrowsingOperator(BackgroundOperator):
    """A mixin: opens the file browser where no file is named. A subclass has `is_named`."""

    layout: bpy.types.UILayout
    _is_browsing = False

    def is_named(self) -> bool:
        """Tells whether there is a file to work on."""
        raise NotImplementedError

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the redo panel, or the settings beside the files."""
        if self._is_browsing:
            self.draw_settings(context, self.layout)
        else:
            super().draw(context)

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Opens the file browser, unless a file is named."""
        if self.is_named() or bpy.app.background:
            return super().invoke(context, event)
        self.follow_scene(context)
        context.window_manager.fileselect_add(self)
        self._is_browsing = True
        return {"RUNNING_MODAL"}

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Works and waits; for the file browser, which cannot wait, another one works."""
        if self._is_browsing:
            self._is_browsing = False
            return self._start_again(use_apply=False)
        return super().execute(context)

    def cancel(self, context: bpy.types.Context) -> None:
        """Ends; there is nothing to stop yet while the file browser is open."""
        if not self._is_browsing:
            super().cancel(context)
