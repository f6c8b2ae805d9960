# SPDX-License-Identifier: GPL-3.0-or-later

"""The extension: add-on, manifest and wheels, as a zip of one machine or one for each platform."""

import hashlib
import shutil
import zipfile
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from packager import blender as blenders
from packager import manual
from packager.licenses import license_texts
from packager.platforms import OFFICIAL_TAGS, PLATFORMS, here, platform_of_wheel
from packager.project import (
    BUILD,
    NAME,
    SOURCE,
    PackagingError,
    files_in,
    note,
    project_version,
)
from packager.wheels import make_wheel

DEBIAN_TAGS = ("cp313", "cp314")  # Debian 13's Blender, and sid's.


@dataclass(frozen=True)
class Parts:
    """The contents of an extension besides the add-on and our packages.

    Attributes:
        linked: Source folders of linked libraries.
        bundled: Third-party wheels, included unchanged.
        modules: Wheels of compiled modules, for Pythons and platforms.
        blender: The command that starts Blender.
    """

    linked: Sequence[Path]
    bundled: Sequence[Path]
    modules: Sequence[Path]
    blender: Sequence[str]

    def modules_for(self, platforms: Iterable[str], tags: Iterable[str]) -> list[Path]:
        """Returns the wheels of modules for some platforms and Pythons."""
        pythons, names = set(tags), set(platforms)
        found = []
        for wheel in self.modules:
            named = platform_of_wheel(wheel.name)
            if named is not None and named[0].name in names and wheel.name.split("-")[2] in pythons:
                found.append(wheel)
        return found


def built_package(tag: str) -> Path:
    """Returns where the package for a Python of this machine is built."""
    return BUILD / "release/python" / tag / NAME


def cross_package(platform: str, tag: str) -> Path:
    """Returns where the package for a platform is built."""
    return BUILD / "cross" / platform / "python" / tag / NAME


def fingerprint(tags: Sequence[str], parts: Parts) -> str:
    """Returns a hash of everything that goes into the extension of this machine."""
    written = ("blender_manifest.toml", "pyproject.toml", "README.md", "docs/python.md")
    files = [SOURCE / name for name in written]
    files += [*license_texts(parts.linked, here()).values(), *parts.bundled, *manual.sources()]
    files += parts.modules_for([here().name], tags)
    for folder in (Path(__file__).parent, SOURCE / "addon", *map(built_package, tags)):
        files += files_in(folder)
    whole = hashlib.sha256()
    for path in files:
        whole.update(f"{path} {hashlib.sha256(path.read_bytes()).hexdigest()}\n".encode())
    return whole.hexdigest()


def with_wheels(manifest: str, platforms: Iterable[str], wheels: Iterable[Path]) -> str:
    """Returns the manifest with its platforms and wheels, which stand before the first table."""
    names = ", ".join(f'"{name}"' for name in platforms)
    listed = ", ".join(f'"./wheels/{wheel.name}"' for wheel in wheels)
    head, bracket, tables = manifest.partition("\n[")
    return f"{head.rstrip()}\nplatforms = [{names}]\nwheels = [{listed}]\n{bracket}{tables}"


def stage_extension(
    folder: Path, platforms: Sequence[str], wheels: Sequence[Path], parts: Parts
) -> None:
    """Lays out in a folder the files to zip."""
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(SOURCE / "addon", folder, ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(SOURCE / "LICENSE", folder)
    manual.write(folder / "manual")
    (folder / "wheels").mkdir()
    listed = [Path(shutil.copy(wheel, folder / "wheels")) for wheel in (*wheels, *parts.bundled)]
    manifest = (SOURCE / "blender_manifest.toml").read_text()
    (folder / "blender_manifest.toml").write_text(with_wheels(manifest, platforms, listed))


def empty_folder(path: Path) -> Path:
    """Returns an empty folder."""
    shutil.rmtree(path, ignore_errors=True)
    path.mkdir(parents=True)
    return path


def make_extension(tags: Sequence[str], parts: Parts) -> Path:
    """Makes the zip for this machine, where a part of it has changed; returns where it is.

    Args:
        tags: The Pythons whose packages go in.
        parts: The other contents.
    """
    version = project_version()
    target = BUILD / f"{NAME}-{version}.zip"
    stamp = BUILD / ".packaged"
    mark = fingerprint(tags, parts)
    if target.exists() and stamp.exists() and stamp.read_text() == mark:
        return target
    note("packaging the extension")
    licenses = license_texts(parts.linked, here())
    folder = empty_folder(BUILD / "wheels-here")
    wheels = [
        make_wheel(built_package(tag), tag, version, here(), licenses, folder) for tag in tags
    ]
    stage = BUILD / "extension-here"
    wheels += parts.modules_for([here().name], tags)
    stage_extension(stage, [here().name], wheels, parts)
    made = target.with_suffix(".new.zip")
    where = ("--source-dir", str(stage), "--output-filepath", str(made))
    blenders.run_blender(parts.blender, "extension", "build", *where)
    blenders.validate(made, parts.blender)
    made.replace(target)
    stamp.write_text(mark)
    return target


def make_release(tags: Sequence[str], zig: Path, parts: Parts) -> list[Path]:
    """Makes a zip for official Blenders of each platform, and one for Debian's; returns where.

    Args:
        tags: The Pythons of this machine, for Debian's own Blender.
        zig: Where the compiler of all platforms is installed, and the licenses of its runtime are.
        parts: What else goes in.

    Raises:
        PackagingError: A package that belongs there was not built, or Blender left a zip out.
    """
    version = project_version()
    lacking = [
        f"{name} {tag}"
        for name in PLATFORMS
        for tag in OFFICIAL_TAGS
        if not cross_package(name, tag).is_dir()
    ]
    lacking += [f"Debian {tag}" for tag in DEBIAN_TAGS if tag not in tags]
    if lacking:
        raise PackagingError(f"not built: {', '.join(lacking)}")
    wheels_folder = empty_folder(BUILD / "wheels")
    wheels = []
    for name, platform in PLATFORMS.items():
        licenses = license_texts(parts.linked, platform, zig)
        for tag in OFFICIAL_TAGS:
            package = cross_package(name, tag)
            wheels.append(make_wheel(package, tag, version, platform, licenses, wheels_folder))
    wheels += parts.modules_for(PLATFORMS, OFFICIAL_TAGS)
    stage = BUILD / "extension"
    stage_extension(stage, list(PLATFORMS), wheels, parts)
    target = empty_folder(BUILD / "extensions")
    where = ("--source-dir", str(stage), "--output-dir", str(target))
    blenders.run_blender(parts.blender, "extension", "build", "--split-platforms", *where)
    made = [target / f"{NAME}-{version}-{platform.replace('-', '_')}.zip" for platform in PLATFORMS]
    for path, own in zip(made, PLATFORMS, strict=True):
        modules = parts.modules_for([own], OFFICIAL_TAGS)
        check_contents(path, [*parts.bundled, *modules])
        blenders.validate(path, parts.blender)
    debian = target / f"{NAME}-{version}-debian_{here().name.replace('-', '_')}.zip"
    shutil.copy(make_extension(tags, parts), debian)
    return [*made, debian]


def check_contents(extension: Path, bundled: Sequence[Path]) -> None:
    """Refuses a missing zip, or one that lacks some of its wheels."""
    if not extension.exists():
        raise PackagingError(f"Blender made no {extension.name}")
    with zipfile.ZipFile(extension) as archive:
        wheels = {Path(name).name for name in archive.namelist() if name.endswith(".whl")}
    ours = {name for name in wheels if name.startswith(f"{NAME}-")}
    tags = {name.split("-")[2] for name in ours}
    if tags != set(OFFICIAL_TAGS) or len(ours) != len(OFFICIAL_TAGS):
        raise PackagingError(
            f"{extension.name} holds {sorted(ours)}, not one wheel each for {OFFICIAL_TAGS}"
        )
    if lacking := {path.name for path in bundled} - wheels:
        raise PackagingError(f"{extension.name} lacks {sorted(lacking)}")


def install(extension: Path, resources: Path, blender: Sequence[str]) -> None:
    """Installs and enables a changed extension in a folder, as a user would.

    The installed version is removed first: Blender keeps a wheel whose name it knows.
    """
    stamp = resources / ".installed"
    mark = hashlib.sha256(extension.read_bytes()).hexdigest()
    if stamp.exists() and stamp.read_text() == mark:
        return
    note(f"installing the extension in {resources}")
    stamp.unlink(missing_ok=True)
    shutil.rmtree(resources / "extensions", ignore_errors=True)
    resources.mkdir(parents=True, exist_ok=True)
    blenders.install(extension, resources, blender)
    stamp.write_text(mark)
