# SPDX-License-Identifier: GPL-3.0-or-later

"""What goes into wheels and the extension, and what the check of them finds."""

import io
import sysconfig
import zipfile
from collections.abc import Callable
from pathlib import Path

import packaging
import pytest

MODULE = f"_native{sysconfig.get_config_var('EXT_SUFFIX')}"
TAG = f"cp{sysconfig.get_config_var('py_version_nodot')}"


@pytest.fixture
def package(tmp_path: Path) -> Path:
    """A package with a subpackage, whose module is the one that was built."""
    built = packaging.built_package(TAG) / MODULE
    if not built.exists():
        pytest.skip(f"{built} is not built")
    folder = tmp_path / "prefilter"
    (folder / "textures/__pycache__").mkdir(parents=True)
    (folder / MODULE).write_bytes(built.read_bytes())
    for name in ("__init__.py", "py.typed", "textures/__init__.py", "textures/dds.py"):
        (folder / name).write_text(f"# {name}\n")
    (folder / "textures/__pycache__/dds.pyc").write_text("stale")
    return folder


def wheel_of(package: Path, target: Path) -> Path:
    target.mkdir()
    library = target / "library-1.0"
    library.mkdir()
    (library / "LICENSE.txt").write_text("free\n")
    return packaging.make_wheel(package, TAG, "1.2.3", [library], target)


def test_a_wheel_holds_subpackages_and_licenses(package: Path, tmp_path: Path) -> None:
    wheel = wheel_of(package, tmp_path / "wheels")
    assert packaging.wheel_faults(wheel.name, wheel.read_bytes()) == []
    with zipfile.ZipFile(wheel) as archive:
        names = set(archive.namelist())
        assert archive.read("prefilter/textures/dds.py") == b"# textures/dds.py\n"
    info = "prefilter-1.2.3.dist-info"
    assert names == {
        *(f"prefilter/{name}" for name in ("__init__.py", "py.typed", MODULE)),
        *(f"prefilter/textures/{name}" for name in ("__init__.py", "dds.py")),
        *(f"{info}/{name}" for name in ("METADATA", "RECORD", "WHEEL")),
        *(f"{info}/licenses/{name}" for name in ("LICENSE", "library-1.0/LICENSE.txt")),
    }


def test_the_same_package_gives_the_same_bytes(package: Path, tmp_path: Path) -> None:
    first, second = (wheel_of(package, tmp_path / name) for name in ("first", "second"))
    assert first.name == second.name
    assert first.read_bytes() == second.read_bytes()


def changed(wheel: Path, change: Callable[[dict[str, bytes]], None]) -> bytes:
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
    foreign = Path(str(sysconfig.get_config_var("DESTSHARED"))) / f"_ssl{MODULE[7:]}"

    def faults(change: Callable[[dict[str, bytes]], None], name: str = wheel.name) -> str:
        return "; ".join(packaging.wheel_faults(name, changed(wheel, change)))

    module = f"prefilter/{MODULE}"
    assert "not one" in faults(lambda files: files.update({"prefilter/more.so": b""}))
    assert "RECORD" in faults(lambda files: files.update({"prefilter/more.py": b""}))
    assert "newer than" in faults(dict, wheel.name.replace("manylinux_2_", "manylinux_2_9"))
    assert "no manylinux" in faults(dict, "prefilter-1.2.3-cp311-cp311-linux_x86_64.whl")
    found = faults(lambda files: files.update({module: foreign.read_bytes()}))
    assert "exports ['PyInit__ssl']" in found
    assert "libssl" in found


def test_faults_of_wheels_of_others_are_found() -> None:
    def faults(name: str, *files: str) -> list[str]:
        target = io.BytesIO()
        with zipfile.ZipFile(target, "w") as archive:
            for file in (*files, "css-1.0.dist-info/RECORD"):
                archive.writestr(file, "")
            listed = "".join(f"{file},,\n" for file in archive.namelist())
        target = io.BytesIO()
        with zipfile.ZipFile(target, "w") as archive:
            for file in files:
                archive.writestr(file, "")
            archive.writestr("css-1.0.dist-info/RECORD", listed)
        return packaging.wheel_faults(name, target.getvalue())

    license_text = "css-1.0.dist-info/licenses/LICENSE"
    pure = "css-1.0-py3-none-any.whl"
    assert faults(pure, "css/__init__.py", license_text) == []
    assert faults(pure, "css/__init__.py") == ["holds no license"]
    for module in ("css/fast.so", "css/fast.pyd", "css/.libs/libfast.so.2"):
        assert faults(pure, module, license_text) == ["is not of pure Python"]
    linux = "css-1.0-cp311-cp311-manylinux_2_17_x86_64.whl"
    assert faults(linux, "css/__init__.py", license_text) == ["is not of pure Python"]


def test_the_wheels_to_bundle_are_those_that_the_package_needs() -> None:
    listed = (packaging.SOURCE / "scripts/bundled.txt").read_text()
    needed = [
        line.split()[1] for line in packaging.METADATA.splitlines() if "Requires-Dist" in line
    ]
    for name in needed:
        assert name == "numpy" or f"\n{name}==" in listed


def test_the_manifest_lists_the_wheels_before_its_tables() -> None:
    manifest = 'id = "x"\n\n[permissions]\nfiles = "Write"\n'
    wheels = [Path("a/one.whl"), Path("a/two.whl")]
    listed = 'wheels = ["./wheels/one.whl", "./wheels/two.whl"]\n'
    assert packaging.with_wheels(manifest, wheels) == (
        f'id = "x"\n{listed}\n[permissions]\nfiles = "Write"\n'
    )
    assert packaging.with_wheels('id = "x"\n', wheels) == f'id = "x"\n{listed}'


def test_manifest_and_cmake_agree_on_the_version(tmp_path: Path) -> None:
    assert packaging.project_version() == packaging.project_version(packaging.SOURCE)
    (tmp_path / "CMakeLists.txt").write_text("project(prefilter VERSION 0.2.0 LANGUAGES CXX)\n")
    (tmp_path / "blender_manifest.toml").write_text('version = "0.1.0"\n')
    with pytest.raises(packaging.PackagingError, match=r"'0\.1\.0'.*'0\.2\.0'"):
        packaging.project_version(tmp_path)
    (tmp_path / "blender_manifest.toml").write_text('version = "0.2.0"\n')
    assert packaging.project_version(tmp_path) == "0.2.0"
