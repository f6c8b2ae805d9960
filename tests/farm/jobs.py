# SPDX-License-Identifier: GPL-3.0-or-later

"""Inputs of the tests' farm jobs, and the Blender that runs them."""

import os
import struct
import subprocess
import zlib
from pathlib import Path

import pytest

np = pytest.importorskip("numpy")

FARM = Path(__file__).parents[2] / "addon" / "farm"
BLENDER = os.environ.get("PREFILTER_BLENDER_COMMAND", "")

needs_blender = pytest.mark.skipif(not BLENDER, reason="no Blender with the extension is named")


def run(*command: object) -> str:
    """Runs a program that is to succeed, and returns its output."""
    words = [str(word) for word in command]
    done = subprocess.run(words, capture_output=True, text=True, timeout=1500)
    assert done.returncode == 0, done.stdout[-4000:] + done.stderr[-4000:]
    return done.stdout


def has_texture_cache() -> bool:
    return run(BLENDER, "--version") >= "Blender 5.2"


def write_png(path: Path, seed: int) -> None:
    pixels = np.random.default_rng(seed).integers(0, 256, (16, 16, 3), np.uint8)
    rows = b"".join(b"\0" + row.tobytes() for row in pixels)
    parts = (
        (b"IHDR", struct.pack(">IIBBBBB", 16, 16, 8, 2, 0, 0, 0)),
        (b"IDAT", zlib.compress(rows)),
        (b"IEND", b""),
    )
    data = b"".join(
        struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
        for kind, body in parts
    )
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + data)


def write_model(folder: Path) -> Path:
    """Writes two squares, each with a picture."""
    lines = ["mtllib model.mtl", "vt 0 0", "vt 1 0", "vt 1 1", "vt 0 1"]
    materials = []
    for number in range(2):
        write_png(folder / f"paint{number}.png", number)
        corners = [(x + 2 * number, y, x * y) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
        lines += [f"v {x} {y} {z}" for x, y, z in corners]
        places = " ".join(f"{4 * number + corner}/{corner}" for corner in range(1, 5))
        lines += [f"usemtl m{number}", f"f {places}"]
        materials += [f"newmtl m{number}", f"map_Kd paint{number}.png"]
    (folder / "model.obj").write_text("\n".join(lines) + "\n")
    (folder / "model.mtl").write_text("\n".join(materials) + "\n")
    return folder / "model.obj"


def write_scene(folder: Path) -> Path:
    """Writes the model of write_model, and a .blend file of it."""
    scene = folder / "scene.blend"
    made = (
        "import bpy; bpy.ops.wm.read_homefile(use_empty=True);"
        f"bpy.ops.wm.obj_import(filepath={str(write_model(folder))!r});"
        f"bpy.ops.wm.save_as_mainfile(filepath={str(scene)!r})"
    )
    run(BLENDER, "--background", "--python-exit-code", "1", "--python-expr", made)
    return scene


def write_ball(path: Path, count: int, seed: int) -> Path:
    """Writes points of a ball, with normals."""
    normals = np.random.default_rng(seed).normal(size=(count, 3)).astype("<f4")
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    names = "".join(f"property float {name}\n" for name in ("x", "y", "z", "nx", "ny", "nz"))
    header = f"ply\nformat binary_little_endian 1.0\nelement vertex {count}\n{names}end_header\n"
    path.write_bytes(header.encode() + np.hstack([normals, normals]).tobytes())
    return path


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir()}
