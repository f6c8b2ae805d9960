# SPDX-License-Identifier: GPL-3.0-or-later

"""Building or loading sampling tables, and writing them as files."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, cast

import prefilter

from ...files import staging
from ...files.claims import temporary_folder
from ...options.images import METHODS, TABLE_FILTERS
from ...options.sampling import LANGUAGES, TableSettings
from ...sampling.sampling_table import STANDARD_TARGETS
from ..outcome import Outcome
from ..progress import Progress, go_on, share
from ..wording import Sentence, listed
from .resampling import load

ENDINGS = tuple(f".{language}" for language in LANGUAGES)
"""Extensions of table files, which select the language."""

_BUILT = 0.9  # Progress once the table exists.


class TableMaking:
    """The making of one table and its files."""

    def __init__(self, settings: TableSettings, targets: Sequence[Path] = ()) -> None:
        """Takes the settings.

        Args:
            settings: The filter, the number of texels, and more.
            targets: Files to write, each in the language of its extension; if empty, the text is
                kept in `source`, in the language of the settings.
        """
        self.source = ""
        self.settings = settings
        self.targets = targets
        self._table: prefilter.SamplingTable | None = None
        self._staged: list[staging.StagedFile] = []

    @property
    def table(self) -> "prefilter.SamplingTable":
        """The table that was built or loaded."""
        assert self._table is not None
        return self._table

    def compute(self, progress: Progress) -> None:
        """Builds or loads the table, and stages the files.

        Raises:
            prefilter.Cancelled: `progress` returned False.
            ValueError: The settings allow no table, or the file holds none.
            OSError: A file cannot be read or written.
        """
        go_on(progress, 0.0)
        self._table = self._made(share(progress, 0.0, _BUILT))
        go_on(progress, _BUILT)
        for target in self.targets:
            source = _source(self._table, target.suffix.lower().removeprefix("."))
            self._staged.append(staging.stage_data(target, source.encode()))
        if not self.targets:
            self.source = _source(self._table, self.settings.language)
        go_on(progress, 1.0)

    def write(self) -> Outcome:
        """Puts the files into place.

        Raises:
            OSError: A file cannot be put into place.
        """
        staging.commit_all(self._staged)
        return self.outcome([str(target) for target in self.targets])

    def outcome(self, names: Sequence[str]) -> Outcome:
        """Returns the outcome for a table that was written under some names."""
        table = self.table
        return Outcome(
            Sentence(
                "Wrote {}: {} from {} texels, with {} times the error of trilinear interpolation",
                *(listed(names), Sentence(TABLE_FILTERS[table.target].label), table.texels),
                f"{table.error_ratio:.3g}",
            ),
            files=[str(target) for target in self.targets],
            notes=_proof(table),
        )

    def discard(self) -> None:
        """Removes staged files that were not put into place."""
        for staged in self._staged:
            staged.discard()

    def _made(self, progress: Progress) -> "prefilter.SamplingTable":
        settings = self.settings
        if settings.table:
            return load("Load", settings.table)
        target = None if settings.target in ("filter", settings.filter) else settings.target
        has_standard = target is None or (settings.filter, target) in STANDARD_TARGETS
        if settings.is_standard and has_standard and str(settings.texels) in METHODS:
            return prefilter.SamplingTable.standard(
                cast("Any", settings.filter), settings.texels, target=target
            )
        return prefilter.SamplingTable.build(
            cast("Any", settings.filter),
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


def _proof(table: "prefilter.SamplingTable") -> list[str]:
    """Returns a note about the proven quality of the sets of texels."""
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
        with temporary_folder() as folder:
            copy = folder / "table.json"
            table.save(copy)
            return copy.read_text(encoding="utf-8")
    written = {"glsl": table.glsl, "hlsl": table.hlsl, "osl": table.osl}
    return written[language]()
