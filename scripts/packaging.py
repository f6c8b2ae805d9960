#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later

"""Make the extension of what is built, check it, and install it.

usage: packaging.py extension --tag cp313 ... [--linked SOURCE ...] [--wheels FOLDER]
                    [--install FOLDER] -- BLENDER...
       packaging.py check ZIP -- BLENDER...
       packaging.py --help

BLENDER... is the command that starts Blender. Reads no environment variables. Needs strip, objdump,
nm and readelf (binutils).

extension   Makes build/prefilter-<version>.zip of addon/ and of the packages in
            build/release/python/<tag>, where one of its parts has changed, and prints where it is.
            The same parts give the same wheels, byte for byte. The wheels in a folder go along:
            packages of pure Python that ours needs.
check       Says whether the zip will load in Blender, and do no harm there: Blender accepts it, and
            every wheel of ours holds one module that exports its entry point only, needs no library
            but those of glibc, and no newer glibc than the one here; all others hold none, and have
            their license; and the RECORD of each names each of its files.
"""

import argparse
import base64
import hashlib
import io
import os
import platform
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib
import zipfile
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[1]
BUILD = SOURCE / "build"
NAME = "prefilter"
REPOSITORY = "user_default"  # Blender's, of extensions that come from files.

METADATA = """\
Metadata-Version: 2.4
Name: {name}
Version: {version}
Summary: Mipmaps that know the mesh
License-Expression: GPL-3.0-or-later
{license_files}
Requires-Python: >=3.11
Requires-Dist: cssselect2
Requires-Dist: numpy
Requires-Dist: tinycss2
"""

WHEEL = """\
Wheel-Version: 1.0
Generator: {name} scripts/packaging.py
Root-Is-Purelib: false
Tag: {tag}
"""

ENTRY_POINT = "PyInit__native"
ALLOWED_LIBRARIES = {"libc.so.6", "libm.so.6", "libpthread.so.0", "libdl.so.2"}


class PackagingError(Exception):
    """What was built cannot be packaged; the message says why."""


def note(text: str) -> None:
    """Tells what goes on."""
    print(f"prefilter: {text}", file=sys.stderr, flush=True)


def output(*command: str) -> str:
    """Runs a program; returns what it printed."""
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def run_blender(blender: Sequence[str], *arguments: str, resources: Path | None = None) -> None:
    """Runs one of Blender's commands with factory settings; its output is shown where it fails.

    `resources` is the folder for its settings and extensions.
    """
    command = [*blender, "--background", "--factory-startup", "--command", *arguments]
    environment = dict(os.environ)
    if resources is not None:
        environment["BLENDER_USER_RESOURCES"] = str(resources)
    done = subprocess.run(
        command,
        env=environment,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    if done.returncode != 0:
        sys.stderr.write(done.stdout)
        raise PackagingError(f"blender --command {' '.join(arguments[:2])} failed")


def project_version(source: Path = SOURCE) -> str:
    """Returns the version, on which the manifest and CMake have to agree."""
    manifest = tomllib.loads((source / "blender_manifest.toml").read_text())["version"]
    project = re.search(
        r"^project\(.*VERSION ([0-9.]+)", (source / "CMakeLists.txt").read_text(), re.M
    )
    cmake = project[1] if project else ""
    if manifest != cmake:
        raise PackagingError(
            f"blender_manifest.toml has version '{manifest}', CMakeLists.txt '{cmake}': they must "
            "be equal"
        )
    return str(manifest)


def files_in(folder: Path) -> list[Path]:
    """Returns the files below a folder, in order, without those that Python keeps for itself."""
    return sorted(
        path
        for path in folder.rglob("*")
        if path.is_file() and "__pycache__" not in path.relative_to(folder).parts
    )


def needed_glibc(module: Path) -> str:
    """Returns the newest glibc version among the symbols that a module needs, as "2.34"."""
    found = re.findall(r"\bGLIBC_([0-9.]+)", output("objdump", "-T", str(module)))
    versions = {tuple(map(int, number.split("."))) for number in found}
    if not versions:
        raise PackagingError(f"{module} needs no glibc, so it is no module built here")
    return ".".join(map(str, max(versions)[:2]))


def stripped(module: Path) -> bytes:
    """Returns a module without the symbols that loading it does not need."""
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / module.name
        subprocess.run(["strip", "--strip-unneeded", "-o", str(copy), str(module)], check=True)
        return copy.read_bytes()


def record(files: Mapping[str, bytes], path: str) -> str:
    """Returns the text of RECORD, which lies at `path`."""
    lines = []
    for name, data in sorted(files.items()):
        digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
        lines.append(f"{name},sha256={digest},{len(data)}\n")
    return "".join(lines) + f"{path},,\n"


def licenses(linked: Iterable[Path]) -> dict[str, Path]:
    """Returns the license texts that go along, by name: ours and those of linked libraries."""
    found = {"LICENSE": SOURCE / "LICENSE"}
    for library in linked:
        found[f"{library.name}/LICENSE.txt"] = library / "LICENSE.txt"
        if (library / "NOTICE.txt").exists():
            found[f"{library.name}/NOTICE.txt"] = library / "NOTICE.txt"
    return found


def make_wheel(package: Path, tag: str, version: str, linked: Iterable[Path], target: Path) -> Path:
    """Makes a wheel of a built package, subpackages and all.

    The platform of the wheel's name is the oldest glibc that its module runs on.

    Args:
        package: The folder that is imported; it holds one module (*.so).
        tag: Its Python, such as cp313.
        version: The wheel's.
        linked: Source folders of linked libraries, whose LICENSE.txt and NOTICE.txt go along.
        target: The folder to write the wheel in.
    """
    modules = sorted(package.glob("*.so"))
    if len(modules) != 1:
        raise PackagingError(f"{package} holds {len(modules)} modules (*.so), not one")
    glibc = needed_glibc(modules[0]).replace(".", "_")
    full_tag = f"{tag}-{tag}-manylinux_{glibc}_{platform.machine()}"
    files = {
        path.relative_to(package.parent).as_posix(): (
            stripped(path) if path.suffix == ".so" else path.read_bytes()
        )
        for path in files_in(package)
    }
    info = f"{package.name}-{version}.dist-info"
    texts = licenses(linked)
    files |= {f"{info}/licenses/{name}": path.read_bytes() for name, path in texts.items()}
    files[f"{info}/WHEEL"] = WHEEL.format(name=package.name, tag=full_tag).encode()
    files[f"{info}/METADATA"] = METADATA.format(
        name=package.name,
        version=version,
        license_files="\n".join(f"License-File: {name}" for name in texts),
    ).encode()
    files[f"{info}/RECORD"] = record(files, f"{info}/RECORD").encode()
    wheel = target / f"{package.name}-{version}-{full_tag}.whl"
    with zipfile.ZipFile(wheel, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
        for name, data in sorted(files.items()):
            entry = zipfile.ZipInfo(name, date_time=(1980, 1, 1, 0, 0, 0))
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = (0o100755 if name.endswith(".so") else 0o100644) << 16
            archive.writestr(entry, data)
    return wheel


def bundled_faults(name: str, names: Sequence[str], modules: Sequence[str]) -> list[str]:
    """Returns what is wrong with a wheel of others, by its name and those of its files."""
    found = []
    if modules or not name.endswith("-py3-none-any.whl"):
        found.append("is not of pure Python")
    if not any(
        re.search(r"\.dist-info/(licenses/)?(LICEN[CS]E|COPYING)", entry) for entry in names
    ):
        found.append("holds no license")
    return found


def wheel_faults(name: str, wheel: bytes) -> list[str]:
    """Returns what is wrong with a wheel; nothing where it may go into Blender's process."""
    found = []
    with (
        zipfile.ZipFile(io.BytesIO(wheel)) as archive,
        tempfile.TemporaryDirectory() as folder,
    ):
        names = archive.namelist()
        records = [entry for entry in names if entry.endswith(".dist-info/RECORD")]
        recorded = archive.read(records[0]).decode() if records else ""
        if {line.split(",")[0] for line in recorded.splitlines()} != set(names):
            found.append("RECORD is missing, or does not name just its files")
        modules = [entry for entry in names if re.search(r"\.(so|pyd|dll|dylib)(\.|$)", entry)]
        if not name.startswith(f"{NAME}-"):
            return found + bundled_faults(name, names, modules)
        if len(modules) != 1:
            return [f"holds {len(modules)} modules, not one"]
        module = archive.extract(modules[0], folder)
        exports = output("nm", "--dynamic", "--defined-only", "--format=posix", module)
        symbols = {line.split()[0] for line in exports.splitlines()}
        if symbols != {ENTRY_POINT}:
            found.append(f"exports {sorted(symbols)}, not just {ENTRY_POINT}")
        needed = set(re.findall(r"\(NEEDED\).*\[(.*)\]", output("readelf", "--dynamic", module)))
        needed = {library for library in needed if not library.startswith("ld-linux")}
        if needed - ALLOWED_LIBRARIES:
            found.append(f"needs {sorted(needed - ALLOWED_LIBRARIES)}")
    tag = re.search(r"-manylinux_(\d+)_(\d+)_", name)
    here = platform.libc_ver()[1]
    if not tag:
        found.append("has no manylinux_2_XX tag")
    elif tuple(map(int, tag.groups())) > tuple(map(int, here.split(".")[:2])):
        found.append(f"needs glibc {'.'.join(tag.groups())}, newer than {here} here")
    return found


def built_package(tag: str) -> Path:
    """Returns where the package for a Python is built."""
    return BUILD / "release/python" / tag / NAME


def fingerprint(tags: Sequence[str], linked: Sequence[Path], bundled: Sequence[Path]) -> str:
    """Returns a hash of everything that goes into the extension."""
    parts = [SOURCE / "blender_manifest.toml", SOURCE / "CMakeLists.txt", Path(__file__).resolve()]
    parts += [*licenses(linked).values(), *bundled]
    for folder in (SOURCE / "addon", *map(built_package, tags)):
        parts += files_in(folder)
    whole = hashlib.sha256()
    for path in parts:
        whole.update(f"{path} {hashlib.sha256(path.read_bytes()).hexdigest()}\n".encode())
    return whole.hexdigest()


def with_wheels(manifest: str, wheels: Iterable[Path]) -> str:
    """Returns the manifest with its list of wheels, which stands before the first table."""
    listed = ", ".join(f'"./wheels/{wheel.name}"' for wheel in wheels)
    head, bracket, tables = manifest.partition("\n[")
    return f"{head.rstrip()}\nwheels = [{listed}]\n{bracket}{tables}"


def make_extension(
    tags: Sequence[str], linked: Sequence[Path], bundled: Sequence[Path], blender: Sequence[str]
) -> Path:
    """Makes the zip, where one of its parts has changed; returns where it is.

    Args:
        tags: The Pythons whose packages go in.
        linked: Source folders of linked libraries.
        bundled: Wheels of others that go along as they are.
        blender: The command that starts Blender.
    """
    version = project_version()
    target = BUILD / f"{NAME}-{version}.zip"
    stamp = BUILD / ".packaged"
    mark = fingerprint(tags, linked, bundled)
    if target.exists() and stamp.exists() and stamp.read_text() == mark:
        return target
    note("packaging the extension")
    stage = BUILD / "extension"
    shutil.rmtree(stage, ignore_errors=True)
    shutil.copytree(SOURCE / "addon", stage, ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(SOURCE / "LICENSE", stage)
    (stage / "wheels").mkdir()
    wheels = [
        make_wheel(built_package(tag), tag, version, linked, stage / "wheels") for tag in tags
    ]
    wheels += [Path(shutil.copy(wheel, stage / "wheels")) for wheel in bundled]
    manifest = (SOURCE / "blender_manifest.toml").read_text()
    (stage / "blender_manifest.toml").write_text(with_wheels(manifest, wheels))
    made = target.with_suffix(".new.zip")
    where = ("--source-dir", str(stage), "--output-filepath", str(made))
    run_blender(blender, "extension", "build", *where)
    run_blender(blender, "extension", "validate", str(made))
    made.replace(target)
    stamp.write_text(mark)
    return target


def install(extension: Path, resources: Path, blender: Sequence[str]) -> None:
    """Installs and enables the extension, as a user would, in a folder where it is another.

    What was installed there goes first: Blender keeps a wheel whose name it knows.
    """
    stamp = resources / ".installed"
    mark = hashlib.sha256(extension.read_bytes()).hexdigest()
    if stamp.exists() and stamp.read_text() == mark:
        return
    note(f"installing the extension in {resources}")
    stamp.unlink(missing_ok=True)
    shutil.rmtree(resources / "extensions", ignore_errors=True)
    resources.mkdir(parents=True, exist_ok=True)
    arguments = ("extension", "install-file", "-r", REPOSITORY, "-e", str(extension))
    run_blender(blender, *arguments, resources=resources)
    stamp.write_text(mark)


def check(extension: Path, blender: Sequence[str]) -> bool:
    """Says what is wrong with a zip and its wheels; returns whether nothing is."""
    with zipfile.ZipFile(extension) as archive:
        wheels = [Path(name) for name in archive.namelist() if name.endswith(".whl")]
        found = {
            path.name: wheel_faults(path.name, archive.read(path.as_posix())) for path in wheels
        }
    for name, faults in found.items():
        print(f"{name}: {'; '.join(faults) or 'fine'}")
    if not wheels:
        print(f"{extension} holds no wheels")
    run_blender(blender, "extension", "validate", str(extension))
    print(f"{extension}: valid, {extension.stat().st_size // 1024} KiB")
    return bool(wheels) and not any(found.values())


def parse(words: Sequence[str]) -> argparse.Namespace:
    """Reads the command line; what follows `--` is `blender`."""
    parser = argparse.ArgumentParser(
        usage="\n".join(__doc__.splitlines()[2:6]).removeprefix("usage: "),
        description=__doc__.partition("\n\n")[2].partition("\n\n")[2],
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    commands = parser.add_subparsers(dest="command", required=True)
    extension = commands.add_parser("extension")
    extension.add_argument("--tag", action="append", required=True, dest="tags")
    extension.add_argument("--linked", type=Path, action="append", default=[])
    extension.add_argument("--wheels", type=Path)
    extension.add_argument("--install", type=Path)
    commands.add_parser("check").add_argument("zip", type=Path)
    own, blender = list(words), []
    if "--" in own:
        split = own.index("--")
        own, blender = own[:split], own[split + 1 :]
    options = parser.parse_args(own)
    if not blender:
        parser.error("the command that starts Blender is missing: it comes after --")
    options.blender = blender
    return options


def main() -> int:
    """Does what the command line says."""
    options = parse(sys.argv[1:])
    try:
        if options.command == "check":
            return 0 if check(options.zip, options.blender) else 1
        bundled = sorted(options.wheels.glob("*.whl")) if options.wheels else []
        made = make_extension(options.tags, options.linked, bundled, options.blender)
        if options.install is not None:
            install(made, options.install.absolute(), options.blender)
        print(made)
    except PackagingError as error:
        note(str(error))
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
