# SPDX-License-Identifier: GPL-3.0-or-later

"""The surfaces of animated objects, over the frames of a scene."""

from collections.abc import Generator, Sequence

import bpy

from ..bridge import meshes
from .choices import Settings


def surfaces_over_frames(
    image: bpy.types.Image,
    objects: Sequence[bpy.types.Object],
    settings: Settings,
    depsgraph: bpy.types.Depsgraph,
    *,
    all_faces: bool,
) -> Generator[float, None, meshes.ImageSurfaces]:
    """Reads the surfaces of one or several frames; see `bake_inputs.read_steps`.

    Yields:
        The fraction done.

    Returns:
        The surfaces, averaged over the frames.

    Raises:
        ValueError: The range of frames is empty, or a mesh is unfit.
    """
    options = meshes.SurfaceOptions(settings.use_subdivision_limit, settings.importance)
    if not settings.use_frames:
        return meshes.image_surfaces(objects, image, depsgraph, options, all_faces=all_faces)
    frames = frame_range(settings)
    surfaces = meshes.ImageSurfaces()
    scene = depsgraph.scene
    before = scene.frame_current, scene.frame_subframe
    try:
        for count, frame in enumerate(frames, start=1):
            scene.frame_set(frame)
            surfaces.add_pose(
                meshes.image_surfaces(objects, image, depsgraph, options, all_faces=all_faces)
            )
            yield count / len(frames)
    finally:
        scene.frame_set(before[0], subframe=before[1])
    return surfaces


def averaged_frames(settings: Settings) -> Sequence[int]:
    """Returns the frames over which a bake averages; empty for the current frame only."""
    return frame_range(settings) if settings.use_frames else ()


def frame_range(settings: Settings) -> range:
    """Returns the frames to average over; raises ValueError if the range is empty."""
    if settings.frame_end < settings.frame_start:
        raise ValueError(f"End: {settings.frame_end} is before Start, {settings.frame_start}")
    return range(settings.frame_start, settings.frame_end + 1, settings.frame_step)
