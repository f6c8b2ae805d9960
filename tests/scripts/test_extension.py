# SPDX-License-Identifier: GPL-3.0-or-later

"""The contents of the zips, and the errors that keep them from being made."""

import tomllib
import zipfile
from pathlib import Path

import pytest

pytest.importorskip("lief")

from packager import extension
from packager.platforms import PLATFORMS
from packager.project import SOURCE, PackagingError


def test_the_manifest_lists_platforms_and_wheels_before_its_tables() -> None:
    manifest = 'id = "x"\n\n[permissions]\nfiles = "Write"\n'
    wheels = [Path("a/one.whl"), Path("a/two.whl")]
    listed = (
        'platforms = ["linux-x64", "windows-x64"]\n'
        'wheels = ["./wheels/one.whl", "./wheels/two.whl"]\n'
    )
    names = ("linux-x64", "windows-x64")
    assert extension.with_wheels(manifest, names, wheels) == (
        f'id = "x"\n{listed}\n[permissions]\nfiles = "Write"\n'
    )
    assert extension.with_wheels('id = "x"\n', names, wheels) == f'id = "x"\n{listed}'


def test_the_manifest_leaves_to_packaging_what_depends_on_it() -> None:
    manifest = tomllib.loads((SOURCE / "blender_manifest.toml").read_text())
    assert not {"platforms", "wheels"} & manifest.keys()


def test_a_release_fails_where_a_package_is_missing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(extension, "BUILD", tmp_path)
    for platform in PLATFORMS:
        for tag in extension.OFFICIAL_TAGS:
            if (platform, tag) != ("windows-x64", "cp313"):
                extension.cross_package(platform, tag).mkdir(parents=True)
    parts = extension.Parts([], [], [], ["false"])
    with pytest.raises(PackagingError, match=r"^not built: windows-x64 cp313, Debian cp314$"):
        extension.make_release(["cp311", "cp313"], tmp_path, parts)


def test_a_zip_without_one_of_its_wheels_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "prefilter-1.0-windows_x64.zip"
    bundled = [Path("css-1.0-py3-none-any.whl")]

    def check(*wheels: str) -> None:
        with zipfile.ZipFile(path, "w") as archive:
            for name in wheels:
                archive.writestr(f"wheels/{name}", "")
        extension.check_contents(path, bundled)

    ours = [f"prefilter-1.0-{tag}-{tag}-win_amd64.whl" for tag in ("cp311", "cp313")]
    with pytest.raises(PackagingError, match="made no"):
        extension.check_contents(path, bundled)
    check(*ours, bundled[0].name)
    with pytest.raises(PackagingError, match="not one wheel each"):
        check(ours[0], bundled[0].name)
    with pytest.raises(PackagingError, match="not one wheel each"):
        check(*ours, ours[1].replace("win_amd64", "macosx_11_0_arm64"), bundled[0].name)
    with pytest.raises(PackagingError, match="lacks"):
        check(*ours)
