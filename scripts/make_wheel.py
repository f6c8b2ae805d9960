#!/usr/bin/env python3
"""Make a wheel of a built Python package: the same contents give the same file, byte for byte.

usage: make_wheel.py --package BUILD/python/cp313/prefilter --tag cp313 --version 0.1.0
                     --license LICENSE [--linked SOURCE ...] --output FOLDER

Reads no environment variables. Needs strip and objdump (binutils). The platform of the wheel's name
is the oldest glibc that its module runs on.
"""

import argparse
import base64
import hashlib
import platform
import re
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

METADATA = """\
Metadata-Version: 2.4
Name: {name}
Version: {version}
Summary: Mipmaps that know the mesh
License-Expression: GPL-3.0-or-later
{license_files}
Requires-Python: >=3.11
Requires-Dist: numpy
"""

WHEEL = """\
Wheel-Version: 1.0
Generator: {name} scripts/make_wheel.py
Root-Is-Purelib: false
Tag: {tag}
"""


def needed_glibc(module: Path) -> str:
    """The newest glibc version among the symbols that a module needs, as "2.34"."""
    symbols = subprocess.run(
        ["objdump", "-T", str(module)], check=True, capture_output=True, text=True
    ).stdout
    versions = {tuple(map(int, v.split("."))) for v in re.findall(r"\bGLIBC_([0-9.]+)", symbols)}
    if not versions:
        raise SystemExit(f"make_wheel.py: {module} needs no glibc, so it is no module built here")
    return ".".join(map(str, max(versions)[:2]))


def stripped(module: Path) -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / module.name
        subprocess.run(["strip", "--strip-unneeded", "-o", str(copy), str(module)], check=True)
        return copy.read_bytes()


def record(files: dict[str, bytes], path: str) -> str:
    lines = []
    for name, data in sorted(files.items()):
        digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
        lines.append(f"{name},sha256={digest},{len(data)}\n")
    return "".join(lines) + f"{path},,\n"


def write_wheel(target: Path, files: dict[str, bytes]) -> None:
    with (
        tempfile.NamedTemporaryFile(dir=target.parent, suffix=".new", delete=False) as new,
        zipfile.ZipFile(new, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive,
    ):
        for name, data in files.items():
            info = zipfile.ZipInfo(name, date_time=(1980, 1, 1, 0, 0, 0))
            info.compress_type = zipfile.ZIP_DEFLATED
            info.external_attr = (0o100755 if name.endswith(".so") else 0o100644) << 16
            archive.writestr(info, data)
    Path(new.name).chmod(0o644)
    Path(new.name).replace(target)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--package", type=Path, required=True, help="the built package's folder")
    parser.add_argument("--tag", required=True, help="its Python, such as cp313")
    parser.add_argument("--version", required=True)
    parser.add_argument("--license", type=Path, required=True)
    parser.add_argument(
        "--linked",
        type=Path,
        action="append",
        default=[],
        metavar="SOURCE",
        help="source folder of a linked library, whose LICENSE.txt and NOTICE.txt go along",
    )
    parser.add_argument("--output", type=Path, required=True, help="folder to write the wheel in")
    options = parser.parse_args()

    package: Path = options.package
    name = package.name
    modules = sorted(package.glob("*.so"))
    if len(modules) != 1:
        raise SystemExit(f"make_wheel.py: {package} holds {len(modules)} modules (*.so), not one")
    glibc = needed_glibc(modules[0]).replace(".", "_")
    tag = f"{options.tag}-{options.tag}-manylinux_{glibc}_{platform.machine()}"

    files = {}
    for path in package.rglob("*"):
        if path.is_file() and "__pycache__" not in path.parts:
            data = stripped(path) if path.suffix == ".so" else path.read_bytes()
            files[path.relative_to(package.parent).as_posix()] = data
    info = f"{name}-{options.version}.dist-info"
    files[f"{info}/WHEEL"] = WHEEL.format(name=name, tag=tag).encode()
    licenses = {"LICENSE": options.license}
    for library in options.linked:
        licenses[f"{library.name}/LICENSE.txt"] = library / "LICENSE.txt"
        if (library / "NOTICE.txt").exists():
            licenses[f"{library.name}/NOTICE.txt"] = library / "NOTICE.txt"
    files |= {f"{info}/licenses/{path}": source.read_bytes() for path, source in licenses.items()}
    files[f"{info}/METADATA"] = METADATA.format(
        name=name,
        version=options.version,
        license_files="\n".join(f"License-File: {path}" for path in licenses),
    ).encode()
    files = dict(sorted(files.items()))
    files[f"{info}/RECORD"] = record(files, f"{info}/RECORD").encode()

    options.output.mkdir(parents=True, exist_ok=True)
    target = options.output / f"{name}-{options.version}-{tag}.whl"
    write_wheel(target, files)
    print(f"{target} ({target.stat().st_size // 1024} KiB)")
    return 0


if __name__ == "__main__":
    sys.exit(main())
