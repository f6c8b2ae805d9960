# SPDX-License-Identifier: GPL-3.0-or-later

"""The operator `prefilter.sampling_table`."""

import bpy
import numpy as np
import prefilter
import pytest


def make(**options):
    return bpy.ops.prefilter.sampling_table(**options)


@pytest.mark.parametrize("language", ["glsl", "hlsl", "osl"])
def test_standard_tables_as_shader_code(language):
    assert make(filter="tent", texels=6, language=language) == {"FINISHED"}
    table = prefilter.SamplingTable.standard("tent", 6)
    assert bpy.data.texts[f"tent-6.{language}"].as_string() == getattr(table, language)()


def test_own_texts_are_overwritten_and_others_kept():
    bpy.data.texts.new("box-4.glsl").from_string("mine")
    for _ in range(2):
        make(filter="box", texels=4)
    assert bpy.data.texts["box-4.glsl"].as_string() == "mine"
    assert bpy.data.texts["box-4.glsl.001"].current_line_index == 0
    assert sorted(text.name for text in bpy.data.texts) == ["box-4.glsl", "box-4.glsl.001"]


def test_built_with_the_settings_and_saved(tmp_path):
    path = tmp_path / "own.json"
    options = {"filter": "bspline2", "texels": 3, "grid": 2, "slices": 1, "degree": 2}
    make(**options, ramp_weight=0.5, language="json", filepath=str(path))
    found = prefilter.SamplingTable.load(path)
    expected = prefilter.SamplingTable.build(
        "bspline2", texels=3, subdomains=(2, 2, 1), degree=2, ramp_weight=0.5
    )
    for levels in (3, 2, 1):
        for one, other in zip(found.section(levels), expected.section(levels), strict=True):
            np.testing.assert_array_equal(one, other)
    assert not bpy.data.texts

    make(table=str(path), language="hlsl")
    assert bpy.data.texts["bspline2-3.hlsl"].as_string() == expected.hlsl()


def test_the_table_itself_as_a_text(tmp_path):
    make(language="json")
    text = bpy.data.texts["lanczos2-8.json"].as_string()
    (tmp_path / "table.json").write_text(text)
    found = prefilter.SamplingTable.load(tmp_path / "table.json")
    assert found.error_ratio == prefilter.SamplingTable.standard().error_ratio


def test_certificates_are_reported(addon):
    choices = addon("images.choices")
    settings = choices.TableSettings(filter="tent", texels=2, grid=2, slices=1, use_certify=True)
    work = addon("images.sampling_tables").TableMaking(settings)
    work.compute(lambda _: True)
    outcome = work.write()
    ratio = prefilter.SamplingTable.build("tent", texels=2, subdomains=(2, 2, 1)).error_ratio
    assert f"Tent from 2 texels, with {ratio:.3g} times the error" in outcome.summary
    assert "proven to be the best" in outcome.notes[0]


def test_cancelled_leaves_nothing(addon, tmp_path):
    settings = addon("images.choices").TableSettings(texels=7)
    work = addon("images.sampling_tables").TableMaking(settings, [tmp_path / "table.json"])
    with pytest.raises(prefilter.Cancelled):
        work.compute(lambda fraction: fraction < 0.2)
    work.discard()
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"filepath": "FOLDER/table.txt"}, "unsupported extension '.txt'; use .glsl"),
        ({"filepath": "FOLDER/none/table.glsl"}, "there is no folder"),
        ({"table": "FOLDER/none.json"}, "none.json"),
        ({"table": "FOLDER/text.json"}, "Load: .*text.json.*no sampling table"),
    ],
)
def test_failures_are_reports(tmp_path, options, message):
    (tmp_path / "text.json").write_text("no table")
    options = {key: value.replace("FOLDER", str(tmp_path)) for key, value in options.items()}
    with pytest.raises(RuntimeError, match=message) as caught:
        make(**options)
    assert "Traceback" not in str(caught.value)
    assert not bpy.data.texts
    assert [path.name for path in tmp_path.iterdir()] == ["text.json"]


def test_undo():
    bpy.ops.ed.undo_push(message="before")
    make(texels=4)
    bpy.ops.ed.undo_push(message="after")
    bpy.ops.ed.undo()
    assert not bpy.data.texts
    assert make(texels=4) == {"FINISHED"}
