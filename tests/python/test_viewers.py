# SPDX-License-Identifier: GPL-3.0-or-later

"""Textures in three.js and Babylon.js, in a headless Chromium, where these are installed."""

import json
import os
import shutil
import struct
from pathlib import Path

import numpy as np
import prefilter
import pytest

from bench.textures.viewers import three_js

MODULES = Path(os.environ.get("PREFILTER_NODE_MODULES", "node_modules"))

PACKAGES = {
    "three_js.html": ["three"],
    "babylon_js.html": ["@babylonjs/core", "@babylonjs/loaders"],
}

pytestmark = pytest.mark.skipif(
    shutil.which("chromium") is None, reason="Chromium is not installed"
)


@pytest.fixture(params=PACKAGES)
def page(request):
    for package in PACKAGES[request.param]:
        if not (MODULES / package).is_dir():
            pytest.skip(f"PREFILTER_NODE_MODULES names no folder with {package}")
    return request.param


# Each level has one of these colors, so that a picture tells which level it shows.
COLORS = [(255, 0, 0), (0, 255, 0), (0, 0, 255), (255, 255, 0), (0, 255, 255), (255, 0, 255)]


def write_quad(path, texture):
    """A .glb with a square that shows a texture, facing the camera."""
    positions = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], "<f4")
    uvs = np.array([[0, 1], [1, 1], [1, 0], [0, 0]], "<f4")
    indices = np.array([0, 1, 2, 0, 2, 3], "<u2")
    parts = [positions.tobytes(), uvs.tobytes(), indices.tobytes(), texture]
    views, at = [], 0
    for part in parts:
        views.append({"buffer": 0, "byteOffset": at, "byteLength": len(part)})
        at += len(part) + -len(part) % 4
    data = b"".join(part + bytes(-len(part) % 4) for part in parts)
    limits = {"min": [-1, -1, 0], "max": [1, 1, 0]}
    file = {
        "asset": {"version": "2.0"},
        "extensionsUsed": ["KHR_texture_basisu"],
        "extensionsRequired": ["KHR_texture_basisu"],
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [
            {
                "primitives": [
                    {"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2, "material": 0}
                ]
            }
        ],
        "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
        "textures": [{"sampler": 0, "extensions": {"KHR_texture_basisu": {"source": 0}}}],
        "samplers": [{"minFilter": 9984, "magFilter": 9728}],  # nearest level and texel
        "images": [{"mimeType": "image/ktx2", "bufferView": 3}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", **limits},
            {"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC2"},
            {"bufferView": 2, "componentType": 5123, "count": 6, "type": "SCALAR"},
        ],
        "bufferViews": views,
        "buffers": [{"byteLength": len(data)}],
    }
    text = json.dumps(file).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text
    chunks += struct.pack("<I4s", len(data), b"BIN\0") + data
    path.write_bytes(struct.pack("<4s2I", b"glTF", 2, 12 + len(chunks)) + chunks)


@pytest.mark.parametrize(
    ("format", "supercompression"), [("uastc", "none"), ("uastc", "zstd"), ("etc1s", "none")]
)
def test_every_level_arrives_and_the_right_one_shows(tmp_path, page, format, supercompression):
    side = 2 ** (len(COLORS) - 1)
    levels = [
        np.full((side >> number, side >> number, 3), color, np.uint8)
        for number, color in enumerate(COLORS)
    ]
    file = tmp_path / "texture.ktx2"
    prefilter.write_ktx2(
        file, levels, format=format, encoding="srgb", supercompression=supercompression
    )
    write_quad(tmp_path / "quad.fitted.glb", file.read_bytes())
    # The camera shows a square of side 2 on 0.628 of its width.
    pictures = [8, 16, 32, 64]
    tasks = [three_js.task("quad", "fitted", size, 1) for size in pictures]
    results = three_js.drawn(tasks, MODULES, tmp_path, page=page)["results"]
    for size, result in zip(pictures, results, strict=True):
        (texture,) = result["textures"]
        assert texture["compressed"]
        assert texture["srgb"]
        sizes = [level[:2] for level in texture["levels"]]
        assert sizes == [[side >> number] * 2 for number in range(len(COLORS))]
        middle = three_js.frames_of(result, size)[0, size // 2, size // 2]
        shown = int(np.argmin([np.abs(middle - np.array(color) / 255).sum() for color in COLORS]))
        assert np.abs(middle - np.array(COLORS[shown]) / 255).max() < 0.02
        texels_a_pixel = side / (0.628 * size)
        assert shown == round(max(0, np.log2(texels_a_pixel)))


# Formats whose legacy header Babylon.js reads, and formats that it supports with neither header.
LEGACY = ["bc1", "bc3", "rgba8", "r8", "rgba16f", "rgba32f"]
# Formats whose levels it reads and then replaces with its own, made from level 0.
REMADE = ["rgba8", "r8"]
UNKNOWN = ["bc4", "bc5", "bc7"]


@pytest.mark.parametrize("encoding", ["linear", "srgb"])
def test_dds_files_with_a_legacy_header_in_babylon_js(tmp_path, encoding):
    page = "babylon_js.html"
    if not (MODULES / "@babylonjs/core").is_dir():
        pytest.skip("PREFILTER_NODE_MODULES names no folder with @babylonjs/core")
    side, size = 2 ** (len(COLORS) - 1), 16
    colors = [tuple(max(40, value) for value in color) for color in COLORS]
    levels = [
        np.full((side >> number, side >> number, 3), color, np.uint8)
        for number, color in enumerate(colors)
    ]
    tasks = []
    for format in LEGACY + UNKNOWN:
        if encoding == "srgb" and format in {"r8", "bc4", "bc5"}:
            continue
        header = "legacy" if format in LEGACY else "auto"
        path = tmp_path / f"{format}.dds"
        prefilter.write_dds(path, levels, format=format, encoding=encoding, header=header)
        task = three_js.task(format, "dds", size, 1)
        is_srgb = encoding == "srgb" and not prefilter.TEXEL_FORMATS[format].is_float
        tasks.append({**task, "url": f"/models/{path.name}", "mayFail": True, "srgb": is_srgb})
    results = three_js.drawn(tasks, MODULES, tmp_path, page=page)["results"]
    # A pixel is 32 / (0.628 * 16) texels wide.
    shown = np.array(colors, np.float32)[None] / 255
    if encoding == "srgb":
        shown = prefilter.to_linear(shown)
    for task, result in zip(tasks, results, strict=True):
        format = task["name"].split()[0]
        (texture,) = result["textures"]
        if format in UNKNOWN:
            assert texture["levels"] == [], format
            continue
        sizes = [level[:2] for level in texture["levels"]]
        assert sizes == [[side >> number] * 2 for number in range(len(COLORS))], format
        middle = three_js.frames_of(result, size)[0, size // 2, size // 2]
        count = 1 if format == "r8" else 3
        expected = shown[0, 0 if format in REMADE else 2]
        assert np.abs(middle - expected)[:count].max() < 0.02, format
