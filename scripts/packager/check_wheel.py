# SPDX-License-Identifier: GPL-3.0-or-later

"""Faults that keep a wheel from going into Blender's process, on any of the platforms."""

import io
import re
import tempfile
import zipfile
from collections.abc import Mapping, Sequence
from pathlib import Path

from packager.licenses import missing_licenses
from packager.modules import Module, read_module
from packager.platforms import Platform, Version, later, platform_of_wheel
from packager.project import NAME, SOURCE

ENTRY_POINT = "PyInit__native"
_COMPILED = re.compile(r"\.(so|pyd|dll|dylib)(\.|$)")


def wheel_faults(
    name: str, wheel: bytes, *, newest_glibc: Version | None = None, source: Path = SOURCE
) -> list[str]:
    """Returns the faults of a wheel; empty if it may go into Blender's process.

    Args:
        name: Its file name.
        wheel: Its bytes.
        newest_glibc: The newest glibc that a Linux module may need; None: its platform's.
        source: The checkout, which determines the linked libraries.
    """
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
        modules = [entry for entry in names if _COMPILED.search(entry)]
        if not name.startswith(f"{NAME}-"):
            contents = {each: archive.read(each) for each in modules}
            return found + bundled_faults(name, names, contents)
        if len(modules) != 1:
            return [*found, f"holds {len(modules)} modules, not one"]
        named = platform_of_wheel(name)
        if named is None:
            return [*found, "is for no platform that has a Blender, by its name"]
        platform, lowest = named
        python = name.split("-")[2]
        try:
            module = read_module(Path(archive.extract(modules[0], folder)))
        except ValueError as error:
            return [*found, str(error)]
        found += suffix_faults(modules[0], python, platform)
    allowed = platform.newest
    if platform.form == "ELF" and newest_glibc is not None:
        allowed = newest_glibc
    found += module_faults(module, python, platform)
    found += system_faults(module.lowest, lowest, allowed)
    texts = [path.partition(".dist-info/licenses/")[2] for path in names]
    if missing := missing_licenses(texts, platform, source):
        found.append(f"lacks licenses: {', '.join(missing)}")
    return found


def bundled_faults(name: str, names: Sequence[str], modules: Mapping[str, bytes]) -> list[str]:
    """Returns the faults of a third-party wheel: in its name, its files, and its modules."""
    found = []
    if name.endswith("-py3-none-any.whl"):
        if modules:
            found.append("is not of pure Python")
    else:
        found += foreign_module_faults(name, modules)
    if not any(
        re.search(r"\.dist-info/(licenses/)?(LICEN[CS]E|COPYING)", entry) for entry in names
    ):
        found.append("holds no license")
    return found


def foreign_module_faults(name: str, modules: Mapping[str, bytes]) -> list[str]:
    """Returns the faults of the one module of a third-party wheel."""
    named = platform_of_wheel(name)
    if named is None or len(modules) != 1:
        return [f"holds {len(modules)} modules, for no platform or not just one"]
    platform, lowest = named
    ((path, contents),) = modules.items()
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / Path(path).name
        file.write_bytes(contents)
        try:
            module = read_module(file)
        except ValueError as error:
            return [str(error)]
    if (module.form, module.machine) != (platform.form, platform.machine):
        return [f"is {module.form} for {module.machine}, not for {platform.name}"]
    found = []
    entry = f"PyInit_{Path(path).name.split('.')[0]}"
    if module.exports != {entry}:
        found.append(f"exports {sorted(module.exports)}, not just {entry}")
    python = name.split("-")[2]
    needed = sorted(
        each for each in module.libraries if not platform.allows(each, python, is_of_others=True)
    )
    if needed:
        found.append(f"needs {needed}")
    return found + system_faults(module.lowest, lowest, platform.newest)


def suffix_faults(path: str, python: str, platform: Platform) -> list[str]:
    """Returns whether Python would not find the module, by the end of its name."""
    wanted = f"{NAME}/_native{platform.suffix_for(python)}"
    return [] if path == wanted else [f"holds {path}; {platform.name}'s Python looks for {wanted}"]


def module_faults(module: Module, python: str, platform: Platform) -> list[str]:
    """Returns the faults of a module, except faults of its lowest system version."""
    if (module.form, module.machine) != (platform.form, platform.machine):
        return [f"is {module.form} for {module.machine}, not for {platform.name}"]
    found = list(module.faults)
    if module.exports != {ENTRY_POINT}:
        found.append(f"exports {sorted(module.exports)}, not just {ENTRY_POINT}")
    needed = sorted(each for each in module.libraries if not platform.allows(each, python))
    if needed:
        found.append(f"needs {needed}")
    return found


def system_faults(needed: Version, named: Version, allowed: Version) -> list[str]:
    """Returns the faults in the lowest system version that a module runs on.

    Args:
        needed: The version in the module.
        named: The version in the wheel's name.
        allowed: The newest allowed version.
    """
    found = []
    if later(needed, named):
        found.append(
            f"needs version {_dotted(needed)} of the system; its name says {_dotted(named)}"
        )
    if later(max(needed, named), allowed):
        found.append(
            f"needs version {_dotted(max(needed, named))} of the system, newer than "
            f"{_dotted(allowed)}"
        )
    return found


def _dotted(version: Version) -> str:
    return ".".join(map(str, version))
