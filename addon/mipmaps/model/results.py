# SPDX-License-Identifier: GPL-3.0-or-later

"""What became of the images of a model, and what to tell of it."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from ...core.outcome import Outcome, reason
from ...core.wording import Sentence, counted, joined, listed, together
from .plan import LeftOut


@dataclass
class Results:
    """What became of the images of a model.

    Attributes:
        left_out: Those that are not to be baked.
        failed: Those that cannot be baked.
        baked: The names of those that were baked.
        up_to_date: The names of those whose files were left alone, as they are up to date.
        outcomes: Of the bakes.
    """

    left_out: list[LeftOut]
    failed: list[LeftOut] = field(default_factory=list)
    baked: list[str] = field(default_factory=list)
    up_to_date: list[str] = field(default_factory=list)
    outcomes: list[Outcome] = field(default_factory=list)

    def fail(self, names: Iterable[str], error: BaseException) -> None:
        """Notes that images cannot be baked."""
        self.failed += without_names(names, reason(error))

    def outcome(self) -> Outcome:
        """Returns what was done, with all that a user should look at.

        Raises:
            ValueError: Nothing was baked.
        """
        if not self.outcomes:
            raise ValueError(joined("\n", self.nothing()))
        files = [path for one in self.outcomes for path in one.files]
        names = [name for one in self.outcomes for name in one.images]
        return Outcome(
            self.summary(files, names),
            images=names,
            files=files,
            warnings=self._problems() + [text for one in self.outcomes for text in one.warnings],
            notes=self.lines_of_left_out() + [text for one in self.outcomes for text in one.notes],
        )

    def nothing(self) -> list[str]:
        """Returns lines that say why there is no image that can be baked."""
        return [Sentence("no image was baked"), *self._problems(), *self.lines_of_left_out()]

    def lines_of_left_out(self) -> list[str]:
        """Returns a line for each reason why images are left out."""
        by_reason: dict[str, list[str]] = {}
        for one in self.left_out:
            by_reason.setdefault(one.reason, []).append(one.image)
        return [
            Sentence("Left out, {}: {}", reason, listed(names))
            for reason, names in by_reason.items()
        ]

    def summary(self, files: Sequence[str], names: Sequence[str]) -> str:
        """Returns how many images were baked into which files and level images, in a line."""
        done = Sentence("Baked {}", counted(self.baked, "image"))
        if self.failed:
            total = len(self.baked) + len(self.failed)
            done = Sentence("Baked {} of {} images", len(self.baked), total)
        results = [counted(files, "file")] if files else []
        results += [counted(names, "level image")] if names else []
        if results:
            done = Sentence("{} into {}", done, together(results))
        folders = {str(Path(path).parent) for path in files}
        if len(folders) == 1:
            done = Sentence("{} in '{}'", done, folders.pop())
        if self.up_to_date:
            done = joined("; ", [done, f"{counted(self.up_to_date, 'image')} up to date"])
        if self.failed:
            failed = listed(one.image for one in self.failed)
            done = Sentence("{}; not baked: {}", done, failed)
        return done

    def _problems(self) -> list[str]:
        return [
            Sentence("image '{}' is not baked: {}", one.image, one.reason) for one in self.failed
        ]


def without_names(names: Iterable[str], text: str) -> list[LeftOut]:
    """Returns images with a reason, without the name where a message says that first."""
    return [LeftOut(name, text.removeprefix(f"image '{name}': ")) for name in names]
