# SPDX-License-Identifier: GPL-3.0-or-later

"""Exports forty glTF files of odd sizes, roles and settings, for bench/textures/check_exports.py.

Usage: blender --background --python-exit-code 1 --python bench/textures/exports.py [-- --help]

Every size goes with every role; the settings take turns. The extension has to be installed and
enabled.
"""

import argparse
import json
import sys
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import bpy
import numpy as np

FOLDER = Path(__file__).resolve().parents[2] / "build/exports"
SIZES = ((1, 1), (3, 5), (250, 334), (1000, 1000), (2048, 4))
TILES = (1001, 1002)


@dataclass(frozen=True)
class Case:
    """An export.

    Attributes:
        role: The images' role in the material, a key of `ROLES`.
        size: The images' size in texels.
        texture_format: The format of the KTX 2 files.
        supercompression: The supercompression of the KTX 2 files.
        fallback: The images exported beside the KTX 2 files.
        kind: The exporter's own name for the file type.
        draco: Whether meshes are compressed.
    """

    role: str
    size: tuple[int, int]
    texture_format: str
    supercompression: str
    fallback: str
    kind: str
    draco: bool

    @property
    def name(self) -> str:
        """The name of the file."""
        width, height = self.size
        parts = [self.role, f"{width}x{height}", self.texture_format, self.supercompression]
        parts += [self.fallback, *(["draco"] if self.draco else [])]
        return "-".join(parts) + (".glb" if self.kind == "GLB" else ".gltf")


def cases() -> list[Case]:
    """Returns forty cases."""
    found = []
    for number, (role, size) in enumerate((role, size) for role in ROLES for size in SIZES):
        found.append(
            Case(
                role,
                size,
                ("uastc", "etc1s")[number % 2],
                ("zstd", "none")[number // 2 % 2],
                ("none", "picture")[number // 3 % 2],
                ("GLB", "GLTF_SEPARATE")[number // 4 % 2],
                number % 5 == 2,
            )
        )
    return found


def main() -> None:
    """Exports the cases into folders of their own, and lists them."""
    arguments = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else []
    parser = argparse.ArgumentParser(prog="exports.py", description=__doc__.splitlines()[0])
    parser.add_argument("--folder", type=Path, default=FOLDER, help="default: %(default)s")
    parser.add_argument("--only", default="", help="those whose names hold this")
    options = parser.parse_args(arguments)
    options.folder.mkdir(parents=True, exist_ok=True)
    found = [case for case in cases() if options.only in case.name]
    for case in found:
        path = options.folder / case.name.rpartition(".")[0] / case.name
        path.parent.mkdir(exist_ok=True)
        make(case, path.parent)
        export(case, path)
        print(f"{case.name}: {path.stat().st_size} bytes", flush=True)
    listing = [{"name": case.name, **asdict(case)} for case in found]
    (options.folder / "exports.json").write_text(json.dumps(listing, indent=1))


def make(case: Case, folder: Path) -> None:
    """Makes a scene of one mesh, with a material of the images of its role."""
    bpy.ops.wm.read_homefile(use_empty=True)
    bpy.ops.mesh.primitive_uv_sphere_add(segments=16, ring_count=8)
    mesh = bpy.context.active_object
    if case.role == "udim":
        uvs = mesh.data.uv_layers.active.data
        for polygon in mesh.data.polygons:
            if polygon.index % 2:
                for corner in polygon.loop_indices:
                    uvs[corner].uv.x += 1.0
    material = bpy.data.materials.new("Material")
    if material.node_tree is None:  # Blender 5 and later makes it.
        material.use_nodes = True
    mesh.data.materials.append(material)
    ROLES[case.role](material, case.size, folder)


def export(case: Case, path: Path) -> None:
    """Exports the scene by Blender's own exporter."""
    settings = bpy.context.scene.prefilter_gltf
    settings.use_mipmaps = True
    settings.texture_format = case.texture_format
    settings.supercompression = case.supercompression
    settings.fallback = case.fallback
    more: dict[str, Any] = {"export_draco_mesh_compression_enable": True} if case.draco else {}
    bpy.ops.export_scene.gltf(filepath=str(path), export_format=case.kind, **more)


def image(
    name: str, size: tuple[int, int], *, is_data: bool = False, alpha: bool = False
) -> bpy.types.Image:
    """Returns an image of waves and noise, packed."""
    width, height = size
    made = bpy.data.images.new(name, width, height, alpha=alpha)
    if is_data:
        made.colorspace_settings.name = "Non-Color"
    made.pixels.foreach_set(texels(size, sum(name.encode()), alpha=alpha).ravel())
    made.pack()
    return made


def texels(size: tuple[int, int], seed: int, *, alpha: bool) -> np.ndarray:
    """Returns (height, width, 4) values."""
    width, height = size
    random = np.random.default_rng(seed)
    y, x = np.mgrid[:height, :width] / max(size)
    waves = np.stack([np.sin(9 * x + c) * np.cos(7 * y + 2 * c) for c in range(4)], axis=2)
    values = 0.5 + 0.4 * waves + 0.1 * (random.random((height, width, 4)) - 0.5)
    values[..., 3] = values[..., 3] > 0.4 if alpha else 1.0
    return values.astype(np.float32)


def color(material: Any, size: tuple[int, int], _: Path) -> None:
    """A base color."""
    link(material, node(material, image("Color", size)).outputs[0], "Base Color")


def normal(material: Any, size: tuple[int, int], _: Path) -> None:
    """A normal map, paired with a roughness."""
    tree = material.node_tree
    found = tree.nodes.new("ShaderNodeNormalMap")
    tree.links.new(node(material, image("Normal", size, is_data=True)).outputs[0], found.inputs[1])
    link(material, found.outputs[0], "Normal")
    link(material, node(material, image("Rough", size, is_data=True)).outputs[0], "Roughness")


def packed(material: Any, size: tuple[int, int], _: Path) -> None:
    """Occlusion, roughness and metallic in one image."""
    parts = separated(material, node(material, image("ORM", size, is_data=True)))
    occlusion(material, parts.outputs[0])
    link(material, parts.outputs[1], "Roughness")
    link(material, parts.outputs[2], "Metallic")


def composed(material: Any, size: tuple[int, int], _: Path) -> None:
    """Roughness and metallic of two images, which the exporter composes."""
    for name, socket in (("Rough", "Roughness"), ("Metal", "Metallic")):
        link(material, node(material, image(name, size, is_data=True)).outputs[0], socket)


def emission(material: Any, size: tuple[int, int], _: Path) -> None:
    """A material with an emission image."""
    shader = principled(material)
    name = "Emission Color" if "Emission Color" in shader.inputs else "Emission"
    shader.inputs["Emission Strength"].default_value = 1.0
    link(material, node(material, image("Glow", size)).outputs[0], name)


def cutout(material: Any, size: tuple[int, int], _: Path) -> None:
    """A base color with an alpha test."""
    tree = material.node_tree
    found = node(material, image("Leaf", size, alpha=True))
    link(material, found.outputs[0], "Base Color")
    test = tree.nodes.new("ShaderNodeMath")
    test.operation = "GREATER_THAN"
    test.inputs[1].default_value = 0.5
    tree.links.new(found.outputs[1], test.inputs[0])
    link(material, test.outputs[0], "Alpha")


def both(material: Any, size: tuple[int, int], _: Path) -> None:
    """Base color and occlusion at once."""
    found = node(material, image("Both", size))
    link(material, found.outputs[0], "Base Color")
    occlusion(material, separated(material, found).outputs[0])


def udim(material: Any, size: tuple[int, int], folder: Path) -> None:
    """A base color of two tiles."""
    folder.mkdir(exist_ok=True)
    for tile in TILES:
        one = image(f"Tile {tile}", size)
        one.filepath_raw, one.file_format = str(folder / f"paint.{tile}.png"), "PNG"
        one.save()
        bpy.data.images.remove(one)
    tiled = bpy.data.images.load(str(folder / "paint.1001.png"))
    tiled.source = "TILED"
    tiled.filepath = str(folder / "paint.<UDIM>.png")
    for tile in TILES[1:]:
        if not any(known.number == tile for known in tiled.tiles):
            tiled.tiles.new(tile)
    link(material, node(material, tiled).outputs[0], "Base Color")


def principled(material: Any) -> Any:
    """Returns the shader of a material."""
    return next(one for one in material.node_tree.nodes if one.type == "BSDF_PRINCIPLED")


def node(material: Any, shown: bpy.types.Image) -> Any:
    """Returns a new node that shows an image."""
    made = material.node_tree.nodes.new("ShaderNodeTexImage")
    made.image = shown
    return made


def link(material: Any, socket: Any, name: str) -> None:
    """Links a socket to an input of the shader."""
    material.node_tree.links.new(socket, principled(material).inputs[name])


def separated(material: Any, shown: Any) -> Any:
    """Returns a node that has the channels of an image."""
    made = material.node_tree.nodes.new("ShaderNodeSeparateColor")
    material.node_tree.links.new(shown.outputs[0], made.inputs[0])
    return made


def occlusion(material: Any, socket: Any) -> None:
    """Has the exporter take a socket as the occlusion."""
    group = bpy.data.node_groups.new("glTF Material Output", "ShaderNodeTree")
    group.interface.new_socket("Occlusion", in_out="INPUT", socket_type="NodeSocketFloat")
    made = material.node_tree.nodes.new("ShaderNodeGroup")
    made.node_tree = group
    material.node_tree.links.new(socket, made.inputs["Occlusion"])


ROLES: dict[str, Callable[[Any, tuple[int, int], Path], None]] = {
    "color": color,
    "normal": normal,
    "packed": packed,
    "composed": composed,
    "emission": emission,
    "cutout": cutout,
    "both": both,
    "udim": udim,
}

if __name__ == "__main__":
    main()
