# SPDX-License-Identifier: GPL-3.0-or-later

"""Sampling tables: arguments out of range, and invalid files."""

import json
import re

import numpy as np
import prefilter
import pytest


@pytest.fixture(scope="module")
def contents(tmp_path_factory):
    """The text of a small table's file."""
    path = tmp_path_factory.mktemp("table") / "table.json"
    prefilter.SamplingTable.build("tent", texels=3, subdomains=(2, 2, 1)).save(path)
    return path.read_text()


def refuse(path, text, *words):
    path.write_text(text)
    with pytest.raises(ValueError, match=re.escape(str(path))) as caught:
        prefilter.SamplingTable.load(path)
    message = str(caught.value)
    assert all(word in message for word in words), message[:300]


def changed(contents, change):
    table = json.loads(contents)
    change(table)
    return json.dumps(table)


def test_files_cut_off_anywhere_are_refused(contents, tmp_path):
    for length in range(0, len(contents.rstrip()), 37):
        refuse(tmp_path / "cut.json", contents[:length])


@pytest.mark.parametrize(
    "text", ["[]", "3", "null", '"table"', "{}", "\x00\xff", "[" * 100_000], ids=range(7)
)
def test_files_of_something_else_are_refused(text, tmp_path):
    refuse(tmp_path / "other.json", text)


def section_of(table, name, value):
    table["sections"][0][name] = value


CHANGES = [
    (lambda t: t.update(format="prefilter"), ["'prefilter'", "prefilter sampling table"]),
    (lambda t: t.update(version=2), ["version 2"]),
    (lambda t: t.update(version="1"), ["version"]),
    (lambda t: t.update(filter="sinc"), ["filter", "sinc"]),
    (lambda t: t.update(filter=None), ["filter"]),
    (lambda t: t.update(texels=4), ["offsets", "4"]),
    (lambda t: t.update(texels=-1), []),
    (lambda t: t.update(texels=1e300), []),
    (lambda t: t.update(texels=10**30), []),
    (lambda t: t.update(texels=True), []),
    (lambda t: t.update(degree=2), []),
    (lambda t: t.update(degree=0), ["degree"]),
    (lambda t: t.update(ramp_weight=-1), ["ramp_weight", "found -1"]),
    (lambda t: t.pop("ramp_weight"), ["ramp_weight"]),
    (lambda t: t.update(subdomains=[2, 3, 1]), ["subdomains"]),
    (lambda t: t.update(subdomains=[2, 2]), ["subdomains"]),
    (lambda t: t.update(subdomains=[2, 2, 4]), []),
    (lambda t: t.update(subdomains=[10**9, 10**9, 1]), ["subdomains"]),
    (lambda t: t.pop("sections"), ["sections"]),
    (lambda t: t["sections"].pop(), ["sections"]),
    (lambda t: t["sections"].reverse(), ["levels"]),
    (lambda t: t["sections"].__setitem__(1, None), []),
    (lambda t: section_of(t, "levels", 2), ["levels"]),
    (lambda t: section_of(t, "offsets", []), ["offsets"]),
    (lambda t: section_of(t, "offsets", [[[0, 0, 0], [1, 0, 0], [3, 0, 0]]]), []),
    (lambda t: section_of(t, "offsets", [[[0, 0, 0], [1, 0, 0], [2, 0, 10**9]]]), ["offsets"]),
    (lambda t: section_of(t, "offsets", [[[0, 0, 0], [1, 0, 0], [2, 0, 1000]]]), []),
    (lambda t: section_of(t, "offsets", [[[0, 0, 0], [1, 0, 0], [2, 0, 0.5]]]), ["offsets"]),
    (lambda t: section_of(t, "offsets", [[[0, 0, 0], [1, 0, 0], [-1, 0, 0]]]), []),
    (lambda t: section_of(t, "coefficients", [[[1, 0, 0]] * 3]), []),
    (lambda t: section_of(t, "coefficients", [[[1, 0, 0, 0]] * 3]), ["sum to 1"]),
    (lambda t: section_of(t, "coefficients", [[[1, 0, 0, 0], [0], [0]]]), ["coefficients"]),
    (lambda t: section_of(t, "coefficients", "1"), ["coefficients"]),
    (lambda t: section_of(t, "coefficients", [[["1", 0, 0, 0]] * 3]), []),
    (lambda t: section_of(t, "errors", []), ["errors"]),
    (lambda t: section_of(t, "errors", [float("nan")]), ["errors"]),
    (lambda t: section_of(t, "trilinear_errors", [float("inf")]), ["trilinear_errors"]),
    (lambda t: section_of(t, "gaps", [0.0, 0.0]), ["gaps"]),
    (lambda t: t["sections"][0]["coefficients"][0][0].__setitem__(0, float("nan")), []),
]


@pytest.mark.parametrize(("change", "words"), CHANGES)
def test_tables_that_are_none_are_refused(contents, change, words, tmp_path):
    refuse(tmp_path / "changed.json", changed(contents, change), *words)


def test_a_table_comes_back_as_it_was(contents, tmp_path):
    path = tmp_path / "again.json"
    path.write_text(changed(contents, lambda table: None))
    prefilter.SamplingTable.load(path).save(path)
    assert path.read_text() == contents


def test_what_cannot_be_read_or_written(contents, tmp_path):
    with pytest.raises(FileNotFoundError):
        prefilter.SamplingTable.load(tmp_path / "none.json")
    with pytest.raises(IsADirectoryError):
        prefilter.SamplingTable.load(tmp_path)
    path = tmp_path / "table.json"
    path.write_text(contents)
    table = prefilter.SamplingTable.load(path)
    with pytest.raises((OSError, ValueError)):
        table.save(tmp_path / "missing" / "table.json")
    assert sorted(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"filter": "radial3"}, "filter: 'radial3'"),
        ({"filter": None}, "filter"),
        ({"texels": 1}, "texels: found 1"),
        ({"texels": 17}, "texels: found 17"),
        ({"texels": 2.5}, "texels"),
        ({"texels": 2**40}, "texels"),
        ({"texels": float("nan")}, "texels"),
        ({"subdomains": (0, 0, 1)}, "subdomains"),
        ({"subdomains": (17, 17, 1)}, "subdomains"),
        ({"subdomains": (4, 2, 1)}, "subdomains"),
        ({"subdomains": 4}, "subdomains"),
        ({"degree": 3}, "degree"),
        ({"ramp_weight": float("nan")}, "ramp_weight"),
        ({"ramp_weight": 1e7}, "ramp_weight"),
        ({"threads": -1}, "threads"),
    ],
)
def test_shapes_out_of_range_are_refused(arguments, words):
    with pytest.raises(ValueError, match=re.escape(words)):
        prefilter.SamplingTable.build(**{"filter": "tent", **arguments})


@pytest.mark.parametrize("arguments", [("radial3",), ("tent", 5), ("tent", None), (None,), (3, 8)])
def test_tables_that_do_not_ship(arguments):
    with pytest.raises(ValueError, match=r"^(filter|texels): "):
        prefilter.SamplingTable.standard(*arguments)


def test_more_texels_than_a_filter_overlaps():
    # Fine subdomains of the box have few candidates; where one level is there, four at the most.
    table = prefilter.SamplingTable.build("box", texels=16, subdomains=(2, 2, 1))
    section = table.section(1)
    assert section.offsets.shape == (1, 16, 3)
    assert section.errors == pytest.approx(0.0, abs=1e-9)
    np.testing.assert_allclose(section.coefficients.sum(axis=1), [[1, 0, 0, 0]], atol=1e-7)
    levels = prefilter.sampling_levels(np.full((8, 8, 1), 0.5, np.float32), "box")
    found = prefilter.sample(levels, table, [(0.3, 0.7), (0.1, 0.9)], [1.0, 3.0])
    np.testing.assert_allclose(found, 0.5, atol=1e-6)
