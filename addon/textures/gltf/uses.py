# SPDX-License-Identifier: GPL-3.0-or-later

"""The uses of textures in the materials of a glTF file."""

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
    """The use of a texture in a material.

    Attributes:
        info: The exporter's reference to the texture, in the material.
        role: "color", "normal" or "data".
        name: The property of the material, in lower case without "_".
        tex_coord: The set of texture coordinates.
        transform: The transform of the texture coordinates.
        covers: Whether alpha is coverage.
        threshold: The threshold of the alpha test; None for none.
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
    """Yields the textures of a primitive's materials, including those of variants."""
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
    transform = (info.extensions or {}).get(_TRANSFORM, {})
    transform = getattr(transform, "extension", transform)
    left, top = transform.get("offset", (0.0, 0.0))
    wide, high = transform.get("scale", (1.0, 1.0))
    return (left, top), transform.get("rotation", 0.0), (wide, high)


def _materials(primitive: Any) -> Iterator[Any]:
    if primitive.material is not None:
        yield primitive.material
    variants = (primitive.extensions or {}).get("KHR_materials_variants")
    for mapping in getattr(variants, "extension", {}).get("mappings", ()):
        if hasattr(mapping.get("material"), "pbr_metallic_roughness"):
            yield mapping["material"]


def _infos(name: str, node: Any) -> Iterator[tuple[str, Any]]:
    """Yields the references to textures in a material, with their property names."""
    if hasattr(node, "tex_coord"):
        yield name.replace("_", "").lower(), node
    elif isinstance(node, dict):
        for key, value in node.items():
            yield from _infos(key, value)
    elif hasattr(node, "extension"):
        yield from _infos(name, node.extension)
    elif type(node).__module__.endswith("gltf2_io"):
        yield from _infos(name, vars(node))
