"""Images of other sizes and in other places."""

from ..core.registration import registration
from . import operators, panels, properties

register, unregister = registration(properties, operators, panels)
