"""Where a user finds mipmaps: the Image and UV editors, and Cycles' render properties."""

from ...core.registration import registration
from . import image_editor, seeing, texture_cache

register, unregister = registration(image_editor, seeing, texture_cache)
