# SPDX-License-Identifier: GPL-3.0-or-later

"""The bake of a model: image after image is read, computed anywhere, and written.

The operator and the command are two ways to call this. An image that cannot be baked does not stop
the others. No more than one image is in memory at a time.
"""

import os
from collections.abc import Callable, Generator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path

import bpy

from ...bridge import images
from ...bridge.files import engines, textures
from ...bridge.images import Picture
from ...core.jobs import Progress, go_on, share
from ...core.outcome import FAILURES, Outcome
from ...core.wording import counted, listed
from .. import contents, lookups, reading, udim
from ..bake import Bake, write_all
from ..choices import FILTERS, Settings
from . import decisions
from .plan import Item, Job, LeftOut, Plan, image_of

Compute = Callable[[Progress], None]
AnyBake = Bake | udim.TiledBake


@dataclass(frozen=True)
class Row:
    """What is done with an image.

    Attributes:
        image: Its name.
        size: Such as "2048 x 2048".
        objects: The names of the objects whose surfaces count.
        content: What it is taken for.
        uses: What shaders take of it, which says why.
        filter: The label of the filter.
        format: What the file holds.
        file: The path of the file, or of all levels; empty for none.
        remarks: More about what is done.
    """

    image: str
    size: str
    objects: tuple[str, ...]
    content: str
    uses: tuple[str, ...]
    filter: str
    format: str
    file: str
    remarks: tuple[str, ...] = ()


class ModelBake:
    """One bake of a model.

    `compute` of each image touches no Blender data and runs on any thread; everything else belongs
    on the main thread.
    """

    def __init__(
        self, plan: Plan, settings: Settings, files: dict[str, str], *, is_rehearsal: bool = False
    ) -> None:
        """Takes what there is to do.

        Args:
            plan: The images.
            settings: What to do with all of them.
            files: The path of each image, by its full name; empty for none.
            is_rehearsal: Whether images are read to see what would be done: their folders need not
                be there, and nothing is to be computed.
        """
        self.rows: list[Row] = []
        self.warnings: list[str] = []
        self.left_out = list(plan.left_out)
        self.failed: list[LeftOut] = []
        self._settings = settings
        self._files = files
        self._is_rehearsal = is_rehearsal
        self._jobs = plan.jobs()
        self._count = len(plan.items)
        self._done = 0
        self._made_folders: list[Path] = []
        self._computed: list[tuple[Job, AnyBake]] = []
        self._baked: list[str] = []
        self._outcomes: list[Outcome] = []

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
            cannot be read it does nothing, and `failed` or `left_out` say why.
        """
        job = self._jobs.pop(0)
        begin = self._done / self._count
        self._done += len(job.images)
        end = self._done / self._count
        try:
            made = yield from self._reading(job, depsgraph)
        except reading.NoSurfaceError as error:
            known = self.failed if error.problems else self.left_out
            known += [LeftOut(name, _without_name(str(error), name)) for name in job.images]
            return lambda _: None
        except FAILURES as error:
            self._fail(job, error)
            return lambda _: None
        if made is None:
            return lambda _: None
        bake = made

        def compute(progress: Progress) -> None:
            go_on(progress, begin)
            try:
                bake.compute(share(progress, begin, end))
            except FAILURES as error:
                self._fail(job, error)
                return
            if not self._settings.use_images:
                bake.let_pixels_go()
            self._computed.append((job, bake))

        return compute

    def stage_images(self) -> None:
        """Makes level images of what is computed, which then needs less memory; writes nothing."""
        if not self._settings.use_images:
            return
        computed, self._computed = self._computed, []
        for job, bake in computed:
            try:
                bake.stage_images()
                bake.let_pixels_go()
                self._computed.append((job, bake))
            except FAILURES as error:
                self._fail(job, error)

    def write(self) -> list[Outcome]:
        """Writes what is computed, the files of all images together or none of them."""
        computed, self._computed = self._computed, []
        try:
            written = write_all([bake for _, bake in computed])
        except FAILURES as error:
            for job, _ in computed:
                self._fail(job, error)
            return []
        self._baked += [name for job, _ in computed for name in job.images]
        self._outcomes += written
        return written

    def discard(self) -> None:
        """Removes what was staged, if it was not put into place."""
        for _, bake in self._computed:
            bake.discard()
        self._computed.clear()
        while self._made_folders:
            with suppress(OSError):  # It is not empty.
                self._made_folders.pop().rmdir()

    def outcome(self) -> Outcome:
        """Returns what was done, with all that a user should look at.

        Raises:
            ValueError: Nothing was baked.
        """
        problems = [f"image '{one.image}' is not baked: {one.reason}" for one in self.failed]
        aside = self.lines_of_left_out()
        if not self._outcomes:
            raise ValueError("\n".join(self.nothing()))
        files = [path for one in self._outcomes for path in one.files]
        names = [name for one in self._outcomes for name in one.images]
        return Outcome(
            self._summary(files, names),
            images=names,
            files=files,
            warnings=problems + [text for one in self._outcomes for text in one.warnings],
            notes=aside + [text for one in self._outcomes for text in one.notes],
        )

    def nothing(self) -> list[str]:
        """Returns lines that say why there is no image that can be baked."""
        problems = [f"image '{one.image}' is not baked: {one.reason}" for one in self.failed]
        return ["no image was baked", *problems, *self.lines_of_left_out()]

    def lines_of_left_out(self) -> list[str]:
        """Returns a line for each reason why images are left out."""
        by_reason: dict[str, list[str]] = {}
        for one in self.left_out:
            by_reason.setdefault(one.reason, []).append(one.image)
        return [f"Left out, {reason}: {listed(names)}" for reason, names in by_reason.items()]

    def _reading(
        self, job: Job, depsgraph: bpy.types.Depsgraph
    ) -> Generator[float, None, AnyBake | None]:
        """Reads the images of a job; returns None where it is now several other ones."""
        image = image_of(job.item.full_name)
        partner = job.roughness.full_name if job.roughness is not None else job.normal_map
        other = image_of(partner) if partner else None
        if other is not None and (tuple(image.size) != tuple(other.size) or not image.size[0]):
            self._part(job, image, other)
            return None
        normal_map = image if job.roughness is not None else other
        rough = other if job.roughness is not None else image
        picture = _first(image)
        decision = decisions.decided(job.item, picture)
        picture = contents.as_content(picture, decision.content)
        file = self._files[job.item.full_name]
        chosen = self._format(job.item, picture, decision.content, file)
        settings = lookups.resolved(
            replace(
                self._settings,
                content=decision.content,
                threshold=job.item.threshold,
                texture_format=chosen,
                filepath=file,
            )
        )
        rough_format = ""
        row = Row(
            image.name,
            _size(image),
            job.item.objects,
            decisions.shown_content(decision.content),
            job.item.uses,
            FILTERS[settings.filter].label,
            self._shown_format(picture, file, chosen),
            file,
        )
        rows = [row]
        if normal_map is not None and rough is not None:
            item = job.roughness or job.item
            rough_file = self._files[item.full_name]
            rough_picture = picture if rough == image else _first(rough)
            rough_format = self._format(item, rough_picture, "data", rough_file)
            settings = replace(
                settings,
                content="normal",
                filepath=file if rough == other else "",
                roughness=rough.name,
                roughness_channel=item.roughness_channel,
                roughness_filepath=rough_file,
            )
            told = f"its levels compensate for detail lost in the levels of '{normal_map.name}'"
            if rough == other:
                rows.append(
                    Row(
                        rough.name,
                        _size(rough),
                        item.objects,
                        decisions.shown_content("data"),
                        item.uses,
                        row.filter,
                        self._shown_format(rough_picture, rough_file, rough_format),
                        rough_file,
                        (told,),
                    )
                )
            else:
                rows[0] = replace(row, remarks=(told,))
        fits = self._settings.texture_format in decisions.BY_CONTENT
        if self._is_rehearsal:
            target = Path(file) if file else None
            self.warnings += engines.checked(picture, target, chosen, may_lose_channels=fits)
            settings = replace(
                settings, filepath="", roughness_filepath="", texture_format="auto", use_images=True
            )
        else:
            self._make_folder(file)
        shown = {name: bpy.data.objects.get(name) for name in job.item.objects}
        objects = [obj for obj in shown.values() if obj is not None]
        bake = yield from reading.reading(
            normal_map or image,
            objects,
            settings,
            depsgraph,
            roughness_texture_format=rough_format,
            may_lose_channels=fits,
            writes_image=normal_map is None or normal_map == image,
        )
        self.rows += rows
        notes = [(job.item, note) for note in (decision.note, *job.item.notes) if note]
        if job.roughness is not None:
            notes += [(job.roughness, note) for note in job.roughness.notes]
        bake.warnings[:0] = [f"image '{one.image}' {note}" for one, note in notes]
        self.warnings += bake.warnings
        return bake

    def _part(self, job: Job, image: bpy.types.Image, other: bpy.types.Image) -> None:
        """Has the images of a job baked by themselves."""
        rough, normal_map = (other, image) if job.roughness is not None else (image, other)
        note = f"does not compensate for '{normal_map.name}', "
        if normal_map.size[0]:
            note += f"whose size is {_size(normal_map)}, and its own {_size(rough)}"
        else:
            note += "which has no pixels"
        item = job.roughness or job.item
        alone = Job(replace(item, notes=(*item.notes, note)))
        self._jobs[:0] = [Job(job.item), alone] if job.roughness is not None else [alone]
        self._done -= len(job.images)

    def _make_folder(self, file: str) -> None:
        """Makes the folder of a file, if there is to be a file."""
        missing: list[Path] = []
        folder = Path(os.path.realpath(file)).parent
        while file and not folder.exists():
            missing.append(folder)
            folder = folder.parent
        for path in reversed(missing):
            path.mkdir()
            self._made_folders.append(path)

    def _format(self, item: Item, picture: Picture, content: str, file: str) -> str:
        if self._settings.texture_format not in decisions.BY_CONTENT:
            return self._settings.texture_format
        return decisions.texture_format(item, picture, content, Path(file) if file else None)

    def _shown_format(self, picture: Picture, file: str, chosen: str) -> str:
        return decisions.shown_format(picture, Path(file) if file else None, chosen)

    def _fail(self, job: Job, error: BaseException) -> None:
        text = str(error) or type(error).__name__
        self.failed += [LeftOut(name, _without_name(text, name)) for name in job.images]

    def _summary(self, files: Sequence[str], names: Sequence[str]) -> str:
        text = f"Baked {counted(self._baked, 'image')}"
        if self.failed:
            text = f"Baked {len(self._baked)} of {len(self._baked) + len(self.failed)} images"
        results = [counted(files, "file")] if files else []
        results += [counted(names, "level image")] if names else []
        if results:
            text += f" into {' and '.join(results)}"
        folders = {str(Path(path).parent) for path in files}
        if len(folders) == 1:
            text += f" in '{folders.pop()}'"
        if self.failed:
            text += f"; not baked: {listed(one.image for one in self.failed)}"
        return text


def _first(image: bpy.types.Image) -> Picture:
    """Returns the pixels of an image, or of its first tile that can be read."""
    numbers = images.tile_numbers(image)
    return images.read_tile(image, numbers[0]) if numbers else images.read(image)


def _size(image: bpy.types.Image) -> str:
    width, height = image.size
    tiles = images.tile_numbers(image)
    count = f"{counted(tiles, 'tile')}, " if tiles else ""
    return f"{count}{width} x {height}"


def _without_name(text: str, name: str) -> str:
    """Returns a message that names its image already without that."""
    return text.removeprefix(f"image '{name}': ")


def shown_file(path: str) -> str:
    """Returns how to call a file of a row."""
    return textures.shown(Path(path)).strip("'") if path else ""
