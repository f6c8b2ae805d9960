#!/usr/bin/env python3
"""Check that wheels will load, and do no harm, inside Blender's process.

usage: check_wheel.py WHEEL...

Reads no environment variables. Needs nm and readelf (binutils). Each wheel must hold one module
that exports its entry point only, needs no library but those of glibc, and no newer glibc than
the one here; and its RECORD must name each of its files.
"""

import os
import re
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

ALLOWED_LIBRARIES = {"libc.so.6", "libm.so.6", "libpthread.so.0", "libdl.so.2"}


def output(*command: str) -> str:
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def faults(wheel: Path) -> list[str]:
    found = []
    with zipfile.ZipFile(wheel) as archive, tempfile.TemporaryDirectory() as folder:
        names = archive.namelist()
        modules = [name for name in names if name.endswith(".so")]
        if len(modules) != 1:
            return [f"holds {len(modules)} modules, not one"]
        records = [name for name in names if name.endswith(".dist-info/RECORD")]
        recorded = archive.read(records[0]).decode() if records else ""
        if {line.split(",")[0] for line in recorded.splitlines()} != set(names):
            found.append("RECORD is missing, or does not name just its files")
        module = archive.extract(modules[0], folder)
        exports = output("nm", "--dynamic", "--defined-only", "--format=posix", module)
        symbols = {line.split()[0] for line in exports.splitlines()}
        if symbols != {"PyInit__native"}:
            found.append(f"exports {sorted(symbols)}, not just PyInit__native")
        needed = set(re.findall(r"\(NEEDED\).*\[(.*)\]", output("readelf", "--dynamic", module)))
        needed = {name for name in needed if not name.startswith("ld-linux")}
        if needed - ALLOWED_LIBRARIES:
            found.append(f"needs {sorted(needed - ALLOWED_LIBRARIES)}")
    tag = re.search(r"-manylinux_(\d+)_(\d+)_", wheel.name)
    here = os.confstr("CS_GNU_LIBC_VERSION").split()[1]
    if not tag:
        found.append("has no manylinux_2_XX tag")
    elif tuple(map(int, tag.groups())) > tuple(map(int, here.split(".")[:2])):
        found.append(f"needs glibc {'.'.join(tag.groups())}, newer than {here} here")
    return found


def main() -> int:
    wheels = [Path(name) for name in sys.argv[1:]]
    if not wheels:
        raise SystemExit("usage: check_wheel.py WHEEL...")
    failed = False
    for wheel in wheels:
        found = faults(wheel)
        failed = failed or bool(found)
        print(f"{wheel.name}: {'; '.join(found) or 'fine'}")
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
