# SPDX-License-Identifier: GPL-3.0-or-later

"""The results of a model's bake, and the messages about them."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from ...core.outcome import Outcome, reason
from ...core.wording import Sentence, counted, joined, listed, together
from .plan import LeftOut


@dataclass
class Results:
    """The results of a model's bake.

    Attributes:
        left_out: Images that need no bake.
        failed: Images that cannot be baked.
        baked: The names of baked images.
        up_to_date: The names of images whose files were up to date.
        outcomes: The outcomes of the bakes.
    """

    left_out: list[LeftOut]
    failed: list[LeftOut] = field(default_factory=list)
    baked: list[str] = field(default_factory=list)
    up_to_date: list[str] = field(default_factory=list)
    outcomes: list[Outcome] = field(default_factory=list)

    def fail(self, names: Iterable[str], error: BaseException) -> None:
        """Adds images that cannot be baked."""
        self.failed += strip_names(names, reason(error))

    def outcome(self) -> Outcome:
        """Returns the outcome of the whole bake.

        Raises:
            ValueError: No image was baked.
        """
        if not self.outcomes:
            raise ValueError(joined("\n", self.failure_lines()))
        outcomes = self.outcomes
        files = [path for outcome in outcomes for path in outcome.files]
        names = [name for outcome in outcomes for name in outcome.images]
        return Outcome(
            self.summary(files, names),
            images=names,
            files=files,
            warnings=self._problems() + [text for outcome in outcomes for text in outcome.warnings],
            notes=self.left_out_lines() + [text for outcome in outcomes for text in outcome.notes],
        )

    def failure_lines(self) -> list[str]:
        """Returns lines that explain why no image was baked."""
        return [Sentence("no image was baked"), *self._problems(), *self.left_out_lines()]

    def left_out_lines(self) -> list[str]:
        """Returns one line per reason for leaving images out."""
        by_reason: dict[str, list[str]] = {}
        for image in self.left_out:
            by_reason.setdefault(image.reason, []).append(image.image)
        return [
            Sentence("Left out, {}: {}", reason, listed(names))
            for reason, names in by_reason.items()
        ]

    def summary(self, files: Sequence[str], names: Sequence[str]) -> str:
        """Returns one line with the numbers of baked images, files and level images."""
        summary = Sentence("Baked {}", counted(self.baked, "image"))
        if self.failed:
            total = len(self.baked) + len(self.failed)
            summary = Sentence("Baked {} of {} images", len(self.baked), total)
        results = [counted(files, "file")] if files else []
        results += [counted(names, "level image")] if names else []
        if results:
            summary = Sentence("{} into {}", summary, together(results))
        folders = {str(Path(path).parent) for path in files}
        if len(folders) == 1:
            summary = Sentence("{} in '{}'", summary, folders.pop())
        if self.up_to_date:
            summary = joined("; ", [summary, f"{counted(self.up_to_date, 'image')} up to date"])
        if self.failed:
            failed = listed(image.image for image in self.failed)
            summary = Sentence("{}; not baked: {}", summary, failed)
        return summary

    def _problems(self) -> list[str]:
        text = "image '{}' is not baked: {}"
        return [Sentence(text, image.image, image.reason) for image in self.failed]


def strip_names(names: Iterable[str], text: str) -> list[LeftOut]:
    """Returns images with a reason: a message without the image's name at its start."""
    return [LeftOut(name, text.removeprefix(f"image '{name}': ")) for name in names]
