# SPDX-License-Identifier: GPL-3.0-or-later

"""Levels in place of their image: the drawing in editors, and when it is stale."""

from pathlib import Path

import bpy
import numpy as np
import prefilter
import pytest
import scenes

SESSION = Path(__file__).with_name("preview_session.py")
# Software rendering rounds sRGB values differently, most of all near black and when it blends.
BYTE, DARK_BYTE = 4.5, 13.0
BLENDED_BYTE = 10.0
CHECKER = (0.2, 0.15)  # The theme's colors; squares of 8 pixels.
QUAD = prefilter.Surface(
    np.array([(x, y, 0.0) for x, y in scenes.UNIT_SQUARE]),
    np.array([(0, 1, 2), (0, 2, 3)]),
    np.array([[scenes.UNIT_SQUARE[i] for i in corners] for corners in ((0, 1, 2), (0, 2, 3))]),
)


@pytest.fixture(scope="module")
def stored():
    """Returns the images of the session as Blender stores them."""
    bright = scenes.noise(64, 64, seed=2)
    bright[..., :3] *= 1.5
    return {
        "byte": scenes.noise(32, 64),
        "float": bright,
        "alpha": scenes.noise(16, 16, alpha=True, seed=3),
        "data": scenes.noise(16, 16, seed=4),
    }


@pytest.fixture(scope="module")
def shown(in_window, tmp_path_factory):
    """Runs the session once, and returns its results."""
    result = tmp_path_factory.mktemp("session") / "result.npz"
    in_window(SESSION, result)
    return dict(np.load(result))


def premultiplied(pixels, name):
    """Returns light: decoded unless it is light or data already, and multiplied by alpha."""
    light = pixels.astype(float)
    if name in {"byte", "alpha"}:
        light[..., :3] = scenes.to_linear(light[..., :3])
    light[..., :3] *= light[..., 3:]
    return light


def levels(pixels, name, which="pam-bilinear", reader="linear"):
    """Returns levels in premultiplied light, with four channels."""
    bounds = (0.0, None if name == "float" else 1.0)
    return prefilter.mipmaps(
        premultiplied(pixels, name).astype(np.float32),
        QUAD,
        filter=which,
        bounds=bounds,
        premultiplied=True,
        reader=reader,
    )


def displayed(light, x, y, channels):
    """Returns the expected pixels of the editor for premultiplied light, as bytes."""
    alpha = np.clip(light[..., 3:], 0, 1)
    straight = light[..., :3] / np.where(alpha > 0, alpha, 1)
    if bpy.app.version < (5, 0, 0):
        shown = scenes.to_srgb(np.clip(straight, 0, 1)) * alpha
    else:
        shown = scenes.to_srgb(np.clip(straight, 0, 1) * alpha)
    if channels == "COLOR_ALPHA":
        checker = np.where((x // 8 + y // 8) % 2 == 0, *CHECKER)[..., None]
        shown = scenes.to_srgb(
            scenes.to_linear(shown) + (1 - alpha) * scenes.to_linear(checker * np.ones(1))
        )
    elif channels == "ALPHA":
        shown = np.repeat(scenes.to_srgb(alpha), 3, axis=-1)
    elif channels == "GREEN":
        shown = np.repeat(shown[..., 1:2], 3, axis=-1)
    return 255 * shown


def places(shown, name, size):
    """Returns the coordinates of pixels, and a mask of pixels well inside a texel of level 0.

    Labels are below the image or on its lowest rows.
    """
    u, v = np.meshgrid(shown[f"{name}.u"], shown[f"{name}.v"])
    x, y = np.meshgrid(np.arange(u.shape[1]), np.arange(u.shape[0]))
    width, height = size
    clear = (u > 0) & (u < 1) & (v > 0) & (v < 1) & (y > 40)
    clear &= (x < u.shape[1] - 60) & (x > 20)  # The editor's own buttons.
    inside = (np.abs(u * width % 1 - 0.5) < 0.4) & (np.abs(v * height % 1 - 0.5) < 0.4)
    return u, v, x, y, clear & inside


def difference(seen, expected, mask, name):
    """Asserts that pixels agree, up to the renderer's rounding."""
    error = np.abs(seen.astype(float) - expected)[mask]
    dark = expected[mask] < 60
    assert mask.sum() > 5000, name
    blended = name.startswith("alpha")
    assert error[~dark].max(initial=0) < (BLENDED_BYTE if blended else BYTE), name
    assert error[dark].max(initial=0) < DARK_BYTE, name
    assert error.mean() < (3.5 if blended else 2.5), name


@pytest.mark.parametrize(
    ("name", "channels"),
    [
        *(("alpha", channels) for channels in ("COLOR_ALPHA", "COLOR", "ALPHA", "GREEN")),
        *(("byte", "COLOR_ALPHA"), ("byte", "GREEN"), ("data", "COLOR_ALPHA")),
        *(("float", "COLOR_ALPHA"), ("float", "COLOR")),
    ],
)
def test_display_is_the_editors_own(shown, stored, name, channels):
    """The editor itself is the oracle for colors, channels and transparency."""
    pixels = stored[name]
    height, width = pixels.shape[:2]
    shot = f"{name}.plain.{channels}"
    u, v, x, y, mask = places(shown, shot, (width, height))
    light = premultiplied(pixels, name)
    nearest = light[
        np.clip((v * height).astype(int), 0, height - 1),
        np.clip((u * width).astype(int), 0, width - 1),
    ]
    difference(shown[f"{shot}.screen"], displayed(nearest, x, y, channels), mask, shot)

    shot = f"{name}.level0.{channels}"
    u, v, x, y, mask = places(shown, shot, (width, height))
    smooth = scenes.bilinear(light, u, v)
    difference(shown[f"{shot}.screen"], displayed(smooth, x, y, channels), mask, shot)


@pytest.mark.parametrize("name", ["byte", "float", "alpha", "data"])
def test_level_is_a_bilinear_lookup(shown, stored, name):
    height, width = stored[name].shape[:2]
    u, v, x, y, mask = places(shown, f"{name}.level2", (width, height))
    light = scenes.bilinear(levels(stored[name], name)[2], u, v)
    expected = displayed(light, x, y, "COLOR_ALPHA")
    difference(shown[f"{name}.level2.screen"], expected, mask, name)


def test_wipe(shown, stored):
    u, v, x, y, mask = places(shown, "byte.wipe", (64, 32))
    middle = u.shape[1] / 2
    # Beside the line, and its arrows at half the height.
    mask &= np.abs(x + 0.5 - middle) > np.where(np.abs(y - u.shape[0] / 2) < 12, 18, 3)
    left = scenes.bilinear(levels(stored["byte"], "byte", "tent")[2], u, v)
    right = scenes.bilinear(levels(stored["byte"], "byte")[2], u, v)
    light = np.where((x < middle)[..., None], left, right)
    expected = displayed(light, x, y, "COLOR_ALPHA")
    difference(shown["byte.wipe.screen"], expected, mask, "wipe")
    other = displayed(np.where((x < middle)[..., None], right, left), x, y, "COLOR_ALPHA")
    assert np.abs(other - expected)[mask].mean() > 5


def test_captions_are_read_over_white(shown):
    """White letters on a dark plate, to both sides of the wipe."""
    screen = shown["white.screen"].astype(float).mean(axis=-1)
    middle = screen.shape[1] // 2
    assert (screen[60:-60, middle - 100 : middle + 100] > 250).mean() > 0.9
    for columns in (slice(middle - 35, middle - 12), slice(middle + 12, middle + 80)):
        caption = screen[10:22, columns]
        assert 0.4 < (caption < 120).mean() < 0.95
        assert (caption > 220).any()


def test_between_levels_and_zoomed_out(shown, stored):
    made = levels(stored["byte"], "byte")
    u, v, x, y, mask = places(shown, "byte.zoomed", (64, 32))
    light = (scenes.bilinear(made[1], u, v) + scenes.bilinear(made[2], u, v)) / 2
    expected = displayed(light, x, y, "COLOR_ALPHA")
    difference(shown["byte.zoomed.screen"], expected, mask, "zoomed")


def test_uvs_stay_in_front(shown, stored):
    made = levels(stored["byte"], "byte")
    u, v, x, y, _ = places(shown, "byte.uv", (64, 32))
    light = (scenes.bilinear(made[1], u, v) + scenes.bilinear(made[2], u, v)) / 2
    error = np.abs(shown["byte.uv.screen"] - displayed(light, x, y, "COLOR_ALPHA")).max(axis=-1)
    rows = (v[:, 0] > 0.4) & (v[:, 0] < 0.6)
    columns = u[0]
    assert error[np.ix_(rows, (columns > 0.35) & (columns < 0.65))].max() < BYTE + DARK_BYTE
    for edge in (0.3, 0.7):
        near = error[np.ix_(rows, np.abs(columns - edge) < 0.005)]
        assert np.all(near.max(axis=1) > 25)


@pytest.mark.parametrize("reader", ["linear", "srgb-after"])
def test_exact_where_nothing_is_rounded(shown, stored, reader):
    """In a framebuffer of floats, only the textures' 16-bit floats round."""
    made = {
        which: levels(stored["byte"], "byte", which, reader) for which in ("tent", "pam-bilinear")
    }
    if reader == "srgb-after":
        made = {which: [scenes.to_srgb(level) for level in made[which]] for which in made}
    place = (np.arange(48) + 0.5) / 48
    u, v = np.meshgrid(2 * place - 0.5, 2 * place - 0.5)
    inside = (u > 0) & (u < 1) & (v > 0) & (v < 1)
    last = len(made["tent"]) - 1
    for index, mip_value in enumerate((0.0, 1.0, 1.25, 99.0)):
        mip_value = min(mip_value, last)
        low = min(int(mip_value), last - 1)

        def lookup(which, low=low, share=mip_value - low):
            fine, coarse = (scenes.bilinear(level, u, v) for level in made[which][low : low + 2])
            if reader == "srgb-after":
                fine, coarse = scenes.to_linear(fine), scenes.to_linear(coarse)
            return fine + share * (coarse - fine)

        light = np.where((place < 0.5)[:, None], lookup("tent"), lookup("pam-bilinear"))
        found = shown[f"{'offscreen' if reader == 'linear' else 'encoded'} {index}"]
        expected = scenes.to_srgb(light[..., :3])
        np.testing.assert_allclose(found[inside][:, :3], expected[inside], atol=6e-4)
        assert not found[~inside].any()


def test_switch_gives_the_image_back(shown):
    bottom = shown["byte.off.screen"]
    height, width = 32, 64
    u, v, _, _, mask = places(shown, "byte.off", (width, height))
    pixels = 255 * scenes.noise(height, width)[..., :3]
    nearest = pixels[
        np.clip((v * height).astype(int), 0, height - 1),
        np.clip((u * width).astype(int), 0, width - 1),
    ]
    difference(bottom, nearest, mask, "off")


def test_stale_and_kept(shown, stored):
    assert shown["stale after a move"]
    assert shown["kept after undo"]
    assert not shown["stale before painting"]
    assert shown["stale after painting"]
    assert shown["ended"]
    assert shown["kept in next file"] == 0
    u, v, x, y, mask = places(shown, "byte.undone", (64, 32))
    made = levels(stored["byte"], "byte")
    light = (scenes.bilinear(made[1], u, v) + scenes.bilinear(made[2], u, v)) / 2
    difference(shown["byte.undone.screen"], displayed(light, x, y, "COLOR_ALPHA"), mask, "undone")


def preview_of(addon, name):
    return addon("textures.view.preview").find(bpy.data.images[name])


def test_computes_with_the_settings_of_the_bake(addon):
    """Without a window nothing is drawn, but levels exist."""
    image = scenes.image("Paint", scenes.noise(8, 4))
    scenes.textured_quad(image)
    bpy.context.scene.prefilter_bake.filter = "pam-box"
    bpy.context.scene.prefilter_bake.levels = 2
    assert bpy.ops.prefilter.preview_levels(image="Paint") == {"FINISHED"}
    found = preview_of(addon, "Paint")
    assert list(found.levels) == ["pam-box", "box"]
    assert [level.shape for level in found.levels["box"]] == [
        (8, 4, 3),
        (4, 2, 3),
        (2, 1, 3),
        (1, 1, 3),
    ]
    light = scenes.to_linear(scenes.pixels("Paint")[..., :3])
    np.testing.assert_allclose(found.levels["box"][1], scenes.halved(light), atol=1e-6)
    assert [image.name for image in bpy.data.images] == ["Paint"]


def test_same_filter_on_both_sides_is_computed_once(addon):
    scenes.textured_quad(scenes.image("Paint", scenes.noise(4, 4)))
    bpy.context.scene.prefilter_bake.filter = "box"
    bpy.ops.prefilter.preview_levels(image="Paint", compare="box")
    assert list(preview_of(addon, "Paint").levels) == ["box"]


def test_box_needs_no_surface_but_pam_does(addon):
    image = scenes.image("Paint", scenes.noise(4, 4))
    bpy.context.scene.prefilter_bake.filter = "box"
    bpy.ops.prefilter.preview_levels(image=image.name, compare="tent")
    assert preview_of(addon, "Paint") is not None
    with pytest.raises(RuntimeError, match="no surface"):
        bpy.ops.prefilter.preview_levels(image="Paint", compare="pam-box")


def test_removed_image_and_disabled_addon_leave_nothing(addon):
    image = scenes.image("Paint", scenes.noise(4, 4))
    scenes.textured_quad(image)
    bpy.ops.prefilter.preview_levels(image="Paint")
    module = addon("textures.view.preview")
    assert module._previews
    bpy.data.images.remove(image)
    bpy.context.view_layer.update()
    again = scenes.image("Paint", scenes.noise(4, 4))
    assert module.find(again) is None
    before = list(bpy.app.handlers.depsgraph_update_post)
    addon("textures.view").unregister()
    try:
        assert not module._previews
        # The handlers of previews, and of the 3D views that draw them.
        assert len(bpy.app.handlers.depsgraph_update_post) == len(before) - 2
        assert not hasattr(bpy.types.WindowManager, "prefilter_view")
    finally:
        addon("textures.view").register()


@pytest.mark.parametrize(
    "operator", ["preview_levels", "plot_error", "show_weights", "fill_unused"]
)
@pytest.mark.parametrize(
    ("name", "message"),
    [("", "image: no name is given"), ("Pain", "no image named 'Pain'"), ("Paint", "no surface")],
)
def test_failures_are_reports(operator, name, message):
    scenes.image("Paint", scenes.noise(4, 4))
    before = [image.name for image in bpy.data.images]
    with pytest.raises(RuntimeError, match=message) as caught:
        getattr(bpy.ops.prefilter, operator)(image=name)
    assert "Traceback" not in str(caught.value)
    assert [image.name for image in bpy.data.images] == before


@pytest.mark.parametrize(
    "operator", ["preview_levels", "plot_error", "show_weights", "fill_unused"]
)
def test_poll_without_images(operator):
    with pytest.raises(RuntimeError, match="no image in this file"):
        getattr(bpy.ops.prefilter, operator)()


@pytest.mark.parametrize("operator", ["end_preview", "show_source"])
def test_poll_outside_of_an_editor(operator):
    assert not getattr(bpy.ops.prefilter, operator).poll()
