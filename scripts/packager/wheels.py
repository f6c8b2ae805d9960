# SPDX-License-Identifier: GPL-3.0-or-later

"""Wheels of built packages."""

import base64
import hashlib
import subprocess
import tempfile
import zipfile
from collections.abc import Mapping
from pathlib import Path

from packager.modules import read_module
from packager.platforms import Platform, here
from packager.project import PackagingError, core_metadata, entry_points, files_in

WHEEL = """\
Wheel-Version: 1.0
Generator: {name} scripts/packager
Root-Is-Purelib: false
Tag: {tag}
"""

MODULE_SUFFIXES = (".so", ".pyd")


def _stripped(module: Path) -> bytes:
    """Returns a module of this machine without the symbols that loading it does not need."""
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


def make_wheel(
    package: Path,
    tag: str,
    version: str,
    platform: Platform,
    licenses: Mapping[str, Path],
    target: Path,
) -> Path:
    """Makes a wheel of a built package, subpackages and all.

    The platform of the wheel's name is the oldest system that its module runs on.

    Args:
        package: The folder that is imported; it holds one module (*.so, *.pyd).
        tag: Its Python, such as cp313.
        version: The wheel's.
        platform: What its module is for.
        licenses: The texts that go along, by name.
        target: The folder to write the wheel in.

    Raises:
        PackagingError: There is not just one module, or it is for another platform.
    """
    modules = [path for path in files_in(package) if path.suffix in MODULE_SUFFIXES]
    if len(modules) != 1:
        raise PackagingError(f"{package} holds {len(modules)} modules (*.so, *.pyd), not one")
    module = read_module(modules[0])
    if (module.form, module.machine) != (platform.form, platform.machine):
        raise PackagingError(
            f"{modules[0]} is {module.form} for {module.machine}; {platform.name} needs "
            f"{platform.form} for {platform.machine}"
        )
    full_tag = f"{tag}-{tag}-{platform.tag_for(module.lowest)}"
    files = {
        path.relative_to(package.parent).as_posix(): path.read_bytes() for path in files_in(package)
    }
    if platform == here():
        files[modules[0].relative_to(package.parent).as_posix()] = _stripped(modules[0])
    info = f"{package.name}-{version}.dist-info"
    files |= {f"{info}/licenses/{name}": path.read_bytes() for name, path in licenses.items()}
    files[f"{info}/WHEEL"] = WHEEL.format(name=package.name, tag=full_tag).encode()
    files[f"{info}/METADATA"] = core_metadata(version, licenses).encode()
    files[f"{info}/entry_points.txt"] = f"{entry_points()}\n".encode()
    files[f"{info}/RECORD"] = record(files, f"{info}/RECORD").encode()
    wheel = target / f"{package.name}-{version}-{full_tag}.whl"
    with zipfile.ZipFile(wheel, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
        for name, data in sorted(files.items()):
            entry = zipfile.ZipInfo(name, date_time=(1980, 1, 1, 0, 0, 0))
            entry.compress_type = zipfile.ZIP_DEFLATED
            mode = 0o100755 if name.endswith(MODULE_SUFFIXES) else 0o100644
            entry.external_attr = mode << 16
            archive.writestr(entry, data)
    return wheel
