# SPDX-License-Identifier: GPL-3.0-or-later

"""Checks levels, and models with levels: valid files with all unrelated content preserved."""

import json
import shutil
import struct
import subprocess
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

_VALIDATOR = Path(__file__).with_name("validate_gltf.mjs")
MAX_MEAN_DIFFERENCE = 2 / 255


def check_levels(run: Any, truth: Mapping[str, Any]) -> list[str]:
    """Checks a KTX 2 file of levels: their number and sizes, and that all have one mean."""
    import prefilter

    del truth
    levels, info = prefilter.read_ktx2(run.target)
    findings = []
    height, width = levels[0].shape[:2]
    for number, level in enumerate(levels):
        right = max(1, height >> number), max(1, width >> number)
        if level.shape[:2] != right:
            findings.append(f"size: level {number} is {level.shape[:2]}; {right} is right")
    if len(levels) != max(height, width).bit_length():
        findings.append(f"levels: {len(levels)} for {width} x {height}")
    is_power_of_two = not (width & (width - 1) or height & (height - 1))
    if is_power_of_two and not findings:
        means = [_light(level, info.encoding).mean(axis=(0, 1)) for level in levels]
        worst = max(np.abs(mean - means[0]).max() for mean in means[:-2] or means)
        if worst > MAX_MEAN_DIFFERENCE:
            findings.append(f"mean: levels differ by {255 * worst:.1f} of 255")
    return findings


def _light(level: NDArray[Any], encoding: str) -> NDArray[np.float64]:
    """Returns a level as light from 0 to 1, colors times alpha."""
    most = {np.uint8: 255.0, np.uint16: 65535.0}.get(level.dtype.type, 1.0)
    values = np.asarray(level, float) / most
    colors = values[..., : min(3, values.shape[2])]
    if encoding == "srgb":
        colors = np.where(colors <= 0.04045, colors / 12.92, ((colors + 0.055) / 1.055) ** 2.4)
    return colors * values[..., 3:] if values.shape[2] == 4 else colors


def check_model(run: Any, truth: Mapping[str, Any]) -> list[str]:
    """Checks a baked glTF file: it is valid, and has the nodes, skins and cameras of its source."""
    made, source = _document(run.target), _document(run.source)
    findings = [] if made is not None else ["broken: the result is no glTF file"]
    if made is None or source is None:
        return findings
    for key in ("meshes", "skins", "cameras", "animations"):
        count, right = len(made.get(key, ())), len(source.get(key, ()))
        if count < right:
            findings.append(f"lost {key}: {count} of {right}")
    if "images" in truth and len(made.get("images", ())) != truth["images"]:
        findings.append(f"images: {len(made.get('images', ()))}; {truth['images']} are right")
    return findings + _validate(run.target)


def _document(path: Path) -> dict[str, Any] | None:
    data = path.read_bytes()
    if data[:4] == b"glTF":
        length = struct.unpack_from("<I", data, 12)[0]
        data = data[20 : 20 + length]
    try:
        return json.loads(data)
    except ValueError:
        return None


def _validate(path: Path) -> list[str]:
    """Returns the errors that Khronos' validator finds, where Node has the package."""
    if shutil.which("node") is None:
        return []
    done = subprocess.run(
        ["node", str(_VALIDATOR), str(path)], capture_output=True, text=True, check=False
    )
    if done.returncode:
        return []
    return [f"gltf-validator: {message}" for message in json.loads(done.stdout)]
