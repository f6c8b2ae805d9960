# SPDX-License-Identifier: GPL-3.0-or-later

"""Reads exports of bench/textures/exports.py by gltf-validator, gltf-transform and Khronos' ktx.

Usage: python3 bench/textures/check_exports.py --modules FOLDER   (--help)

FOLDER is a node_modules with gltf-validator, @gltf-transform/core, extensions and functions, and
draco3dgltf; `node` and `ktx` have to be on PATH. Ends with status 1 where one of them has found an
error, or where gltf-transform does not know the size of a texture.
"""

import argparse
import json
import shutil
import struct
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from bench.report import Report, add_json_option

FOLDER = Path(__file__).resolve().parents[2] / "build/exports"
READERS = Path(__file__).with_name("gltf_readers.mjs")
KTX2 = b"\xabKTX 20\xbb\r\n\x1a\n"


def main() -> int:
    """Checks the exports; returns the exit status."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--folder", type=Path, default=FOLDER, help="default: %(default)s")
    parser.add_argument("--modules", type=Path, required=True, help="a node_modules")
    add_json_option(parser)
    options = parser.parse_args()
    report = Report()
    listing = json.loads((options.folder / "exports.json").read_text())
    paths = [options.folder / case["name"].rpartition(".")[0] / case["name"] for case in listing]
    said = read_by_node(options.modules, paths)
    ktx = shutil.which("ktx")
    rows, wrong, textures = [], {"gltf-validator": 0, "gltf-transform": 0, "ktx": 0}, 0
    for case, path, found in zip(listing, paths, said["found"], strict=True):
        files = list(ktx2_files(path))
        textures += len(files)
        errors = [error for data in files for error in validated(ktx, data)] if ktx else []
        sizes = [one["resolution"] for one in found.get("textures", [])]
        read = "refused" in found or "" in sizes or not sizes
        wrong["gltf-validator"] += found["validator"]["errors"]
        wrong["gltf-transform"] += read
        wrong["ktx"] += len(errors) + (not files)
        rows.append(
            [
                case["name"],
                str(len(files)),
                str(found["validator"]["errors"]),
                str(found["validator"]["warnings"]),
                found.get("refused", ", ".join(sizes)),
                str(len(errors)) if ktx else "",
            ]
        )
        for text in (*found["validator"]["messages"], *errors):
            print(f"  {case['name']}: {text}", file=sys.stderr)
    versions = said["versions"]
    report.table(
        f"{len(rows)} exports; gltf-validator {versions['gltf-validator']}, gltf-transform "
        f"{versions['gltf-transform']}, {version_of(ktx)}",
        ["file", "KTX 2", "errors", "warnings", "gltf-transform", "ktx"],
        rows,
        name="exports",
    )
    for reader, count in wrong.items():
        if reader != "ktx" or ktx:
            report.verdict(count == 0, f"{len(rows)} files, {textures} textures: {reader}")
    return report.finish(options.json)


def read_by_node(modules: Path, paths: list[Path]) -> dict[str, Any]:
    """The report of gltf_readers.mjs on files: `versions`, and `found` with an entry per file."""
    run = subprocess.run(
        ["node", str(READERS), str(modules), *map(str, paths)], capture_output=True, text=True
    )
    if run.returncode != 0:
        raise RuntimeError(f"node: {run.stderr.strip()}")
    answer: dict[str, Any] = json.loads(run.stdout)
    return answer


def ktx2_files(path: Path) -> Iterator[bytes]:
    """Yields the KTX 2 files of a .glb file, or those beside a .gltf file."""
    if path.suffix == ".gltf":
        for other in sorted(path.parent.glob("*.ktx2")):
            yield other.read_bytes()
        return
    data = path.read_bytes()
    (length,) = struct.unpack_from("<I", data, 12)
    file, buffer = json.loads(data[20 : 20 + length]), data[28 + length :]
    for image in file.get("images", []):
        view = file["bufferViews"][image["bufferView"]]
        start = view.get("byteOffset", 0)
        part = buffer[start : start + view["byteLength"]]
        if part.startswith(KTX2):
            yield part


def validated(ktx: str, data: bytes) -> list[str]:
    """Returns the errors and warnings of `ktx validate` on a file, with glTF's requirements."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "texture.ktx2"
        path.write_bytes(data)
        command = [ktx, "validate", "--gltf-basisu", "--warnings-as-errors", str(path)]
        run = subprocess.run(command, capture_output=True, text=True)
    if run.returncode == 0:
        return []
    return [" ".join((run.stdout + run.stderr).split())]


def version_of(ktx: str | None) -> str:
    """Returns how to call Khronos' program."""
    if ktx is None:
        return "no ktx"
    return subprocess.run([ktx, "--version"], capture_output=True, text=True).stdout.strip()


if __name__ == "__main__":
    sys.exit(main())
