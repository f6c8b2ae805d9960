# SPDX-License-Identifier: GPL-3.0-or-later

"""Makes the picture of docs/benchmarks/renders.md: OpenGL with one lookup per pixel.

usage: python3 opengl.py FOLDER [MODELS]    (with the package prefilter importable, and moderngl)

MODELS is the folder that bench/textures/opengl_models.py has filled. Leaves FOLDER/opengl.png.
"""

import sys
from pathlib import Path

import numpy as np
from sheets import encoded, sheet

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from bench.textures import opengl, opengl_renderer
from bench.textures.opengl_renderer import Model, Renderer, Texels, averaged

MODEL, SIZE, ANGLE = "spot", 96, 0.35
PART = (slice(44, 80), slice(28, 76))
SCALE = 7
SHOWN = {
    "box": "Box",
    "lanczos3": "Lanczos 3",
    "pam-bilinear": "PAM Bilinear, supersampled",
    "pam-bilinear:footprint=1": "PAM Bilinear, one lookup",
    "pam-trilinear:footprint=1": "PAM Trilinear, one lookup",
}


def main(folder: Path, models: Path) -> None:
    """Makes the picture."""
    model = Model.read(models / f"{MODEL}.npz")
    renderer = Renderer(model)
    full = renderer.textures([[image] for image in model.images])
    samples = opengl.REFERENCE * SIZE
    filters = opengl_renderer.FULL
    truth = averaged(renderer.draw(full, ANGLE, samples, filters=filters), opengl.REFERENCE)
    cells = [(enlarged(truth), "16 x 16 lookups of the image")]
    covered = truth[..., 3] == 1
    for filter_, title in SHOWN.items():
        levels = [opengl.baked(model, image, filter_) for image in range(len(model.images))]
        shown = renderer.draw(renderer.textures(levels), ANGLE, SIZE)
        error = np.sqrt(np.mean((shown - truth)[covered][:, :3] ** 2))
        cells.append((enlarged(shown), f"{title}: {error:.4f}"))
    sheet(cells, columns=3).save(folder / "opengl.png")


def enlarged(pixels: Texels) -> Texels:
    """Returns the part that is shown, encoded, with the first row at the top."""
    part = encoded(np.ascontiguousarray(pixels[..., :3]))[::-1][PART]
    return part.repeat(SCALE, axis=0).repeat(SCALE, axis=1)


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]) if len(sys.argv) > 2 else opengl.FOLDER)
