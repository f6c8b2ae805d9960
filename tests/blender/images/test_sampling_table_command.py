# SPDX-License-Identifier: GPL-3.0-or-later

"""The command `sampling-table`."""

import prefilter
import pytest
from command_line import assert_fails, run


def test_help():
    result = run("sampling-table", "--help")
    assert result.returncode == 0
    for word in ("OUTPUT", "--texels", "--certify", "lanczos2", "--table", "--grid"):
        assert word in result.stdout


def test_several_files_of_one_table(tmp_path):
    names = ("tent.json", "tent.glsl", "tent.HLSL", "tent.osl")
    result = run(
        *("sampling-table", *names, "--filter", "tent", "--texels", 3, "--grid", 2, "--slices", 1),
        cwd=tmp_path,
    )
    assert result.returncode == 0, result.stderr
    table = prefilter.SamplingTable.load(tmp_path / "tent.json")
    assert (table.filter, table.texels, table.subdomains, table.degree) == ("tent", 3, (2, 2, 1), 1)
    assert f"Tent from 3 texels, with {table.error_ratio:.3g} times the error" in result.stdout
    assert (tmp_path / "tent.glsl").read_text() == table.glsl()
    assert (tmp_path / "tent.HLSL").read_text() == table.hlsl()
    assert (tmp_path / "tent.osl").read_text() == table.osl()


def test_certified_and_loaded_again(tmp_path):
    result = run(
        *("sampling-table", "box.json", "--filter", "box", "--texels", 2, "--certify"),
        *("--grid", 2, "--slices", 1, "--threads", 1),
        cwd=tmp_path,
    )
    assert result.returncode == 0, result.stderr
    assert "proven to be the best" in result.stdout
    again = run("sampling-table", "box.glsl", "--table", "box.json", cwd=tmp_path)
    assert again.returncode == 0, again.stderr
    assert "proven to be the best" in again.stdout
    table = prefilter.SamplingTable.load(tmp_path / "box.json")
    assert (tmp_path / "box.glsl").read_text() == table.glsl()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("table.txt",), ("OUTPUT", "table.txt", ".glsl, .hlsl, .osl, .json")),
        (("table.json", "--filter", "radial3"), ("--filter", "'radial3'", "lanczos2")),
        (("table.glsl", "--table", "a.json", "--texels", 4), ("--table: not allowed", "--texels")),
        ((), ("OUTPUT",)),
    ],
)
def test_wrong_arguments(tmp_path, arguments, words):
    assert_fails(run("sampling-table", *arguments, cwd=tmp_path), *words, status=2)
    assert not list(tmp_path.iterdir())


def test_failures(tmp_path):
    (tmp_path / "text.json").write_text("{}")
    for arguments, words in (
        (("table.glsl", "--table", "none.json"), ("none.json",)),
        (("table.glsl", "--table", "text.json"), ("text.json", "no sampling table")),
        (("none/table.glsl",), ("there is no folder",)),
    ):
        assert_fails(run("sampling-table", *arguments, cwd=tmp_path), *words)
    assert [path.name for path in tmp_path.iterdir()] == ["text.json"]
