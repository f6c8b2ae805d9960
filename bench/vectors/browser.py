# SPDX-License-Identifier: GPL-3.0-or-later

"""Drawings as Chromium shows them: many on a page, photographed without a window."""

import base64
import hashlib
import os
import re
import subprocess
import tempfile
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from xml.sax.saxutils import escape, quoteattr

import numpy as np
from numpy.typing import NDArray
from PIL import Image

Pixels = NDArray[np.float64]

MOST_ROWS = 4000
MOST_SECONDS = 90
_OPTIONS = (
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--hide-scrollbars",
    "--disable-lcd-text",
    "--font-render-hinting=none",
    "--force-color-profile=srgb",
    "--default-background-color=00000000",
    "--allow-file-access-from-files",
    "--disable-background-networking",
    "--no-first-run",
)
# A picture that is embedded in a page reads no files; a page of its own does.
_NEEDS_FILES = re.compile(rb"""(href|@import|url\()\s*=?\s*["']?(?!["'#\s]|data:)[^"'>)]+""")
_GENERIC = {
    "Times New Roman": ("Liberation Serif", "Noto Serif", "DejaVu Serif"),
    "Arial": ("Liberation Sans", "Noto Sans", "DejaVu Sans"),
    "Courier New": ("Liberation Mono", "Noto Mono", "DejaVu Sans Mono"),
    "Monospace": ("Courier New", "Liberation Mono", "Noto Mono", "DejaVu Sans Mono"),
    "Comic Sans MS": ("Yellowtail", "Times New Roman", "Noto Serif"),
    "Impact": ("Sedgwick Ave Display", "Arial", "Noto Sans"),
}


@dataclass(frozen=True, slots=True)
class Wanted:
    """A drawing to be shown.

    Attributes:
        path: The file's path.
        width: The picture's width, in pixels.
        height: The picture's height, in pixels.
        scale: Pixels of the picture per pixel of the drawing's own size.
    """

    path: Path
    width: int
    height: int
    scale: float


class Browser:
    """Chromium, with fonts of one folder alone where one is given."""

    def __init__(self, program: str, fonts: Path | None, kept: Path | None = None) -> None:
        """Takes the program, the folder, and one in which pictures are kept for later runs."""
        self._program = program
        self._fonts = fonts
        self._kept = kept
        if kept is not None:
            kept.mkdir(parents=True, exist_ok=True)

    def shown(self, drawings: Iterable[Wanted]) -> dict[Path, Pixels | None]:
        """Returns pictures, premultiplied, in 0..255, the top row first; None for what failed."""
        found: dict[Path, Pixels | None] = {}
        missing: list[Wanted] = []
        for one in drawings:
            kept = self._kept_as(one)
            if kept is not None and kept.exists():
                with Image.open(kept) as file:
                    found[one.path] = premultiplied(np.asarray(file.convert("RGBA")))
            else:
                missing.append(one)
        for batch in _batches(missing):
            pictures = self._page(batch)
            if pictures is None:
                pictures = [(self._page([one]) or [None])[0] for one in batch]
            for one, each in zip(batch, pictures, strict=True):
                found[one.path] = premultiplied(each) if each is not None else None
                kept = self._kept_as(one)
                if each is not None and kept is not None:
                    Image.fromarray(each).save(kept)
        return found

    def _kept_as(self, one: Wanted) -> Path | None:
        if self._kept is None:
            return None
        text = f"{one.path.name} {one.width} {one.height} {one.scale:.9g} {self._fonts} "
        name = hashlib.sha256(text.encode() + one.path.read_bytes()).hexdigest()[:32]
        return self._kept / f"{name}.png"

    def _page(self, drawings: list[Wanted]) -> list[NDArray[np.uint8] | None] | None:
        """One page of drawings below each other; None where the browser does not manage."""
        with tempfile.TemporaryDirectory() as folder:
            page, target = Path(folder) / "page.html", Path(folder) / "page.png"
            page.write_text(_markup(drawings), encoding="utf-8")
            size = max(one.width for one in drawings), sum(one.height for one in drawings)
            command = [
                self._program, *_OPTIONS, f"--user-data-dir={folder}/profile",
                f"--window-size={size[0]},{size[1]}", f"--screenshot={target}", page.as_uri(),
            ]  # fmt: skip
            try:
                subprocess.run(
                    command,
                    env=self._environment(Path(folder)),
                    capture_output=True,
                    check=False,
                    timeout=MOST_SECONDS,
                )
            except subprocess.TimeoutExpired:
                return None
            if not target.exists():
                return None
            with Image.open(target) as file:
                pixels = np.asarray(file.convert("RGBA"))
        if pixels.shape[:2] != (size[1], size[0]):
            return None
        found: list[NDArray[np.uint8] | None] = []
        top = 0
        for one in drawings:
            found.append(pixels[top : top + one.height, : one.width])
            top += one.height
        return found

    def _environment(self, folder: Path) -> dict[str, str]:
        found = dict(os.environ)
        if self._fonts is not None:
            settings = folder / "fonts.conf"
            settings.write_text(_font_settings(self._fonts, folder), encoding="utf-8")
            found["FONTCONFIG_FILE"] = str(settings)
        return found


def premultiplied(straight: NDArray[np.uint8]) -> Pixels:
    """Returns a picture with its colors multiplied by alpha."""
    found = straight.astype(np.float64)
    found[..., :3] *= found[..., 3:] / 255.0
    return found


def _batches(drawings: Iterable[Wanted]) -> Iterator[list[Wanted]]:
    batch: list[Wanted] = []
    for one in drawings:
        if batch and sum(each.height for each in batch) + one.height > MOST_ROWS:
            yield batch
            batch = []
        batch.append(one)
    if batch:
        yield batch


def _markup(drawings: list[Wanted]) -> str:
    parts = ["<!doctype html><body style='margin:0'>"]
    for one in drawings:
        box = f"display:block;width:{one.width}px;height:{one.height}px;overflow:hidden"
        data = one.path.read_bytes()
        if _NEEDS_FILES.search(data):
            width, height = one.width / one.scale, one.height / one.scale
            style = (
                f"border:0;width:{width}px;height:{height}px;transform-origin:0 0;"
                f"transform:scale({one.scale})"
            )
            shown = (
                f"<iframe style='{style}' src={quoteattr(one.path.absolute().as_uri())}></iframe>"
            )
        else:
            address = "data:image/svg+xml;base64," + base64.b64encode(data).decode()
            shown = f"<img style='{box}' src='{address}'>"
        parts.append(f"<div style='{box}'>{shown}</div>")
    return "\n".join(parts)


def _font_settings(fonts: Path, folder: Path) -> str:
    aliases = "".join(
        f"<alias binding='same'><family>{name}</family><prefer>"
        + "".join(f"<family>{each}</family>" for each in (name, *others))
        + "</prefer></alias>"
        for name, others in _GENERIC.items()
    )
    return (
        "<?xml version='1.0'?><!DOCTYPE fontconfig SYSTEM 'fonts.dtd'><fontconfig>"
        f"<dir>{escape(str(fonts.absolute()))}</dir><cachedir>{folder}/cache</cachedir>{aliases}"
        "</fontconfig>"
    )
