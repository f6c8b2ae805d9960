# SPDX-License-Identifier: GPL-3.0-or-later

"""Sampling tables: built or loaded anywhere, then written as texts of Blender or as files."""

import tempfile
from collections.abc import Sequence
from functools import partial
from pathlib import Path

import bpy
import prefilter
from prefilter._work.resampling.resampling import load
from prefilter.sampling.sampling_table import STANDARD_TARGETS

from ..bridge.files import staging
from ..core.jobs import Progress, go_on, share
from ..core.outcome import Outcome
from ..core.wording import Sentence, listed
from .choices import LANGUAGES, METHODS, TABLE_FILTERS, TableSettings

ENDINGS = tuple(f".{language}" for language in LANGUAGES)
"""What files of tables may end in, which says what is written."""

_BUILT = 0.9  # What the progress is once there is a table.
_TEXT_KEY = "prefilter_sampling_table"


class TableMaking:
    """One table, and what is written of it.

    `write` belongs on the main thread; `compute` touches no Blender data and runs on any thread.
    """

    def __init__(self, settings: TableSettings, targets: Sequence[Path] = ()) -> None:
        """Keeps the settings.

        Args:
            settings: The filter, the number of texels, and more.
            targets: Files to write, each in the language that its ending says; if there is none, a
                text is made in the language of the settings.
        """
        self.text: bpy.types.Text | None = None
        self._settings = settings
        self._targets = targets
        self._table: prefilter.SamplingTable | None = None
        self._source = ""
        self._staged: list[staging.StagedFile] = []

    def compute(self, progress: Progress) -> None:
        """Builds or loads the table, and stages the files.

        Raises:
            prefilter.Cancelled: `progress` returned False.
            ValueError: The settings ask for a table that cannot be, or the file holds none.
            OSError: A file cannot be read or written.
        """
        go_on(progress, 0.0)
        self._table = self._made(share(progress, 0.0, _BUILT))
        go_on(progress, _BUILT)
        for target in self._targets:
            write = partial(_write, self._table, target.suffix.lower().removeprefix("."))
            self._staged.append(staging.stage_with(target, write))
        if not self._targets:
            self._source = _source(self._table, self._settings.language)
        go_on(progress, 1.0)

    def write(self) -> Outcome:
        """Puts the files into place, or writes the text.

        Raises:
            OSError: It cannot be.
        """
        table = self._table
        assert table is not None
        if self._targets:
            staging.commit_all(self._staged)
            where = listed(str(target) for target in self._targets)
        else:
            of = table.filter if table.target == table.filter else f"{table.filter}-{table.target}"
            name = f"{of}-{table.texels}.{self._settings.language}"
            self.text = _write_text(name, self._source)
            where = listed([self.text.name])
        return Outcome(
            Sentence(
                "Wrote {}: {} from {} texels, with {} times the error of trilinear interpolation",
                *(where, Sentence(TABLE_FILTERS[table.target].label), table.texels),
                f"{table.error_ratio:.3g}",
            ),
            files=[str(target) for target in self._targets],
            notes=_proof(table),
        )

    def discard(self) -> None:
        """Removes files that were staged, if they were not put into place."""
        for staged in self._staged:
            staged.discard()

    def _made(self, progress: Progress) -> "prefilter.SamplingTable":
        settings = self._settings
        if settings.table:
            return load("Load", settings.table)
        target = None if settings.target in ("filter", settings.filter) else settings.target
        has_standard = target is None or (settings.filter, target) in STANDARD_TARGETS
        if settings.is_standard and has_standard and str(settings.texels) in METHODS:
            return prefilter.SamplingTable.standard(settings.filter, settings.texels, target=target)
        return prefilter.SamplingTable.build(
            settings.filter,
            texels=settings.texels,
            subdomains=(settings.grid, settings.grid, settings.slices),
            degree=settings.degree,
            ramp_weight=settings.ramp_weight,
            spectrum=settings.spectrum,
            target=target,
            certify=settings.use_certify,
            progress=progress,
            threads=settings.threads,
        )


def effort(settings: TableSettings) -> float:
    """Returns about how long it takes, in a unit of its own."""
    columns = (settings.grid + 1) // 2
    parts = columns * (columns + 1) / 2 * settings.slices
    return parts * settings.texels**2 * settings.degree**3 * (30.0 if settings.use_certify else 1.0)


def _proof(table: "prefilter.SamplingTable") -> list[str]:
    """Returns what is known about how good the sets are."""
    gaps = table.gaps
    if gaps is None:
        return []
    proven = int((gaps == 0.0).sum())
    if proven == len(gaps):
        return [f"All {proven} sets of texels are proven to be the best"]
    return [
        f"{proven} of {len(gaps)} sets of texels are proven to be the best; the errors of others "
        f"may be up to {100 * gaps.max():.2g} % too large"
    ]


def _source(table: "prefilter.SamplingTable", language: str) -> str:
    if language == "json":
        with tempfile.TemporaryDirectory() as folder:
            copy = Path(folder) / "table.json"
            table.save(copy)
            return copy.read_text(encoding="utf-8")
    written = {"glsl": table.glsl, "hlsl": table.hlsl, "osl": table.osl}
    return written[language]()


def _write(table: "prefilter.SamplingTable", language: str, path: Path) -> None:
    path.write_text(_source(table, language), encoding="utf-8")


def _write_text(name: str, source: str) -> bpy.types.Text:
    """Writes a text, over the one that was written before under this name."""
    ours = (text for text in bpy.data.texts if text.get(_TEXT_KEY) == name)
    found = next(ours, None) or bpy.data.texts.new(name)
    found[_TEXT_KEY] = name
    found.from_string(source)
    # Else editors scroll to the end.
    found.cursor_set(0)
    return found
