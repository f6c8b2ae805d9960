# SPDX-License-Identifier: GPL-3.0-or-later

"""Operators that ask for a file in the file browser."""

import bpy

from .operator import BackgroundOperator


class FileBrowserOperator(BackgroundOperator):
    """A mixin: opens the file browser if no file is given. A subclass has `has_file`."""

    layout: bpy.types.UILayout
    _is_browsing = False

    def has_file(self) -> bool:
        """Returns whether a file is given."""
        raise NotImplementedError

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the redo panel, or the settings beside the files."""
        if self._is_browsing:
            self.draw_settings(context, self.layout)
        else:
            super().draw(context)

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Opens the file browser, unless a file is given."""
        if self.has_file() or bpy.app.background:
            return super().invoke(context, event)
        self.follow_scene(context)
        context.window_manager.fileselect_add(self)
        self._is_browsing = True
        return {"RUNNING_MODAL"}

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Works and blocks; the file browser must not block, so it starts a second operator."""
        if self._is_browsing:
            self._is_browsing = False
            return self._start_again(use_apply=False)
        return super().execute(context)

    def cancel(self, context: bpy.types.Context) -> None:
        """Ends the work; while the file browser is open, none has started."""
        if not self._is_browsing:
            super().cancel(context)
