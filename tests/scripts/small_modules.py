# SPDX-License-Identifier: GPL-3.0-or-later

"""Compiles small modules for the platforms: this machine's by its compiler, others by Zig's."""

import hashlib
import os
import shutil
import subprocess
import tomllib
from pathlib import Path

import pytest

CHECKOUT = Path(__file__).resolve().parents[2]
PLATFORMS = tomllib.loads((CHECKOUT / "scripts/platforms.toml").read_text())
SUFFIXES = {
    "linux-x64": "cpython-311-x86_64-linux-gnu.so",
    "linux-arm64": "cpython-311-aarch64-linux-gnu.so",
    "windows-x64": "cp311-win_amd64.pyd",
    "macos-arm64": "cpython-311-darwin.so",
}
MODULE = """
#ifdef _WIN32
#define VISIBLE __declspec(dllexport)
int __stdcall _DllMainCRTStartup(void *a, unsigned b, void *c) { return 1; }
#else
#define VISIBLE __attribute__((visibility("default")))
#endif
%s
VISIBLE int PyInit__native(void) { return %s; }
"""


def cache_folder() -> Path:
    """Returns the cache folder of scripts/lib.sh."""
    home = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(os.environ.get("PREFILTER_CACHE") or Path(home, "prefilter"))


def compiler(platform: str) -> list[str]:
    """Returns the command that compiles for a platform; skips the test where there is none."""
    if platform == "linux-x64":
        found = shutil.which("cc")
        if found is None or os.uname().machine != "x86_64":
            pytest.skip("there is no compiler for Linux on x86-64")
        return [found, "-fPIC"]
    pinned = hashlib.sha256((CHECKOUT / "scripts/toolchain.txt").read_bytes()).hexdigest()[:12]
    zig = cache_folder() / f"zig-{pinned}/bin/zig-cc"
    if not zig.exists():
        pytest.skip(f"{zig} is missing: scripts/package fetches it")
    return [str(zig), "-target", PLATFORMS[platform]["target"], "-nostdlib"]


def compiled(
    platform: str,
    folder: Path,
    *flags: str,
    before: str = "",
    result: str = "1",
    name: str = "",
    strip: bool = True,
) -> Path:
    """Compiles a module; returns its path.

    Args:
        platform: What for; Blender's name.
        folder: Where it goes.
        flags: Of the compiler, after the source.
        before: Declarations and definitions before the entry point.
        result: The expression that the entry point returns.
        name: Of the file; empty: the one that Python looks for.
        strip: Whether nothing is left in it that loading does not need.
    """
    source = folder / "module.c"
    source.write_text(MODULE % (before, result))
    made = folder / (name or f"_native.{SUFFIXES[platform]}")
    command = [*compiler(platform), "-O2", "-shared", "-fvisibility=hidden", "-o", made]
    command += ["-s"] if strip else []
    subprocess.run([*command, source, *flags], check=True, timeout=1500, cwd=folder)
    return made
