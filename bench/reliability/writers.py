# SPDX-License-Identifier: GPL-3.0-or-later

"""Everything that writes files: writers of the package, the command, and the commands of Blender.

usage: writers.py NAME SOURCES OUT [COUNT]     (Blender's in a Blender, behind --)
       writers.py copies

Runs one, COUNT times in turn, into a folder: `SOURCES` holds the output of `make_sources`. It
prints a line before each, and exits with the status of the last one. With "copies" it reads lines
of NAME, SOURCES and OUT with tabs between, and runs each again and again in a copy of this process,
which must not have used threads, until that is killed. It prints the copy's number before, and
"ended" after that.
"""

import contextlib
import functools
import os
import re
import shutil
import sys
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from bench.report import Report

SIDE = 64
# More runs than any test reaches.
MANY = 1000000
# A scene with its images, and Blender's texture cache of them.
CACHED = "cached"


@dataclass(frozen=True)
class Writer:
    """A writer of a file, or of a set of files.

    Attributes:
        name: Its name in tables.
        arguments: The command's arguments; "in/" and "out/" stand for folders. Empty for the
            package's own.
        targets: The names of its output files.
        call: For the package: a function that writes into a folder.
        is_blenders: Whether it is a command of Blender.
        in_place: The name of a source that it overwrites: a file, copied to the output folder, or
            a folder of files.
    """

    name: str
    arguments: str = ""
    targets: tuple[str, ...] = ()
    call: Callable[[Path, Path], object] | None = None
    is_blenders: bool = False
    in_place: str = ""

    @property
    def kind(self) -> str:
        """The program that has it."""
        if self.call is not None:
            return "package"
        return "blender" if self.is_blenders else "command"

    def missing(self, sources: Path) -> str:
        """Returns the missing module or source; empty if there is none."""
        if self.in_place and not (sources / self.in_place).exists():
            return self.in_place
        needed = ("OpenImageIO", "trimesh") if self.kind == "command" else ()
        return next((name for name in needed if find_spec(name) is None), "")

    def run(self, sources: Path, out: Path) -> int:
        """Runs it once; returns the exit status."""
        if self.call is not None:
            try:
                self.call(sources, out)
            except OSError as error:
                print(f"error: {error}", file=sys.stderr)
                return 1
            return 0
        words = [
            word.replace("in/", f"{sources}/", 1) if word.startswith("in/") else word
            for word in self.arguments.split()
        ]
        words = [
            word.replace("out/", f"{out}/", 1) if word[:4] == "out/" else word for word in words
        ]
        if self.is_blenders:
            import bl_ext.user_default.prefilter as addon

            return int(addon.Commands(addon.SUBJECTS).run(words))
        from prefilter.commands import program

        return program.main(words)


def _levels() -> list[np.ndarray[Any, Any]]:
    values = np.random.default_rng(1).integers(0, 255, (SIDE, SIDE, 4), np.uint8)
    return [values[: SIDE >> i, : SIDE >> i].copy() for i in range(SIDE.bit_length())]


def _exr(_: Path, out: Path) -> None:
    import prefilter

    levels = [level.astype(np.float32) / 255 for level in _levels()]
    prefilter.write_exr(out / "out.exr", levels)


def _ktx2(_: Path, out: Path) -> None:
    import prefilter

    prefilter.write_ktx2(out / "out.ktx2", _levels(), format="rgba8")


def _dds(_: Path, out: Path) -> None:
    import prefilter

    prefilter.write_dds(out / "out.dds", _levels(), format="bc1")


def _table(_: Path, out: Path) -> None:
    import prefilter

    prefilter.SamplingTable.build("tent", texels=2).save(out / "out.json")


def _octree(_: Path, out: Path) -> None:
    import prefilter

    prefilter.voxelize(*_solid(), depth=4).save(out / "out.npz")


def _surface(sources: Path, out: Path) -> None:
    import prefilter

    prefilter.reconstruct_file(sources / "scan.ply", out / "out.ply", depth=5)


PNGS = tuple(f"out.{i:02d}.png" for i in range(SIDE.bit_length()))
_MORE = {".obj": ("out.mtl",), ".gltf": ("out.bin",)}
MESHES = (".obj", ".ply", ".stl", ".glb", ".gltf", ".fbx", ".blend")


def _blenders(name: str, arguments: str, *targets: str, **more: Any) -> Writer:
    return Writer(name, arguments, targets, is_blenders=True, **more)


WRITERS = [
    Writer("write_exr", call=_exr, targets=("out.exr",)),
    Writer("write_ktx2", call=_ktx2, targets=("out.ktx2",)),
    Writer("write_dds", call=_dds, targets=("out.dds",)),
    Writer("SamplingTable.save", call=_table, targets=("out.json",)),
    Writer("Octree.save", call=_octree, targets=("out.npz",)),
    Writer("reconstruct_file", call=_surface, targets=("out.ply",)),
    *(
        Writer(
            f"mipmaps to {ending}", f"mipmaps in/paint.png -o out/out{ending}", (f"out{ending}",)
        )
        for ending in (".exr", ".tif", ".dds", ".ktx2")
    ),
    Writer("mipmaps to .png", "mipmaps in/paint.png -o out/out.png", PNGS),
    *(
        Writer(
            f"resize to {ending}",
            f"resize in/paint.png -o out/out{ending} --percent 50",
            (f"out{ending}",),
        )
        for ending in (".png", ".exr")
    ),
    Writer("resample", "resample in/paint.png -o out/out.png --rotate 30", ("out.png",)),
    Writer(
        "sampling-table",
        "sampling-table -o out/out.json -o out/out.hlsl --filter tent --texels 2",
        ("out.json", "out.hlsl"),
    ),
    *(
        Writer(
            f"voxelize to {ending}",
            f"voxelize in/solid.ply -o out/out{ending} --depth 4",
            (f"out{ending}",),
        )
        for ending in (".obj", ".ply", ".stl", ".glb")
    ),
    Writer(
        "boolean",
        "boolean in/solid.ply in/solid.ply --operation union --output out/out.ply --depth 4",
        ("out.ply",),
    ),
    Writer("rasterize", "rasterize in/drawing.svg -o out/out.png --side 64", ("out.png",)),
    Writer("reconstruct", "reconstruct in/scan.ply -o out/out.ply --depth 5", ("out.ply",)),
    *(
        _blenders(
            f"voxelize to {ending}",
            f"voxelize in/solid.ply -o out/out{ending} --depth 4",
            f"out{ending}",
            *_MORE.get(ending, ()),
        )
        for ending in MESHES
    ),
    _blenders(
        "boolean",
        "boolean in/solid.ply in/solid.ply --operation union --output out/out.ply --depth 4",
        "out.ply",
    ),
    _blenders("reconstruct to .ply", "reconstruct in/scan.ply -o out/out.ply --depth 5", "out.ply"),
    _blenders("reconstruct to .glb", "reconstruct in/scan.ply -o out/out.glb --depth 5", "out.glb"),
    *(
        _blenders(
            f"bake to {ending}",
            f"bake in/scene.blend --image paint.png --output out/out{ending}",
            *(PNGS if ending == ".png" else (f"out{ending}",)),
        )
        for ending in (".exr", ".tif", ".dds", ".ktx2", ".png")
    ),
    _blenders(
        "bake --all",
        "bake in/scene.blend --all --output out/ --manifest out/all.json",
        "paint.ktx2",
        "other.ktx2",
        "all.json",
    ),
    _blenders("bake to .glb", "bake in/scene.blend --all --output out/out.glb", "out.glb"),
    _blenders(
        "bake to .gltf",
        "bake in/scene.blend --all --output out/out.gltf",
        "out.gltf",
        "out.bin",
        "paint.ktx2",
        "other.ktx2",
    ),
    _blenders(
        "bake --save",
        "bake out/scene.blend --image paint.png --save",
        "scene.blend",
        in_place="scene.blend",
    ),
    _blenders("bake-cache", "bake-cache out/scene.blend", in_place=CACHED),
    _blenders(
        "plot",
        "plot in/scene.blend --image paint.png --output out/out.png --table out/out.csv",
        "out.png",
        "out.csv",
    ),
    _blenders("resize", "resize in/paint.png -o out/out.png --percent 50", "out.png"),
    _blenders("resample", "resample in/paint.png -o out/out.exr --rotate 30", "out.exr"),
    _blenders("rasterize", "rasterize in/drawing.svg -o out/out.png --side 64", "out.png"),
]


def of_kind(*kinds: str) -> list[Writer]:
    """Returns the writers of some programs."""
    return [writer for writer in WRITERS if writer.kind in kinds]


def chosen(pattern: str, kinds: Iterable[str], sources: Path, told: "Report") -> Iterator[Writer]:
    """Yields the writers that a pattern names and that can run here; says which cannot."""
    for writer in of_kind(*kinds):
        if not re.search(pattern, f"{writer.kind} {writer.name}"):
            continue
        if missing := writer.missing(sources):
            told.note(f"{writer.kind} {writer.name} left out: there is no {missing}")
            continue
        yield writer


def named(kind: str, name: str) -> Writer:
    """Returns a writer."""
    return next(one for one in WRITERS if (one.kind, one.name) == (kind, name))


def _ball() -> np.ndarray[Any, Any]:
    angles = np.random.default_rng(2).normal(size=(4000, 3))
    return angles / np.linalg.norm(angles, axis=1, keepdims=True)


def _solid() -> tuple[np.ndarray[Any, Any], np.ndarray[Any, Any]]:
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
    sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    triangles = [t for a, b, c, d in sides for t in ((a, b, c), (a, c, d))]
    return corners, np.array(triangles)


def make_sources(folder: Path) -> None:
    """Writes the sources, except the scene, which Blender makes."""
    from prefilter.workflows.files import png

    noise = np.random.default_rng(3)
    for name in ("paint.png", "other.png"):
        pixels = noise.integers(0, 255, (SIDE, SIDE, 3), np.uint8)
        (folder / name).write_bytes(png.encoded(pixels))
    (folder / "drawing.svg").write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 9 9">'
        '<circle cx="4" cy="4" r="3"/></svg>'
    )
    corners, triangles = _solid()
    _write_ply(folder / "solid.ply", "x y z", corners, triangles)
    points = _ball()
    _write_ply(folder / "scan.ply", "x y z nx ny nz", np.hstack([points, points]), None)


def _write_ply(path: Path, names: str, rows: np.ndarray[Any, Any], faces: Any) -> None:
    lines = ["ply", "format ascii 1.0", f"element vertex {len(rows)}"]
    lines += [f"property float {name}" for name in names.split()]
    if faces is not None:
        lines += [f"element face {len(faces)}", "property list uchar int vertex_indices"]
    lines += ["end_header", *(" ".join(f"{value:.6f}" for value in row) for row in rows)]
    lines += [f"3 {a} {b} {c}" for a, b, c in faces] if faces is not None else []
    path.write_text("\n".join(lines) + "\n")


def make_scene(folder: Path) -> None:
    """Makes a .blend file whose cube has two textures, in a Blender.

    And a folder of it and a texture cache, where this Blender has one.
    """
    import bpy

    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    bpy.ops.mesh.primitive_cube_add()
    material = bpy.data.materials.new("Painted")
    if bpy.app.version < (5, 0, 0):
        material.use_nodes = True
    tree = material.node_tree
    principled = next(node for node in tree.nodes if node.type == "BSDF_PRINCIPLED")
    for name, socket in (("paint.png", "Base Color"), ("other.png", "Emission Color")):
        node = tree.nodes.new("ShaderNodeTexImage")
        node.image = bpy.data.images.load(str(folder / name))
        tree.links.new(node.outputs["Color"], principled.inputs[socket])
    bpy.context.object.data.materials.append(material)
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / "scene.blend"), relative_remap=False)
    import _cycles

    if not hasattr(_cycles, "maketx"):
        return
    (folder / CACHED).mkdir(exist_ok=True)
    bpy.context.scene.render.engine = "CYCLES"
    for image in [image for image in bpy.data.images if image.filepath]:
        copied = shutil.copy2(image.filepath, folder / CACHED)
        _cycles.maketx(copied, colorspace="sRGB", alpha_type="straight", cache_dir="")
        image.filepath = f"//{Path(copied).name}"
    path = str(folder / CACHED / "scene.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path, relative_remap=False)


@functools.cache
def _output() -> int:
    # Blender's commands redirect output: after one, prints go to standard error.
    return os.dup(1)


def say(line: str) -> None:
    """Prints a line by itself, whatever Blender prints."""
    os.write(_output(), f"\n{line}\n".encode())


def run_copies() -> None:
    """Runs writers in copies of this process, as the module says."""
    for line in sys.stdin:
        child = os.fork()
        if not child:
            nowhere = os.open(os.devnull, os.O_RDWR)
            os.dup2(nowhere, 0)
            os.dup2(nowhere, 2)
            with contextlib.suppress(BaseException):
                main([*line.rstrip("\n").split("\t"), str(MANY)])
            os._exit(1)
        say(f"number {child}")
        os.waitpid(child, 0)
        say("ended")


def main(arguments: list[str]) -> int:
    """Runs a writer, as the module says."""
    if arguments[0] == "scene":
        make_scene(Path(arguments[1]))
        return 0
    if arguments[0] == "copies":
        run_copies()
        return 0
    kind, name = arguments[0].split(":")
    sources, out = Path(arguments[1]), Path(arguments[2])
    writer, status = named(kind, name), 1
    for _ in range(int(arguments[3]) if len(arguments) > 3 else 1):
        say("begins")
        status = writer.run(sources, out)
    return status


if __name__ == "__main__":
    found = main(sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else sys.argv[1:])
    sys.stdout.flush()
    sys.stderr.flush()
    sys.exit(found)
