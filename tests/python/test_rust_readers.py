# SPDX-License-Identifier: GPL-3.0-or-later

"""DDS and KTX 2 files, read by the crates of bevy and wgpu programs, if cargo is installed."""

import os
import re
import shutil
import subprocess
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import prefilter
import pytest
from test_texture_files import NAMES, chain, smooth_chain
from texture_readers import read_dds, read_ktx2

HERE = Path(__file__).resolve().parent / "rust_readers"
TARGET = Path(__file__).resolve().parents[2] / "build" / "rust_readers"

pytestmark = pytest.mark.skipif(shutil.which("cargo") is None, reason="cargo is not installed")


@pytest.fixture(scope="module")
def read():
    """A function that runs the program on files and returns its lines, split at spaces."""
    environment = {**os.environ, "CARGO_TARGET_DIR": str(TARGET)}

    def cargo(*words):
        command = ["cargo", *words, "--quiet", "--locked"]
        return subprocess.run(command, cwd=HERE, env=environment, capture_output=True, text=True)

    fetched = cargo("fetch")
    if fetched.returncode != 0:
        pytest.skip(f"the crates cannot be had: {fetched.stderr.strip().splitlines()[-1]}")
    built = cargo("build", "--offline")
    assert built.returncode == 0, built.stderr

    def lines(paths):
        run = subprocess.run(
            [TARGET / "debug" / "readers", *paths], capture_output=True, text=True, check=True
        )
        return [line.split() for line in run.stdout.splitlines()]

    return lines


def of_bytes(words):
    return [bytes.fromhex(word) for word in words]


IMAGE_DDS = {
    "r8": "R8Unorm",
    "rg8": "Rg8Unorm",
    "rgba8": "Rgba8Unorm",
    "rgba16f": "Rgba16Float",
    "rgba32f": "Rgba32Float",
    "bc1": "BC1RgbaUnorm",
    "bc1-rgb": "BC1RgbaUnorm",
    "bc3": "BC3RgbaUnorm",
    "bc4": "BC4RUnorm",
    "bc5": "BC5RgUnorm",
    "bc6h": "BC6hRgbUfloat",
    "bc7": "BC7RgbaUnorm",
}


@pytest.mark.parametrize("size", [(16, 8), (13, 6), (1, 1)])
def test_image_dds_reads_every_format_with_all_levels(tmp_path, read, size):
    cases = []
    for name, (_, srgb) in NAMES.items():
        for encoding in ("linear", "srgb"):
            has_srgb = srgb is not None and srgb != NAMES[name][0] and name not in {"r8", "rg8"}
            if encoding == "srgb" and not has_srgb:
                continue
            for header in ("auto", "dx10"):
                levels = smooth_chain(*size, 4)
                for level in levels:
                    level[..., 3] = 255
                path = tmp_path / f"{name}-{encoding}-{header}.dds"
                prefilter.write_dds(path, levels, format=name, encoding=encoding, header=header)
                cases.append((name, encoding, levels, path))
    for (name, encoding, levels, path), words in zip(
        cases, read([path for *_, path in cases]), strict=True
    ):
        assert words[0] != "refused:", (path.name, words)
        format, width, height, *found = words
        expected = IMAGE_DDS[name]
        is_bgra = name == "rgba8" and not read_dds(path).has_dx10
        assert format == (
            "Bgra8Unorm" if is_bgra else expected + ("Srgb" if encoding == "srgb" else "")
        )
        assert (int(height), int(width)) == size
        assert len(found) == len(levels)
        if name in {"rgba32f", "rgba16f", "bc6h"}:
            continue  # Other programs decode the same bytes; here they would be cut off to bytes.
        count = {"r8": 1, "bc4": 1, "rg8": 2, "bc5": 2}.get(name, 3)
        for number, data in enumerate(of_bytes(found)):
            shape = [max(1, side >> number) for side in size]
            texels = np.frombuffer(data, np.uint8).reshape(*shape, 4).astype(float)
            if name == "bc7" and find_spec("OpenImageIO") is None:
                continue  # Nothing else here decodes it.
            ours = read_dds(path).level(number)[..., :count]
            assert np.abs(texels[..., :count] - ours).max() <= 1.5, (path.name, number)


@pytest.mark.parametrize("supercompression", ["none", "zstd"])
def test_ktx2_reads_every_format_with_all_levels(tmp_path, read, supercompression):
    if supercompression == "zstd":
        pytest.importorskip("zstandard")
    size = (13, 6)
    paths = []
    for name, (_, srgb) in NAMES.items():
        for encoding in ("linear", "srgb"):
            if encoding == "srgb" and srgb is None:
                continue
            path = tmp_path / f"{name}-{encoding}.ktx2"
            prefilter.write_ktx2(
                path,
                chain(*size, 4),
                format=name,
                encoding=encoding,
                supercompression=supercompression,
            )
            paths.append(path)
    for path, words in zip(paths, read(paths), strict=True):
        assert words[0] != "refused:", (path.name, words)
        format, width, height, *found = words
        ours = read_ktx2(path)
        assert format.startswith("Some(")
        # BC1_UNORM is BC1_RGBA_UNORM_BLOCK there.
        assert {*ours.format.split("_")} <= {*re.findall("[A-Z0-9]+", format)}
        assert (int(height), int(width)) == size
        levels = of_bytes(found)
        if supercompression == "none":
            assert levels == ours.level_data
        else:
            assert len(levels) == len(ours.level_data)
