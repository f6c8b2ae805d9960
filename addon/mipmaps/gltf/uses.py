# SPDX-License-Identifier: GPL-3.0-or-later

"""What the materials of a glTF file take of its textures."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from .geometry import Transform

_COLORS = frozenset(
    {
        *("basecolortexture", "emissivetexture", "sheencolortexture", "specularcolortexture"),
        *("diffusetransmissioncolortexture", "diffusetexture", "specularglossinesstexture"),
    }
)
_NORMALS = "normaltexture"
_TRANSFORM = "KHR_texture_transform"
_CUTOFF = 0.5


@dataclass(frozen=True)
class Use:
    """A texture of a material.

    Attributes:
        info: The exporter's reference to it, in the material.
        role: "color", "normal" or "data".
        name: What the material calls it, in lower case without "_".
        tex_coord: The set of texture coordinates.
        transform: Of these.
        covers: Whether its alpha says how much of a texel is covered.
        threshold: Of the alpha test; None for none.
    """

    info: Any
    role: str
    name: str
    tex_coord: int
    transform: Transform
    covers: bool
    threshold: float | None

    @property
    def texture(self) -> Any:
        """The exporter's texture."""
        return self.info.index


def uses(primitive: Any) -> Iterator[Use]:
    """Yields the textures of the materials of a primitive, those of variants included."""
    for material in _materials(primitive):
        for name, info in _infos("", material):
            yield _use(material, name, info)


def _use(material: Any, name: str, info: Any) -> Use:
    role = "color" if name in _COLORS else "normal" if name.endswith(_NORMALS) else "data"
    is_base = name == "basecolortexture"
    threshold = None
    if is_base and material.alpha_mode == "MASK":
        cutoff = _CUTOFF if material.alpha_cutoff is None else material.alpha_cutoff
        factor = (material.pbr_metallic_roughness.base_color_factor or (1.0,))[-1]
        threshold = cutoff / factor if factor > 0.0 else None
    return Use(
        info,
        role,
        name,
        info.tex_coord or 0,
        _transform(info),
        is_base and material.alpha_mode in {"MASK", "BLEND"},
        threshold if threshold is not None and 0.0 < threshold <= 1.0 else None,
    )


def _transform(info: Any) -> Transform:
    found = (info.extensions or {}).get(_TRANSFORM, {})
    found = getattr(found, "extension", found)
    left, top = found.get("offset", (0.0, 0.0))
    wide, high = found.get("scale", (1.0, 1.0))
    return (left, top), found.get("rotation", 0.0), (wide, high)


def _materials(primitive: Any) -> Iterator[Any]:
    if primitive.material is not None:
        yield primitive.material
    variants = (primitive.extensions or {}).get("KHR_materials_variants")
    for mapping in getattr(variants, "extension", {}).get("mappings", ()):
        if hasattr(mapping.get("material"), "pbr_metallic_roughness"):
            yield mapping["material"]


def _infos(name: str, node: Any) -> Iterator[tuple[str, Any]]:
    """Yields what refers to a texture in a material, and its name there."""
    if hasattr(node, "tex_coord"):
        yield name.replace("_", "").lower(), node
    elif isinstance(node, dict):
        for key, value in node.items():
            yield from _infos(key, value)
    elif hasattr(node, "extension"):
        yield from _infos(name, node.extension)
    elif type(node).__module__.endswith("gltf2_io"):
        yield from _infos(name, vars(node))
