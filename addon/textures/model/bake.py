# SPDX-License-Identifier: GPL-3.0-or-later

"""The bake of a model: each image is read, then computed on any thread; all are written together.

Both the operator and the command use it. An image that cannot be baked does not stop the others.
Only one image is in memory at a time.
"""

import os
from collections.abc import Callable, Generator, Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

import bpy
from prefilter.workflows.files import engines

from ...core.jobs import Progress, go_on, share
from ...core.outcome import FAILURES, Outcome
from .. import bake_inputs, udim
from ..bake import Bake, write_all
from ..choices import Settings
from . import decisions
from .manifest import Manifest
from .plan import Job, Plan
from .preparation import PreparedJob, image_pair, prepare, split_job
from .results import Results, strip_names
from .table import Row

Compute = Callable[[Progress], None]
AnyBake = Bake | udim.TiledBake


class ModelBake:
    """One bake of a model.

    The functions from `read_steps` use no Blender data and run on any thread; everything else runs
    on the main thread.
    """

    def __init__(
        self,
        plan: Plan,
        settings: Settings,
        files: dict[str, str],
        *,
        jobs: Sequence[Job] | None = None,
        manifest: Path | None = None,
        is_dry_run: bool = False,
        may_skip: bool = False,
    ) -> None:
        """Stores the plan.

        Args:
            plan: The images.
            settings: The settings for all of them.
            files: The path of each image by its key; empty for no file.
            jobs: The jobs of the plan to do; None for all.
            manifest: The manifest to write with the files; None for none.
            is_dry_run: Whether images are only read, to report what would be done: their folders
                may be missing, and nothing is computed.
            may_skip: Whether to leave files alone that were made from the same inputs.
        """
        self.rows: list[Row] = []
        self.warnings: list[str] = []
        self.results = Results(list(plan.left_out))
        self._settings = settings
        self._files = files
        self._manifest = manifest
        self._is_dry_run = is_dry_run
        self._may_skip = may_skip
        self._jobs = plan.jobs() if jobs is None else list(jobs)
        self._count = sum(len(job.images) for job in self._jobs)
        self._done = 0
        self._new_folders: list[Path] = []
        self._computed: list[tuple[Job, AnyBake]] = []

    @property
    def next_name(self) -> str:
        """The next image, with its number and the total; empty if all are done."""
        if not self._jobs:
            return ""
        return f"'{self._jobs[0].item.image}' ({self._done + 1} of {self._count})"

    def read_steps(self, depsgraph: bpy.types.Depsgraph) -> Generator[float, None, Compute]:
        """Reads the next image, one frame per step; see `bake_inputs.read_steps`.

        Yields:
            The fraction done.

        Returns:
            A function for any thread that computes the levels and reports the progress of the whole
            model. If the image cannot be read, it does nothing, and `results` has the reason.
        """
        job = self._jobs.pop(0)
        begin = self._done / self._count
        self._done += len(job.images)
        end = self._done / self._count
        targets: list[Path] = []
        try:
            bake = yield from self._read_job(job, depsgraph, targets)
        except bake_inputs.NoSurfaceError as error:
            skipped = self.results.failed if error.problems else self.results.left_out
            skipped += strip_names(job.images, str(error))
            return lambda _: None
        except FAILURES as error:
            self.results.fail(job.images, error)
            return lambda _: None
        if bake is None:
            return lambda _: None

        def compute(progress: Progress) -> None:
            go_on(progress, begin)
            try:
                # Another bake, canceled since the reading, may have removed the folder.
                for target in targets:
                    _make_folder(target, self._new_folders)
                bake.compute(share(progress, begin, end))
            except FAILURES as error:
                self.results.fail(job.images, error)
                return
            if not self._settings.use_images:
                bake.release_pixels()
            self._computed.append((job, bake))

        return compute

    def stage_images(self) -> None:
        """Makes the level images of computed bakes, which frees memory; replaces no image."""
        for _ in self.stage_images_in_steps():
            pass

    def stage_images_in_steps(self) -> Generator[None, None, None]:
        """Does the same as `stage_images`, one bake per step."""
        if not self._settings.use_images:
            return
        for job, bake in list(self._computed):
            try:
                bake.stage_images()
                bake.release_pixels()
            except FAILURES as error:
                self._computed.remove((job, bake))
                self.results.fail(job.images, error)
            yield

    def write(self) -> list[Outcome]:
        """Writes the results of all computed images, or none of them."""
        computed, self._computed = self._computed, []
        bakes = [bake for _, bake in computed]
        try:
            manifests = self._stage_manifest(computed)
            outcomes = write_all([*bakes, *manifests])
        except FAILURES as error:
            for job, _ in computed:
                self.results.fail(job.images, error)
            return []
        for job, bake in computed:
            names = self.results.up_to_date if bake.is_up_to_date else self.results.baked
            names += job.images
        self.results.outcomes += outcomes[: len(bakes)]
        return outcomes

    def _stage_manifest(self, computed: list[tuple[Job, AnyBake]]) -> list[Manifest]:
        """Returns the staged manifest of computed images; empty if none is wanted."""
        if self._manifest is None or not computed:
            return []
        names = {name for job, _ in computed for name in job.images}
        written = [path for _, bake in computed for path in bake.files]
        rows = [row for row in self.rows if row.image in names]
        try:
            _make_folder(self._manifest, self._new_folders)
            return [Manifest(self._manifest, rows, written)]
        except BaseException:
            for _, bake in computed:
                bake.discard()
            raise

    def discard(self) -> None:
        """Deletes staged files, images and folders that were not put into place."""
        for _, bake in self._computed:
            bake.discard()
        self._computed.clear()
        while self._new_folders:
            with suppress(OSError):  # It is not empty.
                self._new_folders.pop().rmdir()

    def _read_job(
        self, job: Job, depsgraph: bpy.types.Depsgraph, targets: list[Path]
    ) -> Generator[float, None, AnyBake | None]:
        """Reads the images of a job; returns None if it was split into several jobs.

        Appends to `targets` the file whose folder was made.
        """
        pair = image_pair(job)
        if not pair.fits:
            self._jobs[:0] = split_job(job, pair)
            self._done -= len(job.images)
            return None
        prepared = prepare(job, pair, self._settings, self._files)
        yield 0.0
        settings = prepared.settings
        is_by_content = self._settings.texture_format in decisions.BY_CONTENT
        if self._is_dry_run:
            self.warnings += engines.format_warnings(
                prepared.picture,
                prepared.target,
                prepared.texture_format,
                may_lose_channels=is_by_content,
                is_stretched=settings.use_multiples_of_4,
            )
            settings = replace(
                settings, filepath="", roughness_filepath="", texture_format="auto", use_images=True
            )
        elif prepared.target is not None:
            _make_folder(prepared.target, self._new_folders)
            targets.append(prepared.target)
        objects = [bpy.data.objects.get(name) for name in job.item.objects]
        request = bake_inputs.Request(
            pair.normal_map or pair.image,
            [obj for obj in objects if obj is not None],
            settings,
            depsgraph,
            roughness_texture_format=prepared.roughness_texture_format,
            may_lose_channels=is_by_content,
            writes_image=pair.normal_map is None or pair.is_normal_map,
            pictures=prepared.pictures,
            may_skip=self._may_skip,
        )
        bake = yield from bake_inputs.read_steps(request)
        self.rows += prepared.rows
        bake.warnings[:0] = _notes(job, prepared)
        self.warnings += bake.warnings
        return bake


def _notes(job: Job, prepared: PreparedJob) -> list[str]:
    """Returns remarks for the user about the images of a job."""
    notes = [*prepared.notes, *((job.item.image, note) for note in job.item.notes)]
    if job.roughness is not None:
        notes += [(job.roughness.image, note) for note in job.roughness.notes]
    return [f"image '{image}' {note}" for image, note in notes]


def _make_folder(file: Path, new_folders: list[Path]) -> None:
    """Makes the folder of a file, and appends newly made folders to `new_folders`."""
    missing: list[Path] = []
    folder = Path(os.path.realpath(file)).parent
    while not folder.exists():
        missing.append(folder)
        folder = folder.parent
    for path in reversed(missing):
        path.mkdir(exist_ok=True)
        new_folders.append(path)
