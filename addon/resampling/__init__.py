"""Images of other sizes."""

from ..core.registration import registration
from . import operators, panel, properties

register, unregister = registration(properties, operators, panel)
