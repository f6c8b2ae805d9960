# SPDX-License-Identifier: GPL-3.0-or-later

"""The manifest: a JSON file that lists the images of a model with their files and formats."""

import json
import os
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

from prefilter.workflows.files import target_files

from ...bridge.files import staging
from ...bridge.files.staging import StagedFile
from ...core.outcome import Outcome
from ...core.wording import Sentence, counted
from .. import udim
from .table import Row


def check_target(path: str) -> Path:
    """Returns the absolute path of a manifest, whose folder may be missing.

    Raises:
        ValueError: It does not end in .json.
        OSError: The file, or the folder, is read-only.
    """
    target = Path(os.path.realpath(path))
    if target.suffix.lower() != ".json":
        raise ValueError(f"--manifest: found '{path}'; it needs the extension .json")
    return staging.check_output(path) if target.parent.exists() else target


class Manifest:
    """A manifest, written together with the files of the images; it has the interface of a bake."""

    def __init__(self, target: Path, rows: Sequence[Row], written: Iterable[Path]) -> None:
        """Stages the file.

        Args:
            target: The file, from `check_target`.
            rows: A description of each image's bake.
            written: The files of all images.

        Raises:
            OSError: It cannot be written.
        """
        self._images = list(_entries(rows, set(written), target.parent))
        text = json.dumps({"images": self._images}, indent=2, ensure_ascii=False) + "\n"
        self._target = target
        self.staged_files: Sequence[StagedFile] = [staging.stage_data(target, text.encode())]

    def stage_images(self) -> None:
        """Does nothing: a manifest has no level images."""

    def finish(self) -> Outcome:
        """Returns the outcome."""
        listed = counted(self._images, "image")
        return Outcome(Sentence("Listed {} in '{}'", listed, self._target))

    def discard(self) -> None:
        """Deletes the staged file if it was not put into place."""
        for file in self.staged_files:
            file.discard()


def _entries(rows: Sequence[Row], written: set[Path], folder: Path) -> Iterator[dict[str, Any]]:
    for row in rows:
        files = [
            Path(os.path.relpath(file, folder)).as_posix()
            for path in udim.paths(row.file, row.tiles)
            for file in target_files.files_of(Path(os.path.realpath(path)))
            if file in written
        ]
        if files:
            yield {
                "image": row.image,
                "role": row.content,
                "uses": list(row.uses),
                "file": files[0],
                "files": files,
                "size": list(row.sides),
                "format": row.format,
            }
