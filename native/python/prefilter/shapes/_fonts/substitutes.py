# SPDX-License-Identifier: GPL-3.0-or-later

"""Families that stand for generic ones, and for those that are missing, as the system has them."""

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from functools import lru_cache
from pathlib import Path

# What stands for a generic family, and for well-known ones where they are missing: the first that
# is there. The first ones of each have the same advances.
SERIF: tuple[str, ...] = ("times new roman", "times", "liberation serif", "tinos", "nimbus roman")
SERIF += ("dejavu serif", "noto serif", "georgia")
SANS: tuple[str, ...] = ("arial", "helvetica", "liberation sans", "arimo", "nimbus sans")
SANS += ("dejavu sans", "bitstream vera sans", "verdana", "noto sans", "inter", "roboto")
SANS += ("segoe ui", "helvetica neue", "open sans", "tahoma", "trebuchet ms", "ubuntu", "lato")
MONO: tuple[str, ...] = ("courier new", "courier", "liberation mono", "cousine", "nimbus mono ps")
MONO += ("dejavu sans mono", "noto sans mono", "noto mono", "menlo", "consolas")
_CURSIVE = ("comic sans ms", "yellowtail", "apple chancery", "z003")
GENERIC: Mapping[str, Sequence[str]] = {
    "serif": SERIF,
    "sans-serif": SANS,
    "monospace": MONO,
    "cursive": (*_CURSIVE, *SERIF),
    "fantasy": ("impact", "papyrus", "sedgwick ave display", *SANS),
    "system-ui": ("segoe ui", "cantarell", *SANS),
    "ui-sans-serif": SANS,
    "ui-serif": SERIF,
    "ui-monospace": MONO,
}
"""By the names that CSS has for them, in any place."""
# What browsers take first.
_OF_SYSTEMS: Mapping[str, Mapping[str, str]] = {
    "win32": {"monospace": "consolas"},
    "darwin": {
        "sans-serif": "helvetica",
        "serif": "times",
        "monospace": "menlo",
        "cursive": "apple chancery",
        "fantasy": "papyrus",
        "system-ui": ".sf ns",
    },
}
SAME_ADVANCES: Sequence[frozenset[str]] = (
    frozenset((*SANS[:5], "nimbus sans l")),
    frozenset((*SERIF[:5], "nimbus roman no9 l")),
    frozenset((*MONO[:5], "nimbus mono l")),
    frozenset(("arial narrow", "liberation sans narrow")),
    frozenset(("calibri", "carlito")),
    frozenset(("cambria", "caladea")),
    frozenset(("georgia", "gelasio")),
)
"""Families of which each may stand for the others, as lines are as long with it."""
_SPECIAL = re.compile(r"([\\\-:,=])")
_MAX_SECONDS = 20
_LONGEST_NAME = 200
_MAX_ANSWERS = 50


def generic(name: str) -> Sequence[str]:
    """Families that stand for a generic one on this system, the best first, in small letters."""
    base = name.removeprefix("ui-")
    first = _OF_SYSTEMS.get(sys.platform, {}).get(base)
    return (*([first] if first else []), *GENERIC[name])


def from_fontconfig(name: str) -> Iterator[tuple[Path, int]]:
    """Yields what fontconfig takes for a family: files, and the numbers of fonts in them.

    There is nothing where there is no fontconfig.
    """
    base = name.removeprefix("ui-") if name in GENERIC else name
    best = _answers(base, is_sorted=False, key=_surroundings())
    yield from best
    # What it takes may be of a kind that is not read here.
    rest = _answers(base, is_sorted=True, key=_surroundings()) if best else ()
    yield from (each for each in rest if each not in best)


def _surroundings() -> tuple[str | None, ...]:
    """What decides the answers of fontconfig, beside its files."""
    names = ("FONTCONFIG_FILE", "FONTCONFIG_PATH", "FONTCONFIG_SYSROOT", "HOME", "XDG_CONFIG_HOME")
    return tuple(os.environ.get(name) for name in names)


@lru_cache(maxsize=512)
def _answers(
    name: str, *, is_sorted: bool, key: tuple[str | None, ...]
) -> tuple[tuple[Path, int], ...]:
    del key
    program = None if sys.platform in ("win32", "darwin") else shutil.which("fc-match")
    if program is None or not name.isprintable() or len(name) > _LONGEST_NAME:
        return ()
    words = [program, *(["--sort"] if is_sorted else []), "--format", "%{index}\t%{file}\n"]
    try:
        done = subprocess.run(
            [*words, _SPECIAL.sub(r"\\\1", name)],
            stdin=subprocess.DEVNULL,
            capture_output=True,
            timeout=_MAX_SECONDS,
            check=True,
        )
    except (OSError, ValueError, subprocess.SubprocessError):
        return ()
    found = []
    for line in os.fsdecode(done.stdout).splitlines()[:_MAX_ANSWERS]:
        index, _, file = line.partition("\t")
        if file and index.isdigit():
            # The upper half of the number is that of an instance of a variable font.
            found.append((Path(file), int(index) & 0xFFFF))
    return tuple(found)
