# SPDX-License-Identifier: GPL-3.0-or-later

"""The phases of a bake, one by one: reading, decisions, and messages."""

from pathlib import Path

import bpy
import pytest
import scenes
from prefilter.workflows.textures import levels


@pytest.fixture
def request_of(addon):
    """Returns a function that asks for a bake with the settings given as keywords."""

    def make(image, *objects, **settings):
        chosen = addon("textures.choices").Settings(**settings)
        return addon("textures.bake_inputs").Request(image, objects, chosen, scenes.depsgraph())

    return make


@pytest.fixture
def without_surface(addon):
    """Returns a function that gives an image as it is baked, on no surface."""

    def make(image, settings, content):
        picture, found = addon("bridge.images").read(image), addon("bridge.meshes").ImageSurfaces()
        return addon("textures.source").on_surfaces(picture, found, settings, content)

    return make


def test_pixels_and_content_of_an_image(addon, request_of, tmp_path):
    bake_inputs = addon("textures.bake_inputs")
    image = scenes.image("Paint", scenes.noise(8, 4))
    found = bake_inputs.read_level_0(request_of(image, filepath=str(tmp_path / "paint.exr")))
    assert (found.numbers, found.content, found.is_encoded) == ([], "color", True)
    assert found.targets == [tmp_path / "paint.exr"]
    assert [one.shape[:2] for one in found.pictures] == [(8, 4)]
    data = scenes.image("Data", scenes.noise(4, 4), colorspace="Non-Color")
    found = bake_inputs.read_level_0(request_of(data))
    assert (found.targets, found.content, found.is_encoded) == ([], "data", False)
    with pytest.raises(ValueError, match="nothing to write"):
        bake_inputs.read_level_0(request_of(data, use_images=False))


def test_blocks_become_a_format(addon, request_of):
    bake_inputs = addon("textures.bake_inputs")
    request = request_of(scenes.image("Paint", scenes.noise(4, 4)), texture_format="blocks")
    made = bake_inputs.with_format(request, bake_inputs.read_level_0(request))
    assert (made.settings.texture_format, made.may_lose_channels) == ("bc7", True)
    plain = request_of(request.image, texture_format="bc1")
    assert bake_inputs.with_format(plain, bake_inputs.read_level_0(plain)) is plain


def test_roughness_is_of_normal_maps(addon, request_of):
    bake_inputs = addon("textures.bake_inputs")
    image = scenes.image("Paint", scenes.noise(4, 4))
    request = request_of(image, roughness="Rough")
    level_0 = bake_inputs.read_level_0(request)
    rough = bake_inputs.read_roughness(request, level_0)
    assert (rough.roughness, rough.target) == (None, None)
    (told,) = bake_inputs.usage_warnings(request, level_0, rough)
    assert told == "Roughness: 'Rough' is not used, because 'Paint' is not a normal map"
    request = request_of(image, roughness="Rough", content="color")
    with pytest.raises(ValueError, match="the content is 'color'"):
        bake_inputs.read_roughness(request, bake_inputs.read_level_0(request))


@pytest.mark.parametrize(
    ("settings", "extensions", "expected", "is_told"),
    [
        ({}, [], ("repeat", "repeat"), False),
        ({}, ["EXTEND"], ("clamp", "clamp"), False),
        ({"wrap_v": "border"}, ["EXTEND"], ("clamp", "border"), False),
        ({}, ["EXTEND", "REPEAT"], ("clamp", "clamp"), True),
        ({}, ["MIRROR"], None, True),
        ({"wrap": "border"}, ["EXTEND", "REPEAT"], ("border", "border"), False),
    ],
)
def test_the_wrap_mode(addon, settings, extensions, expected, is_told):
    chosen = addon("textures.choices").Settings(**settings)
    wrap, told = addon("textures.source").resolve_wrap(chosen, extensions)
    assert expected in (None, wrap)
    assert [f"filtered as '{wrap[0]}'" in one for one in told] == [True] * is_told


@pytest.mark.parametrize(
    ("budget", "filter_name", "content", "expected"),
    [
        (0.01, "pam-bilinear", "color", True),
        (0.01, "pam-bilinear", "data", True),
        (0.01, "pam-bilinear", "normal", False),
        (0.01, "box", "color", False),
        (0.0, "pam-bilinear", "color", False),
    ],
)
def test_filters_that_support_seams(addon, without_surface, budget, filter_name, content, expected):
    image = scenes.image("Paint", scenes.noise(4, 4))
    settings = addon("textures.choices").Settings(seam_budget=budget, filter=filter_name)
    source = addon("textures.source").on_surfaces(
        addon("bridge.images").read(image),
        addon("bridge.meshes").ImageSurfaces(),
        settings,
        content,
    )
    assert levels.weights_seams(source) is expected


def test_the_line_that_says_what_was_baked(addon, without_surface):
    image = scenes.image("Paint", scenes.noise(4, 4))
    bake = addon("textures.bake")
    settings = addon("textures.choices").Settings(filter="box")
    source = addon("textures.source").on_surfaces(
        addon("bridge.images").read(image),
        addon("bridge.meshes").ImageSurfaces(),
        settings,
        "cutout",
    )
    summary = bake.summary(source, bake.Outputs(Path("/out/paint.dds")), ["a", "b"])
    assert summary.startswith("Baked 'Paint' as Cut-Out with Box into 2 level images and ")
    assert "paint.dds" in summary
    assert bake.summary(source, bake.Outputs(None), []).endswith("it has no further level")


def test_messages_about_a_model(addon):
    results = addon("textures.model.results").Results([])
    left = addon("textures.model.plan").LeftOut
    results.left_out += [left("A", "no pixels"), left("B", "no pixels"), left("C", "a movie")]
    results.fail(["D"], ValueError("image 'D': is broken"))
    results.fail(["E"], MemoryError())
    lines = ["Left out, no pixels: 'A', 'B'", "Left out, a movie: 'C'"]
    reasons = [
        "image 'D' is not baked: is broken",
        "image 'E' is not baked: there is not enough memory",
    ]
    assert results.failure_lines() == ["no image was baked", *reasons, *lines]
    with pytest.raises(ValueError, match="no image was baked"):
        results.outcome()
    results.baked.append("F")
    results.outcomes.append(addon("core.outcome").Outcome("", files=["/out/f.dds"], warnings=["w"]))
    told = results.outcome()
    assert told.summary == "Baked 1 of 3 images into 1 file in '/out'; not baked: 'D', 'E'"
    assert (told.warnings, told.notes) == ([*reasons, "w"], lines)


def test_a_normal_map_and_a_roughness_of_another_size_are_parted(addon):
    plan, preparation = addon("textures.model.plan"), addon("textures.model.preparation")
    for name, side in (("Bumps", 8), ("Rough", 4)):
        scenes.image(name, scenes.noise(side, side), colorspace="Non-Color")
    bumps = plan.Item("Bumps", "Bumps", (), (), "normal")
    rough = plan.Item("Rough", "Rough", (), (), "data", normal_map="Bumps")
    job = plan.Job(bumps, rough)
    pair = preparation.image_pair(job)
    assert (pair.normal_map.name, pair.rough.name, pair.fits) == ("Bumps", "Rough", False)
    first, second = preparation.split_job(job, pair)
    assert (first.item, first.roughness) == (bumps, None)
    assert second.item.image == "Rough"
    assert "whose size is 8 x 8, and its own 4 x 4" in second.item.notes[-1]
    bpy.data.images["Rough"].scale(8, 8)
    assert preparation.image_pair(job).fits
    alone = preparation.image_pair(plan.Job(rough, normal_map="Bumps"))
    assert (alone.normal_map.name, alone.rough.name) == ("Bumps", "Rough")
    assert preparation.image_pair(plan.Job(bumps)).rough is None


def test_a_folder_that_another_bake_removed_is_made_again(addon, tmp_path):
    """Like a canceled bake, which may stop after the next image was read."""
    image = scenes.image("Paint", scenes.noise(8, 8))
    quad = scenes.textured_quad(image, "Paint")
    bpy.context.view_layer.update()
    planned = addon("textures.model.plan").plan(bpy.context.view_layer, scenes.depsgraph(), [quad])
    settings = addon("textures.choices").Settings(use_images=False)
    target = tmp_path / "new" / "folders" / "Paint.exr"
    model = addon("textures.model.bake").ModelBake(
        planned, settings, {image.name_full: str(target)}
    )
    compute = addon("core.operator_hooks").run_steps(model.read_steps(scenes.depsgraph()))
    target.parent.rmdir()
    compute(lambda fraction: True)
    assert len(model.write()) == 1
    assert target.exists()
    model.discard()
    assert target.exists()
