# SPDX-License-Identifier: GPL-3.0-or-later

"""The contents of wheels, and the faults that the check of them finds."""

import io
import tomllib
import zipfile
from collections.abc import Callable, Iterable
from pathlib import Path

import pytest
from small_modules import SUFFIXES, compiled

pytest.importorskip("lief")

from packager.check_wheel import bundled_faults, wheel_faults
from packager.licenses import missing_licenses
from packager.platforms import PLATFORMS, glibc_here
from packager.project import SOURCE, PackagingError
from packager.wheels import make_wheel

MODULE = f"_native.{SUFFIXES['linux-x64']}"
INFO = "prefilter-1.2.3.dist-info"
LIBRARIES = [path.parent.name for path in (SOURCE / "native").glob("*/CMakeLists.txt")]
ZIG = ("zig/LICENSE", "libcxx/LICENSE.TXT", "libcxxabi/LICENSE.TXT", "libunwind/LICENSE.TXT")


def texts(*more: str) -> list[str]:
    """The names of the licenses that every wheel has, and others."""
    linked = [
        f"{name}-1.0/LICENSE.txt" for name in LIBRARIES if name not in ("prefilter", "python")
    ]
    return ["LICENSE", "pybind11/copyright", *linked, *more]


def package_with(module: Path, folder: Path) -> Path:
    """A package with a subpackage and that module."""
    package = folder / "prefilter"
    (package / "textures/__pycache__").mkdir(parents=True)
    (package / module.name).write_bytes(module.read_bytes())
    for name in ("__init__.py", "py.typed", "textures/__init__.py", "textures/dds.py"):
        (package / name).write_text(f"# {name}\n")
    (package / "textures/__pycache__/dds.pyc").write_text("stale")
    return package


@pytest.fixture(scope="session")
def package(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("package")
    return package_with(compiled("linux-x64", folder), folder)


def licenses(names: Iterable[str], folder: Path) -> dict[str, Path]:
    path = folder / "LICENSE.txt"
    path.write_text("free\n")
    return dict.fromkeys(names, path)


def wheel_of(package: Path, target: Path, platform: str = "linux-x64", *more: str) -> Path:
    target.mkdir()
    named = licenses(texts(*(more or ("gcc/copyright",))), target)
    return make_wheel(package, "cp311", "1.2.3", PLATFORMS[platform], named, target)


def test_a_wheel_holds_subpackages_and_licenses(package: Path, tmp_path: Path) -> None:
    wheel = wheel_of(package, tmp_path / "wheels")
    assert wheel_faults(wheel.name, wheel.read_bytes(), newest_glibc=glibc_here()) == []
    with zipfile.ZipFile(wheel) as archive:
        names = set(archive.namelist())
        assert archive.read("prefilter/textures/dds.py") == b"# textures/dds.py\n"
        metadata = archive.read(f"{INFO}/METADATA").decode()
        commands = archive.read(f"{INFO}/entry_points.txt").decode()
    assert names == {
        *(f"prefilter/{name}" for name in ("__init__.py", "py.typed", MODULE)),
        *(f"prefilter/textures/{name}" for name in ("__init__.py", "dds.py")),
        *(f"{INFO}/{name}" for name in ("METADATA", "RECORD", "WHEEL", "entry_points.txt")),
        *(f"{INFO}/licenses/{name}" for name in texts("gcc/copyright")),
    }
    assert metadata.count("\nLicense-File: ") == len(texts()) + 1
    assert "\nProvides-Extra: command\nRequires-Dist: openimageio" in metadata
    assert commands == "[console_scripts]\nprefilter = prefilter.commands.program:main\n"


def test_the_same_package_gives_the_same_bytes(package: Path, tmp_path: Path) -> None:
    first, second = (wheel_of(package, tmp_path / name) for name in ("first", "second"))
    assert first.name == second.name
    assert first.read_bytes() == second.read_bytes()


@pytest.mark.parametrize(
    ("platform", "last", "more"),
    [
        ("linux-arm64", "manylinux_0_0_aarch64", (*ZIG, "glibc/LICENSES")),
        ("windows-x64", "win_amd64", (*ZIG, "mingw-w64/COPYING")),
        ("macos-arm64", "macosx_11_0_arm64", ZIG),
    ],
)
def test_a_wheel_of_another_platform(
    platform: str, last: str, more: tuple[str, ...], tmp_path: Path
) -> None:
    package = package_with(compiled(platform, tmp_path), tmp_path)
    wheel = wheel_of(package, tmp_path / "wheels", platform, *more)
    assert wheel.name == f"prefilter-1.2.3-cp311-cp311-{last}.whl"
    assert wheel_faults(wheel.name, wheel.read_bytes()) == []
    for other in PLATFORMS.keys() - {platform}:
        with pytest.raises(PackagingError, match=f"{other} needs"):
            wheel_of(package, tmp_path / other, other)


def changed(wheel: Path, change: Callable[[dict[str, bytes]], object]) -> bytes:
    """A wheel whose files went through `change`."""
    with zipfile.ZipFile(wheel) as archive:
        files = {name: archive.read(name) for name in archive.namelist()}
    change(files)
    target = io.BytesIO()
    with zipfile.ZipFile(target, "w") as archive:
        for name, data in files.items():
            archive.writestr(name, data)
    return target.getvalue()


def test_faults_of_wheels_are_found(package: Path, tmp_path: Path) -> None:
    wheel = wheel_of(package, tmp_path / "wheels")

    def faults(change: Callable[[dict[str, bytes]], object], name: str = wheel.name) -> str:
        return "; ".join(wheel_faults(name, changed(wheel, change), newest_glibc=glibc_here()))

    path = f"prefilter/{MODULE}"
    assert faults(dict) == ""
    assert "not one" in faults(lambda files: files.update({"prefilter/more.so": b""}))
    assert "RECORD" in faults(lambda files: files.update({"prefilter/more.py": b""}))
    assert "neither ELF" in faults(lambda files: files.update({path: b"text"}))
    assert "newer than" in faults(dict, wheel.name.replace("manylinux_0_0", "manylinux_2_99"))
    assert "no platform" in faults(dict, "prefilter-1.2.3-cp311-cp311-linux_x86_64.whl")
    assert "looks for" in faults(dict, wheel.name.replace("cp311", "cp313"))
    assert "not for windows" in faults(dict, "prefilter-1.2.3-cp311-cp311-win_amd64.whl")


def test_an_old_tag_on_a_module_that_needs_a_newer_glibc_is_found(tmp_path: Path) -> None:
    if glibc_here() < (2, 34):
        pytest.skip("this machine's glibc is older than 2.34")
    module = compiled(
        "linux-x64", tmp_path, before="int pthread_join();", result="pthread_join(0, 0)"
    )
    wheel = wheel_of(package_with(module, tmp_path), tmp_path / "wheels")
    assert wheel.name.endswith("-manylinux_2_34_x86_64.whl")
    data = wheel.read_bytes()
    assert wheel_faults(wheel.name, data, newest_glibc=(2, 34)) == []
    assert wheel_faults(wheel.name, data) == ["needs version 2.34 of the system, newer than 2.28"]
    assert wheel_faults(wheel.name.replace("2_34", "2_28"), data, newest_glibc=(2, 34)) == [
        "needs version 2.34 of the system; its name says 2.28"
    ]


@pytest.mark.parametrize("missing", ["LICENSE", "pybind11", "zstd", "gcc"])
def test_a_missing_license_is_found(package: Path, tmp_path: Path, missing: str) -> None:
    wheel = wheel_of(package, tmp_path / "wheels")

    def drop(files: dict[str, bytes]) -> None:
        for name in list(files):
            if name.startswith(f"{INFO}/licenses/{missing}"):
                del files[name]

    found = "; ".join(wheel_faults(wheel.name, changed(wheel, drop), newest_glibc=glibc_here()))
    lacking = found.partition("lacks licenses: ")[2]
    assert ("libcxx" if missing == "gcc" else missing) in lacking


def test_licenses_of_the_runtime_are_those_of_the_platform() -> None:
    def missing(platform: str, *more: str) -> list[str]:
        return missing_licenses(texts(*more), PLATFORMS[platform])

    assert missing("linux-x64", "gcc/copyright") == []
    assert missing("linux-arm64", *ZIG) == ["glibc/LICENSES"]
    assert missing("windows-x64", *ZIG) == ["mingw-w64/COPYING"]
    assert missing("windows-x64", "gcc/copyright") == [*ZIG, "mingw-w64/COPYING"]
    assert missing("macos-arm64", *ZIG) == []


def test_faults_of_wheels_of_others_are_found() -> None:
    def faults(name: str, *files: str) -> list[str]:
        target = io.BytesIO()
        record = "css-1.0.dist-info/RECORD"
        with zipfile.ZipFile(target, "w") as archive:
            for file in files:
                archive.writestr(file, "")
            archive.writestr(record, "".join(f"{file},,\n" for file in (*files, record)))
        return wheel_faults(name, target.getvalue())

    license_text = "css-1.0.dist-info/licenses/LICENSE"
    pure = "css-1.0-py3-none-any.whl"
    assert faults(pure, "css/__init__.py", license_text) == []
    assert faults(pure, "css/__init__.py") == ["holds no license"]
    for module in ("css/fast.so", "css/fast.pyd", "css/.libs/libfast.so.2"):
        assert faults(pure, module, license_text) == ["is not of pure Python"]
    several = "holds {} modules, for no platform or not just one".format
    linux = "css-1.0-cp311-cp311-manylinux_2_17_x86_64.whl"
    assert faults(linux, "css/__init__.py", license_text) == [several(0)]
    other = "css-1.0-cp311-cp311-freebsd_14_x86_64.whl"
    assert faults(other, "css/fast.so", license_text) == [several(1)]


def test_a_compiled_wheel_of_others_may_go_along(package: Path) -> None:
    """One module that exports its entry point alone, for the platform of the wheel's name."""
    contents = (package / MODULE).read_bytes()
    names = ["fast/__init__.py", "fast-1.0.dist-info/licenses/LICENSE"]

    def faults(platform: str, path: str = f"fast/{MODULE}") -> list[str]:
        found = bundled_faults(f"fast-1.0-cp313-cp313-{platform}.whl", names, {path: contents})
        return [each for each in found if "version" not in each]

    linux = "manylinux_2_17_x86_64.manylinux2014_x86_64"
    assert faults(linux) == []
    assert faults(linux, "fast/fast.so") == ["exports ['PyInit__native'], not just PyInit_fast"]
    assert faults("win_amd64") == ["is ELF for x86_64, not for windows-x64"]


def test_the_wheels_to_bundle_are_those_that_the_package_needs() -> None:
    listed = (SOURCE / "scripts/bundled.txt").read_text()
    project = tomllib.loads((SOURCE / "pyproject.toml").read_text())["project"]
    needed = {dependency.partition(">=")[0] for dependency in project["dependencies"]}
    assert needed >= {"numpy", "tinycss2"}
    for name in needed - {"numpy"}:
        assert f"\n{name}==" in listed
