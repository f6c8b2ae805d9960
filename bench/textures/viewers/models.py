# SPDX-License-Identifier: GPL-3.0-or-later

"""Writes the models that bench/textures/viewers/three_js.py and docs/pictures/viewers.py draw.

Usage: blender --background --python-exit-code 1 --python bench/textures/viewers/models.py
       (--help lists the options, after --)

Models are imported by Blender's own importers, and exported by its glTF exporter: MODEL.plain.glb
without mipmaps, MODEL.fitted.glb with the extension's default mipmaps, and MODEL.views.glb with
Fit to Views. The extension has to be installed and enabled.
"""

import sys
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parents[3]))
from bench.textures import cycles, subjects

FOLDER = Path(__file__).resolve().parents[3] / "build/viewers"
KINDS = {"plain": None, "fitted": "one-lookup", "views": "views"}


def main() -> None:
    """Writes the models of the command line."""
    parser = subjects.argument_parser("models.py", __doc__)
    parser.add_argument("--folder", type=Path, default=FOLDER, help="default: %(default)s")
    parser.add_argument("--kinds", nargs="+", choices=KINDS, default=KINDS, help="default: all")
    options = subjects.parse(parser)
    options.folder.mkdir(parents=True, exist_ok=True)
    for model in options.models:
        cycles.load(options.data / model)
        scene = bpy.context.scene
        for kind in options.kinds:
            lookups = KINDS[kind]
            scene.prefilter_gltf.use_mipmaps = lookups is not None
            if lookups is not None:
                scene.prefilter_bake.lookups = lookups
            path = options.folder / f"{model}.{kind}.glb"
            bpy.ops.export_scene.gltf(filepath=str(path), export_format="GLB")
            print(f"{path.name}: {path.stat().st_size / 2**20:.1f} MiB", flush=True)


if __name__ == "__main__":
    main()
