# SPDX-License-Identifier: GPL-3.0-or-later

"""The bake of a model: image after image is read, computed anywhere, and written.

The operator and the command are two ways to call this. An image that cannot be baked does not stop
the others. No more than one image is in memory at a time.
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
from .. import reading, udim
from ..bake import Bake, write_all
from ..choices import Settings
from . import decisions
from .manifest import Manifest
from .plan import Job, Plan
from .preparing import Prepared, pair_of, parted, prepared
from .results import Results, without_names
from .table import Row

Compute = Callable[[Progress], None]
AnyBake = Bake | udim.TiledBake


class ModelBake:
    """One bake of a model.

    `compute` of each image touches no Blender data and runs on any thread; everything else belongs
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
        is_rehearsal: bool = False,
        may_skip: bool = False,
    ) -> None:
        """Takes what there is to do.

        Args:
            plan: The images.
            settings: What to do with all of them.
            files: The path of each image, by its full name; empty for none.
            jobs: Those of the plan that are done; all of them if None.
            manifest: What is written with the files to list them; None for nothing.
            is_rehearsal: Whether images are read to see what would be done: their folders need not
                be there, and nothing is to be computed.
            may_skip: Whether files that were made of the same are left alone.
        """
        self.rows: list[Row] = []
        self.warnings: list[str] = []
        self.results = Results(list(plan.left_out))
        self._settings = settings
        self._files = files
        self._manifest = manifest
        self._is_rehearsal = is_rehearsal
        self._may_skip = may_skip
        self._jobs = plan.jobs() if jobs is None else list(jobs)
        self._count = sum(len(job.images) for job in self._jobs)
        self._done = 0
        self._made_folders: list[Path] = []
        self._computed: list[tuple[Job, AnyBake]] = []

    @property
    def next_name(self) -> str:
        """The image that is next, and how many there are; empty if all are done."""
        if not self._jobs:
            return ""
        return f"'{self._jobs[0].item.image}' ({self._done + 1} of {self._count})"

    def reading(self, depsgraph: bpy.types.Depsgraph) -> Generator[float, None, Compute]:
        """Reads the next image, in steps of a frame; see `reading.reading`.

        Yields:
            The fraction done.

        Returns:
            What then runs in any thread, and reports the progress of the whole model. If the image
            cannot be read it does nothing, and `results` say why.
        """
        job = self._jobs.pop(0)
        begin = self._done / self._count
        self._done += len(job.images)
        end = self._done / self._count
        targets: list[Path] = []
        try:
            made = yield from self._reading(job, depsgraph, targets)
        except reading.NoSurfaceError as error:
            known = self.results.failed if error.problems else self.results.left_out
            known += without_names(job.images, str(error))
            return lambda _: None
        except FAILURES as error:
            self.results.fail(job.images, error)
            return lambda _: None
        if made is None:
            return lambda _: None
        bake = made

        def compute(progress: Progress) -> None:
            go_on(progress, begin)
            try:
                for (
                    target
                ) in targets:  # A bake that was cancelled may just have removed its folder.
                    _make_folder(target, self._made_folders)
                bake.compute(share(progress, begin, end))
            except FAILURES as error:
                self.results.fail(job.images, error)
                return
            if not self._settings.use_images:
                bake.release_pixels()
            self._computed.append((job, bake))

        return compute

    def stage_images(self) -> None:
        """Makes level images of what is computed, which then needs less memory; writes nothing."""
        for _ in self.staging_images():
            pass

    def staging_images(self) -> Generator[None, None, None]:
        """Does what `stage_images` does, in steps of an image."""
        if not self._settings.use_images:
            return
        for one in list(self._computed):
            job, bake = one
            try:
                bake.stage_images()
                bake.release_pixels()
            except FAILURES as error:
                self._computed.remove(one)
                self.results.fail(job.images, error)
            yield

    def write(self) -> list[Outcome]:
        """Writes what is computed, the files of all images together or none of them."""
        computed, self._computed = self._computed, []
        bakes = [bake for _, bake in computed]
        try:
            listing = self._listing(computed)
            written = write_all([*bakes, *listing])
        except FAILURES as error:
            for job, _ in computed:
                self.results.fail(job.images, error)
            return []
        for job, bake in computed:
            known = self.results.up_to_date if bake.is_up_to_date else self.results.baked
            known += job.images
        self.results.outcomes += written[: len(bakes)]
        return written

    def _listing(self, computed: list[tuple[Job, AnyBake]]) -> list[Manifest]:
        """Returns the manifest of what is computed, staged; none if it is not asked for."""
        if self._manifest is None or not computed:
            return []
        names = {name for job, _ in computed for name in job.images}
        written = [path for _, bake in computed for path in bake.files]
        rows = [row for row in self.rows if row.image in names]
        try:
            _make_folder(self._manifest, self._made_folders)
            return [Manifest(self._manifest, rows, written)]
        except BaseException:
            for _, bake in computed:
                bake.discard()
            raise

    def discard(self) -> None:
        """Removes what was staged, if it was not put into place."""
        for _, bake in self._computed:
            bake.discard()
        self._computed.clear()
        while self._made_folders:
            with suppress(OSError):  # It is not empty.
                self._made_folders.pop().rmdir()

    def _reading(
        self, job: Job, depsgraph: bpy.types.Depsgraph, targets: list[Path]
    ) -> Generator[float, None, AnyBake | None]:
        """Reads the images of a job; returns None where it is now several other ones.

        `targets` gets the file whose folder was made.
        """
        pair = pair_of(job)
        if not pair.fits:
            self._jobs[:0] = parted(job, pair)
            self._done -= len(job.images)
            return None
        made = prepared(job, pair, self._settings, self._files)
        yield 0.0
        settings = made.settings
        fits = self._settings.texture_format in decisions.BY_CONTENT
        if self._is_rehearsal:
            self.warnings += engines.format_warnings(
                made.picture,
                made.target,
                made.texture_format,
                may_lose_channels=fits,
                is_stretched=settings.use_multiples_of_4,
            )
            settings = replace(
                settings, filepath="", roughness_filepath="", texture_format="auto", use_images=True
            )
        elif made.target is not None:
            _make_folder(made.target, self._made_folders)
            targets.append(made.target)
        shown = {name: bpy.data.objects.get(name) for name in job.item.objects}
        request = reading.Request(
            pair.normal_map or pair.image,
            [obj for obj in shown.values() if obj is not None],
            settings,
            depsgraph,
            roughness_texture_format=made.roughness_texture_format,
            may_lose_channels=fits,
            writes_image=pair.normal_map is None or pair.is_normal_map,
            pictures=made.pictures,
            may_skip=self._may_skip,
        )
        bake = yield from reading.reading(request)
        self.rows += made.rows
        bake.warnings[:0] = _notes(job, made)
        self.warnings += bake.warnings
        return bake


def _notes(job: Job, made: Prepared) -> list[str]:
    """Returns what a user should know of the images of a job."""
    notes = [*made.notes, *((job.item.image, note) for note in job.item.notes)]
    if job.roughness is not None:
        notes += [(job.roughness.image, note) for note in job.roughness.notes]
    return [f"image '{image}' {note}" for image, note in notes]


def _make_folder(file: Path, made: list[Path]) -> None:
    """Makes the folder of a file; `made` gets the folders that were not there."""
    missing: list[Path] = []
    folder = Path(os.path.realpath(file)).parent
    while not folder.exists():
        missing.append(folder)
        folder = folder.parent
    for path in reversed(missing):
        path.mkdir(exist_ok=True)
        made.append(path)
