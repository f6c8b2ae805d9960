"""Measures how far the levels of each filter are from their image, over gathered models.

Usage: blender --background --python-exit-code 1 --python native/bench/quality.py -- [MODEL...]
       (--help lists the options)

Models are imported by Blender's own importers, and read through the add-on's bridge, so that what
is measured is what a user gets: the extension has to be installed and enabled. Ends with status 1
if a criterion of docs/benchmarks.md does not hold.

The error is prefilter.mipmap_error, which is exact: the RMSE over the surface and the channels, in
scene-linear values, between bilinear lookups of a level and of the image. It is checked by a second
method that shares nothing with it: lookups with numpy at random points of the surface.
"""

import argparse
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import bpy
import numpy as np
import prefilter
from bl_ext.user_default.prefilter.bridge import images, meshes
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Texels = NDArray[np.float32]

SUBJECT = "pam-bilinear"
RIVALS = ("box", "lanczos3", "box-covered", "pam-box")
FILTERS = ("box", "tent", "lanczos3", "box-covered", "lanczos3-covered", "pam-box", SUBJECT)
LEVELS = range(1, 7)
REQUIRED_MODELS = ("spot", "BoomBox", "IridescenceLamp", "DamagedHelmet")
FURTHER_MODELS = ("AntiqueCamera", "Suzanne", "Duck")
PAINTED_MODEL = "spot"
PAINTED_GAIN = 0.18
MAGENTA = (1.0, 0.0, 1.0)
SAMPLED_FILTERS = ("lanczos3", SUBJECT)
AGREEMENT = 5.0  # Standard errors by which the two methods may differ.

WRAP_OF_EXTENSION = {"REPEAT": "repeat", "EXTEND": "clamp", "CLIP": "border"}
BATCH = 1 << 18


@dataclass(frozen=True)
class Subject:
    """An image on its surfaces.

    Attributes:
        name: What to call it.
        picture: The image as the add-on reads it.
        image: Its scene-linear values, row 0 at the bottom.
        surfaces: What the add-on gives the library.
        wrap: The wrap mode that the materials ask for, or that of --wrap.
        corners: (m, 3, 3) positions and `uvs` (m, 3, 2) of the same triangles, read without the
            add-on and the library.
        uvs: See `corners`.
    """

    name: str
    picture: images.Picture
    image: Texels
    surfaces: list[prefilter.Surface]
    wrap: str
    corners: Floats
    uvs: Floats

    def painted(self, name: str, unused: NDArray[np.bool_]) -> "Subject":
        """Returns the same with some texels magenta."""
        image = self.image.copy()
        image[unused, :3] = MAGENTA
        return replace(self, name=name, image=image)

    def rounded(self, level: Texels) -> Texels:
        """Returns a level as an 8-bit image datablock of the picture's colour space keeps it."""
        stored = images.encoded(self.picture, level)
        stored = np.round(255 * stored.clip(0, 1)).astype(np.float32) / 255
        return images.scene_linear(replace(self.picture, stored=stored))


class Report:
    """Prints tables, and keeps them as markdown; counts what does not hold."""

    def __init__(self) -> None:
        """Starts empty."""
        self.markdown: list[str] = []
        self.failures: list[str] = []
        self.summary: list[list[str]] = []

    def table(self, title: str, head: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
        """Adds a table; all columns but the first are aligned at the right."""
        widths = [max(map(len, column)) for column in zip(head, *rows, strict=True)]
        print(f"\n{title}")
        for row in (head, *rows):
            print("  " + "  ".join(c.rjust(w) for c, w in zip(row, widths, strict=True)))
        sys.stdout.flush()
        ruler = ["---:"] * len(head)
        lines = (f"| {' | '.join(row)} |" for row in (head, ruler, *rows))
        self.markdown.append("\n".join([f"**{title}**", "", *lines, ""]))

    def verdict(self, holds: bool, claim: str) -> None:
        """Adds whether a criterion holds."""
        print(f"  {'holds' if holds else 'DOES NOT HOLD'}: {claim}", flush=True)
        self.markdown.append(f"{'Holds' if holds else '**Does not hold**'}: {claim}.\n")
        if not holds:
            self.failures.append(claim)


def main() -> None:
    """Measures the models of the command line."""
    options = parse()
    report = Report()
    for model in options.models:
        for subject in load(options.data / model, options.wrap):
            required = model in REQUIRED_MODELS
            measure(report, subject, required, options)
            if model == PAINTED_MODEL:
                measure_painted(report, subject, options)
    head = ["model", *(f"level {level}" for level in LEVELS), "mean", "worst / best other"]
    report.table(f"Summary: {SUBJECT} / lanczos3", head, report.summary)
    if options.markdown is not None:
        options.markdown.write_text("\n".join(report.markdown))
    print(
        f"\n{len(report.failures)} of the criteria do not hold" if report.failures else "\nall hold"
    )
    for failure in report.failures:
        print(f"  {failure}")
    if report.failures:
        raise SystemExit(1)


def parse() -> argparse.Namespace:
    """Reads the arguments after Blender's `--`."""
    arguments = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else []
    parser = argparse.ArgumentParser(prog="quality.py", description=__doc__.splitlines()[0])
    parser.add_argument("models", nargs="*", default=[*REQUIRED_MODELS, *FURTHER_MODELS])
    parser.add_argument(
        "--data",
        type=Path,
        default=Path(__file__).resolve().parents[3] / "shared/data/textured",
        help="the folder that holds a folder for each model (default: %(default)s)",
    )
    parser.add_argument(
        "--wrap",
        choices=["auto", *WRAP_OF_EXTENSION.values()],
        default="auto",
        help="the wrap mode; auto: that of the materials, as the add-on does (default: auto)",
    )
    parser.add_argument(
        "--samples",
        type=int,
        default=1 << 20,
        help="points of the second method; 0: leave it out (default: %(default)s)",
    )
    parser.add_argument(
        "--bytes",
        action="store_true",
        help="round the levels as 8-bit images keep them; without it they are floats",
    )
    parser.add_argument("--markdown", type=Path, metavar="FILE", help="write the tables here too")
    options = parser.parse_args(arguments)
    for model in options.models:
        if not (options.data / model).is_dir():
            parser.error(f"there is no folder '{options.data / model}'")
    return options


def load(folder: Path, wrap: str) -> Iterator[Subject]:
    """Imports a model and yields each of its images that has pixels, with its surfaces."""
    bpy.ops.wm.read_homefile(use_empty=True)
    for path in folder.glob("*.gltf"):
        bpy.ops.import_scene.gltf(filepath=str(path))
    for path in folder.glob("*_triangulated.obj"):
        bpy.ops.wm.obj_import(filepath=str(path))
    objects = [obj for obj in bpy.context.view_layer.objects if obj.type == "MESH"]
    found = meshes.images_of_objects(objects)
    bare = not found
    if bare:
        found = [bpy.data.images.load(str(path)) for path in folder.glob("*.png")]
    # Only some pictures of a model were gathered.
    found = [image for image in found if image.size[0] > 0]
    for image in found:
        name = folder.name if len(found) == 1 else f"{folder.name}, {image.name}"
        yield read(name, objects, image, wrap, all_faces=bare)


def read(
    name: str,
    objects: Sequence[bpy.types.Object],
    image: bpy.types.Image,
    wrap: str,
    *,
    all_faces: bool,
) -> Subject:
    """Reads an image and its surfaces, through the add-on and without it."""
    picture = images.read(image)
    if picture.alpha_is_coverage:
        raise ValueError(f"image '{image.name}': errors of images with coverage are not defined")
    depsgraph = bpy.context.evaluated_depsgraph_get()
    found = meshes.image_surfaces(objects, image, depsgraph, all_faces=all_faces)
    if wrap == "auto":
        wrap = WRAP_OF_EXTENSION[found.extensions[0]]
    corners, uvs = read_triangles(objects, image, all_faces=all_faces)
    area = sum(surface.area for surface in found.surfaces)
    if not np.isclose(areas_of(corners).sum(), area, rtol=1e-5):
        raise ValueError(
            f"{name}: the add-on reads an area of {area}, not {areas_of(corners).sum()}"
        )
    return Subject(name, picture, images.scene_linear(picture), found.surfaces, wrap, corners, uvs)


def read_triangles(
    objects: Sequence[bpy.types.Object], image: bpy.types.Image, *, all_faces: bool
) -> tuple[Floats, Floats]:
    """Returns world positions (m, 3, 3) and UVs (m, 3, 2) of the faces that show an image."""
    corners, uvs = [], []
    for obj in objects:
        mesh = obj.data
        mesh.calc_loop_triangles()
        layer = mesh.uv_layers.active
        slots = {i for i, material in enumerate(mesh.materials) if shows(material, image)}
        for triangle in mesh.loop_triangles:
            if all_faces or triangle.material_index in slots:
                corners.append([obj.matrix_world @ mesh.vertices[v].co for v in triangle.vertices])
                uvs.append([layer.uv[loop].vector for loop in triangle.loops])
    return np.array(corners, float), np.array(uvs, float)


def shows(material: bpy.types.Material | None, image: bpy.types.Image) -> bool:
    """Returns whether a material has a node with the image."""
    if material is None or not material.use_nodes:
        return False
    return any(n.type == "TEX_IMAGE" and n.image == image for n in material.node_tree.nodes)


def areas_of(corners: Floats) -> Floats:
    """Returns the areas of triangles."""
    a, b, c = corners.transpose(1, 0, 2)
    return np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2


def measure(
    report: Report, subject: Subject, required: bool, options: argparse.Namespace
) -> dict[str, NDArray[np.float64]]:
    """Adds the errors of one subject to the report, and returns them by filter."""
    levels = {name: bake(subject, name) for name in FILTERS}
    if options.bytes:
        for made in levels.values():
            made[1:] = [subject.rounded(level) for level in made[1:]]
    errors = {
        name: prefilter.mipmap_error(
            levels[name], subject.image, subject.surfaces, LEVELS, wrap=subject.wrap
        )
        for name in FILTERS
    }
    ours = errors[SUBJECT]
    best = np.min([errors[name] for name in FILTERS if name != SUBJECT], axis=0)
    ratios = {"/ best other": ours / best, "/ lanczos3": ours / errors["lanczos3"]}
    rows = [
        [
            str(level),
            *(f"{errors[name][k]:.5f}" for name in FILTERS),
            *(f"{ratio[k]:.3f}" for ratio in ratios.values()),
        ]
        for k, level in enumerate(LEVELS)
    ]
    blanks = [""] * len(FILTERS)
    rows.append(["mean", *blanks, *(f"{ratio.mean():.3f}" for ratio in ratios.values())])
    height, width, channels = subject.image.shape
    triangles = sum(surface.triangle_count for surface in subject.surfaces)
    title = (
        f"{subject.name}: {width} x {height} x {channels}, {triangles} triangles, "
        f"wrap {subject.wrap}: "
        f"RMSE over the surface{', levels in 8 bits' if options.bytes else ''}"
    )
    report.table(title, ["level", *FILTERS, *ratios], rows)
    ratio = ratios["/ lanczos3"]
    report.summary.append(
        [
            subject.name,
            *(f"{x:.3f}" for x in ratio),
            f"{ratio.mean():.3f}",
            f"{(ours / best).max():.3f}",
        ]
    )
    if required:
        least = min((errors[name] / ours).min() for name in RIVALS)
        report.verdict(
            least > 1,
            f"{subject.name}: {SUBJECT} is below {', '.join(RIVALS)} at every level 1 to 6 "
            f"(closest: {100 * (1 - 1 / least):.1f} % below)",
        )
    if options.samples:
        check_by_sampling(report, subject, levels, errors, options.samples)
    return errors


def bake(subject: Subject, name: str) -> list[Texels]:
    """Returns levels 0 to 6."""
    return prefilter.mipmaps(
        subject.image,
        subject.surfaces,
        filter=name,
        wrap=subject.wrap,
        levels=LEVELS[-1] + 1,
        premultiplied=True,
    )


def measure_painted(report: Report, subject: Subject, options: argparse.Namespace) -> None:
    """Measures a subject with its unused texels magenta, in two meanings of unused."""
    height, width = subject.image.shape[:2]
    touched = touched_texels(subject.uvs, width, height, subject.wrap)
    # A bilinear lookup beside a chart's edge reads one texel further.
    read = dilated(touched, subject.wrap)
    for used, which in ((touched, "touches"), (read, "reads")):
        print(f"\nmagenta: the {(~used).mean():.1%} of texels that no triangle {which}")
        name = f"{subject.name}, texels that no triangle {which} magenta"
        errors = measure(report, subject.painted(name, ~used), True, options)
        gain = 1 - (errors[SUBJECT] / errors["lanczos3"]).mean()
        report.verdict(
            gain >= PAINTED_GAIN,
            f"{name}: {SUBJECT} is at least {PAINTED_GAIN:.0%} below lanczos3 on average over "
            f"levels 1 to 6 (found {100 * gain:.1f} %)",
        )


def touched_texels(uvs: Floats, width: int, height: int, wrap: str) -> NDArray[np.bool_]:
    """Returns which texels' squares share an area with some triangle (separating axes)."""
    touched = np.zeros((height, width), bool)
    size = np.array([width, height])
    for triangle in uvs * size:
        edges = np.roll(triangle, -1, axis=0) - triangle
        twice_area = edges[0, 0] * edges[1, 1] - edges[0, 1] * edges[1, 0]
        if twice_area == 0:
            continue
        low = np.floor(triangle.min(axis=0)).astype(int)
        high = np.ceil(triangle.max(axis=0)).astype(int)
        x, y = np.meshgrid(np.arange(low[0], high[0]), np.arange(low[1], high[1]))
        meets = np.ones(x.shape, bool)
        for corner, edge in zip(triangle, edges * np.sign(twice_area), strict=True):
            centre = edge[0] * (y + 0.5 - corner[1]) - edge[1] * (x + 0.5 - corner[0])
            meets &= centre + np.abs(edge).sum() / 2 > 0
        touched[wrapped(y[meets], height, wrap), wrapped(x[meets], width, wrap)] = True
    return touched


def dilated(mask: NDArray[np.bool_], wrap: str) -> NDArray[np.bool_]:
    """Returns the mask with the eight neighbours of each texel."""
    height, width = mask.shape
    rows, columns = np.nonzero(mask)
    result = mask.copy()
    for dy in (-1, 0, 1):
        for dx in (-1, 0, 1):
            result[wrapped(rows + dy, height, wrap), wrapped(columns + dx, width, wrap)] = True
    return result


def check_by_sampling(
    report: Report,
    subject: Subject,
    levels: dict[str, list[Texels]],
    errors: dict[str, Floats],
    samples: int,
) -> None:
    """Estimates the errors from random points, and adds both to the report."""
    points = random_points(subject, samples)
    exact_image = np.concatenate([lookup(subject.image, p, subject.wrap) for p in batches(points)])
    rows, worst = [], 0.0
    for name in SAMPLED_FILTERS:
        for k, level in enumerate(LEVELS):
            texels = levels[name][level]
            found = np.concatenate([lookup(texels, p, subject.wrap) for p in batches(points)])
            squares = ((found - exact_image) ** 2).mean(axis=1)
            estimate = np.sqrt(squares.mean())
            deviation = squares.std() / np.sqrt(samples) / (2 * estimate)
            off = (estimate - errors[name][k]) / deviation
            worst = max(worst, abs(off))
            exact = f"{errors[name][k]:.5f}"
            rows.append(
                [name, str(level), exact, f"{estimate:.5f}", f"{deviation:.5f}", f"{off:+.1f}"]
            )
    title = f"{subject.name}: the same by {samples} random points"
    report.table(title, ["filter", "level", "exact", "sampled", "std. error", "off by"], rows)
    report.verdict(
        worst <= AGREEMENT,
        f"{subject.name}: the exact and the sampled errors agree "
        f"(at most {worst:.1f} standard errors apart)",
    )


def random_points(subject: Subject, count: int) -> Floats:
    """Returns texture coordinates (count, 2) of points spread evenly at random over the surface."""
    random = np.random.default_rng(1)
    ends = np.cumsum(areas_of(subject.corners))
    # One point in each of `count` equal shares of the area: less noise than free points.
    shares = (np.arange(count) + random.random(count)) / count
    chosen = np.minimum(np.searchsorted(ends, shares * ends[-1], side="right"), len(ends) - 1)
    root, s = np.sqrt(random.random(count)), random.random(count)
    weights = np.stack([1 - root, root * (1 - s), root * s], axis=1)
    return np.einsum("nk,nkd->nd", weights, subject.uvs[chosen])


def batches(points: Floats) -> Iterator[Floats]:
    """Yields the points in parts that fit in memory with all that is made of them."""
    for start in range(0, len(points), BATCH):
        yield points[start : start + BATCH]


def lookup(texels: Texels, points: Floats, wrap: str) -> Floats:
    """Returns bilinear lookups of an image, as a GPU does them."""
    height, width = texels.shape[:2]
    x, y = (points * (width, height) - 0.5).T
    column, row = np.floor(x).astype(int), np.floor(y).astype(int)
    s, t = (x - column)[:, None], (y - row)[:, None]

    def at(dx: int, dy: int) -> Floats:
        return texels[wrapped(row + dy, height, wrap), wrapped(column + dx, width, wrap)].astype(
            float
        )

    low = (1 - s) * at(0, 0) + s * at(1, 0)
    high = (1 - s) * at(0, 1) + s * at(1, 1)
    return (1 - t) * low + t * high


def wrapped(index: NDArray[np.int64], size: int, wrap: str) -> NDArray[np.int64]:
    """Returns which texel an index along an axis reads."""
    if wrap == "repeat":
        return index % size
    if wrap == "clamp":
        return np.clip(index, 0, size - 1)
    raise ValueError(f"wrap: found '{wrap}'; the sampled check knows repeat and clamp")


if __name__ == "__main__":
    main()
