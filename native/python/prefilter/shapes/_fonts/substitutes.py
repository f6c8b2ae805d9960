# SPDX-License-Identifier: GPL-3.0-or-later

"""Substitutes for generic and missing font families."""

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from functools import lru_cache
from pathlib import Path

# Substitutes of generic and of well-known missing families, in order of preference. The first ones
# of each list have the same advances.
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
"""By CSS's names of generic families, on every system."""
# Families that browsers prefer, by system.
_PREFERRED_BY_SYSTEM: Mapping[str, Mapping[str, str]] = {
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
"""Families with the same advances, which may replace each other without changing line lengths."""
_SPECIAL_CHARACTERS = re.compile(r"([\\\-:,=])")
_MAX_SECONDS = 20
_MAX_NAME_LENGTH = 200
_MAX_MATCHES = 50


def generic_families(name: str) -> Sequence[str]:
    """Returns families for a generic one, in order of preference and in lower case."""
    base = name.removeprefix("ui-")
    first = _PREFERRED_BY_SYSTEM.get(sys.platform, {}).get(base)
    return (*([first] if first else []), *GENERIC[name])


def from_fontconfig(name: str) -> Iterator[tuple[Path, int]]:
    """Yields fontconfig's matches for a family: files, and face indices.

    Yields nothing without fontconfig.
    """
    base = name.removeprefix("ui-") if name in GENERIC else name
    best = _query_fontconfig(base, is_sorted=False, key=_environment())
    yield from best
    # The best match may be in an unsupported format.
    others = _query_fontconfig(base, is_sorted=True, key=_environment()) if best else ()
    yield from (each for each in others if each not in best)


def _environment() -> tuple[str | None, ...]:
    """Returns the environment variables that affect fontconfig."""
    names = ("FONTCONFIG_FILE", "FONTCONFIG_PATH", "FONTCONFIG_SYSROOT", "HOME", "XDG_CONFIG_HOME")
    return tuple(os.environ.get(name) for name in names)


@lru_cache(maxsize=512)
def _query_fontconfig(
    name: str, *, is_sorted: bool, key: tuple[str | None, ...]
) -> tuple[tuple[Path, int], ...]:
    del key
    program = None if sys.platform in ("win32", "darwin") else shutil.which("fc-match")
    if program is None or not name.isprintable() or len(name) > _MAX_NAME_LENGTH:
        return ()
    words = [program, *(["--sort"] if is_sorted else []), "--format", "%{index}\t%{file}\n"]
    try:
        process = subprocess.run(
            [*words, _SPECIAL_CHARACTERS.sub(r"\\\1", name)],
            stdin=subprocess.DEVNULL,
            capture_output=True,
            timeout=_MAX_SECONDS,
            check=True,
        )
    except (OSError, ValueError, subprocess.SubprocessError):
        return ()
    matches = []
    for line in os.fsdecode(process.stdout).splitlines()[:_MAX_MATCHES]:
        index, _, file = line.partition("\t")
        if file and index.isdigit():
            # The upper 16 bits are the instance of a variable font.
            matches.append((Path(file), int(index) & 0xFFFF))
    return tuple(matches)
