"""Seeing mipmaps: levels drawn in the editor, their errors as a figure, the weights of texels."""

from . import overlay, preview, state

_PARTS = (state, preview, overlay)


def register() -> None:
    """Registers what editors need to draw levels."""
    for part in _PARTS:
        part.register()


def unregister() -> None:
    """Unregisters it, in reverse."""
    for part in reversed(_PARTS):
        part.unregister()
