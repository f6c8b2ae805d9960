# SPDX-License-Identifier: GPL-3.0-or-later

"""The command `sampling-table` without Blender: its files, against the package's tables."""

import os

import prefilter
import pytest
from command_files import fails, run

SMALL = ("--filter", "tent", "--texels", 3, "--grid", 2, "--slices", 1)


def test_files_are_those_of_the_package(tmp_path, capsys):
    paths = [tmp_path / f"tent.{ending}" for ending in ("json", "glsl", "hlsl", "osl")]
    assert run("sampling-table", *paths, *SMALL) == 0
    table = prefilter.SamplingTable.build("tent", texels=3, subdomains=(2, 2, 1))
    told = capsys.readouterr().out
    assert f"Tent from 3 texels, with {table.error_ratio:.3g} times the error" in told
    table.save(tmp_path / "expected.json")
    assert paths[0].read_bytes() == (tmp_path / "expected.json").read_bytes()
    for path, source in zip(paths[1:], (table.glsl(), table.hlsl(), table.osl()), strict=True):
        assert path.read_text(encoding="utf-8") == source
    again = tmp_path / "again.osl"
    assert run("sampling-table", again, "--table", paths[0]) == 0
    assert again.read_bytes() == paths[3].read_bytes()


def test_the_table_of_the_package_is_taken_where_it_has_one(tmp_path):
    assert run("sampling-table", tmp_path / "a.glsl") == 0
    table = prefilter.SamplingTable.standard("lanczos2", 8)
    assert (tmp_path / "a.glsl").read_text(encoding="utf-8") == table.glsl()


@pytest.mark.parametrize(
    ("arguments", "status", "words"),
    [
        (("a.txt",), 2, "a.txt"),
        (("a.glsl", "--table", "b.json", "--texels", 4), 2, "--table: not allowed with --texels"),
        (("a.glsl", "--table", "missing.json"), 1, "missing.json"),
        (("missing/a.glsl",), 1, "there is no folder"),
    ],
)
def test_refusals(tmp_path, monkeypatch, capsys, arguments, status, words):
    monkeypatch.chdir(tmp_path)
    assert words in fails(capsys, status, "sampling-table", *arguments)
    assert os.listdir(tmp_path) == []
