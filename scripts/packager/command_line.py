# SPDX-License-Identifier: GPL-3.0-or-later

"""Make the extension from a build, check it, and install it.

usage: packager extension --tag cp313 ... PARTS [--install FOLDER] -- BLENDER...
       packager release --tag cp313 ... --zig FOLDER PARTS -- BLENDER...
       packager check [--here] ZIP... -- BLENDER...
       packager --help

BLENDER... is the command that starts Blender. PARTS are --reader FOLDER, [--linked SOURCE ...] and
[--wheels FOLDER]. Reads no environment variables. Needs strip (binutils).

extension   Makes build/prefilter-<version>.zip for this machine, of addon/ and of the packages in
            build/release/python/<tag>, where one of its parts has changed, and prints where it is.
            The same parts give the same wheels, byte for byte. The wheels in a folder go along:
            packages of pure Python that ours needs.
release     Makes the zips of all platforms in build/extensions/, of the packages in
            build/cross/<platform>/python/<tag>, and beside them one for Debian's own Blender, as
            `extension` does. Fails where one is missing. Prints where they are.
check       Says whether zips will load in Blender, and do no harm there: Blender accepts them, and
            every wheel of ours holds one module that exports its entry point only, needs no library
            but those that every such system has, no newer system than Blender itself (with --here:
            than this machine), and has the licenses of all that is linked in; all others hold none,
            and have their license; and the RECORD of each names each of its files.
"""

import argparse
import sys
import zipfile
from collections.abc import Sequence
from pathlib import Path

from packager.project import PackagingError, note


def check(extension: Path, newest_glibc: tuple[int, int] | None, blender: Sequence[str]) -> bool:
    """Reports the faults of a zip and its wheels; returns whether there are none."""
    from packager.blender import validate
    from packager.check_wheel import wheel_faults

    with zipfile.ZipFile(extension) as archive:
        found = {
            Path(name).name: wheel_faults(
                Path(name).name, archive.read(name), newest_glibc=newest_glibc
            )
            for name in archive.namelist()
            if name.endswith(".whl")
        }
    for name, faults in found.items():
        print(f"{name}: {'; '.join(faults) or 'fine'}")
    if not found:
        print(f"{extension} holds no wheels")
    validate(extension, blender)
    print(f"{extension}: valid, {extension.stat().st_size // 1024} KiB", flush=True)
    return bool(found) and not any(found.values())


def parse(words: Sequence[str]) -> argparse.Namespace:
    """Reads the command line; what follows `--` is `blender`."""
    description = __doc__ or ""
    parser = argparse.ArgumentParser(
        usage=description.partition("usage: ")[2].partition("\n\n")[0],
        description=description.partition("packager --help\n\n")[2],
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    commands = parser.add_subparsers(dest="command", required=True)
    for name in ("extension", "release"):
        command = commands.add_parser(name)
        command.add_argument("--tag", action="append", required=True, dest="tags")
        command.add_argument("--linked", type=Path, action="append", default=[])
        command.add_argument("--wheels", type=Path)
    commands.choices["extension"].add_argument("--install", type=Path)
    commands.choices["release"].add_argument("--zig", type=Path, required=True)
    checking = commands.add_parser("check")
    checking.add_argument("--here", action="store_true")
    checking.add_argument("zips", type=Path, nargs="+", metavar="zip")
    for command in commands.choices.values():
        command.add_argument("--reader", type=Path, required=True)
    own, blender = list(words), []
    if "--" in own:
        split = own.index("--")
        own, blender = own[:split], own[split + 1 :]
    options = parser.parse_args(own)
    if not blender:
        parser.error("the command that starts Blender is missing: it comes after --")
    options.blender = blender
    return options


def run(options: argparse.Namespace) -> bool:
    """Runs the command; returns whether it found no fault."""
    # LIEF, which reads modules, is in a folder that the command line names.
    sys.path.append(str(options.reader))
    from packager.extension import Parts, install, make_extension, make_release
    from packager.platforms import glibc_here

    if options.command == "check":
        newest = glibc_here() if options.here else None
        fine = [check(path, newest, options.blender) for path in options.zips]
        return all(fine)
    bundled = sorted(options.wheels.glob("*.whl")) if options.wheels else []
    modules = sorted(options.wheels.glob("modules/*.whl")) if options.wheels else []
    parts = Parts(options.linked, bundled, modules, options.blender)
    if options.command == "release":
        for path in make_release(options.tags, options.zig, parts):
            print(path)
        return True
    made = make_extension(options.tags, parts)
    if options.install is not None:
        install(made, options.install.absolute(), options.blender)
    print(made)
    return True


def main() -> int:
    """Runs the program; returns its exit status."""
    options = parse(sys.argv[1:])
    try:
        return 0 if run(options) else 1
    except PackagingError as error:
        note(str(error))
        return 1
