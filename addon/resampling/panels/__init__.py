"""Where a user finds what is done to images: the Image editor's sidebar, and Image > Prefilter."""

from ...core.registration import registration
from . import resample, resize

register, unregister = registration(resize, resample)
