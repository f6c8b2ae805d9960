# SPDX-License-Identifier: GPL-3.0-or-later

"""Odd drawings, limits, threads and arguments."""

import numpy as np
import prefilter
import pytest
from drawings import box, composited_boxes, same, svg, whole


@pytest.mark.parametrize(
    "body",
    [
        '<mask id="m"><g mask="url(#m)"><rect width="9" height="9"/></g></mask><g mask="url(#m)"/>',
        '<clipPath id="c" clip-path="url(#c)"/><rect width="9" height="9" clip-path="url(#c)"/>',
        '<pattern id="p" width="1" height="1"><rect width="9" height="9" fill="url(#p)"/></pattern>'
        '<rect width="9" height="9" fill="url(#p)"/>',
        '<marker id="m"><path d="M0 0H9" marker-end="url(#m)"/></marker>'
        '<path d="M0 0H9" marker-end="url(#m)"/>',
        '<clipPath id="c" transform="scale(0)"><rect width="9" height="9"/></clipPath>'
        '<rect width="9" height="9" clip-path="url(#c)"/>',
        '<clipPath id="c"><rect width="1e300" height="1e300"/></clipPath>'
        '<rect width="9" height="9" clip-path="url(#c)"/>',
        '<mask id="m" width="1e300"><rect/></mask><rect width="9" height="9" mask="url(#m)"/>',
        '<pattern id="p" width="1e-300" height="1e300"><rect width="9" height="9"/></pattern>'
        '<rect width="9" height="9" fill="url(#p)"/>',
        '<pattern id="p" width="1e-9" height="1e-9" patternUnits="userSpaceOnUse">'
        '<rect width="9" height="9"/></pattern><rect width="9" height="9" fill="url(#p)"/>',
        '<image width="1e300" height="1" href="data:image/svg+xml,&lt;svg/&gt;"/>',
        '<image width="9" height="9" href="data:image/svg+xml,&lt;svg"/>',
        '<image width="9" height="9" href="data:image/png;base64,iVBORw0KGgoAAAAA"/>',
        '<image width="9" height="9" href="data:image/jpeg;base64,/9j/4AAQ"/>',
        '<image width="9" height="9" href="data:"/><image width="9" height="9" href="%"/>',
        '<marker id="m" markerWidth="1e300" viewBox="0 0 1e-9 1"><rect width="1" height="1"/>'
        '</marker><path d="M0 0H9V9ZZZM3 3" marker-mid="url(#m)" marker-end="url(#m)"/>',
        '<g style="mix-blend-mode:hue" opacity="0.5"/><g opacity="nan" style="isolation:x"/>',
        '<use href="#none" opacity="0.5"/><g mask="none" clip-path="url()"/>',
    ],
    ids=lambda body: body[:40],
)
def test_odd_drawings_are_drawn(body):
    for light in ("srgb", "linear"):
        actual, _ = prefilter.rasterize_svg(svg(body), 16, 16, light=light)
        assert np.isfinite(actual).all()


def test_layers_have_limits(monkeypatch):
    inner = box(0, 0, 50, 50) + box(20, 20, 70, 70)
    deep = '<g opacity="0.9">' * 60 + inner + "</g>" * 60
    # Each group contains another one, and becomes a layer.
    with pytest.raises(ValueError, match="source: layers are nested more than 48 deep"):
        prefilter.rasterize_svg(svg(deep), 8, 8)
    from prefilter.shapes._svg.draw import compositing

    monkeypatch.setattr(compositing, "MAX_LAYER_PIXELS", 1000)
    wide = f'<g opacity="0.5">{inner}</g>' * 20
    with pytest.raises(ValueError, match="source: more than 50000 layers, or of more than 1000"):
        prefilter.rasterize_svg(svg(wide), 16, 16)
    monkeypatch.undo()
    monkeypatch.setattr(compositing, "MAX_LAYERS", 10)
    with pytest.raises(ValueError, match="source: more than 10 layers"):
        prefilter.rasterize_svg(svg(wide), 16, 16)


def test_measured_elements_are_counted(monkeypatch):
    from prefilter.shapes._svg.model import limits

    clip = f'<clipPath id="c" clipPathUnits="objectBoundingBox">{box(0, 0, 1, 1)}</clipPath>'
    body = clip + '<g clip-path="url(#c)">' * 20 + box(0, 0, 50, 50) * 20 + "</g>" * 20
    same(whole(body), composited_boxes((0, 0, 50, 50, (0, 0, 0))))
    monkeypatch.setattr(limits, "MAX_MEASURED", 500)
    with pytest.raises(ValueError, match="source: boxes around groups of more than 500 elements"):
        whole(body)


@pytest.mark.parametrize(
    "group",
    [
        '<g mask="url(#m{})"><rect/></g>',
        '<rect fill="url(#m{})"/>',
        '<path marker-mid="url(#m{})"/>',
    ],
)
def test_repetition_by_references_is_checked_before_drawing(monkeypatch, group):
    from prefilter.shapes._svg.draw.drawing import TreeBuilder

    def visited(*_):
        raise AssertionError

    monkeypatch.setattr(TreeBuilder, "_visit", visited)
    tag = "mask" if "mask=" in group else "pattern" if "fill" in group else "marker"
    bombs = "".join(f'<{tag} id="m{k}">{group.format(k - 1) * 3}</{tag}>' for k in range(1, 20))
    with pytest.raises(ValueError, match="masks, patterns and markers repeat more than 250000"):
        prefilter.rasterize_svg(svg(bombs + group.format(19)), 9, 9)


def test_nested_patterns_are_limited():
    patterns = "".join(
        f'<pattern id="p{k}" width="1" height="1" patternUnits="userSpaceOnUse">'
        f'<rect width="0.5" height="1" fill="{f"url(#p{k - 1})" if k else "red"}"/></pattern>'
        for k in range(8)
    )
    actual = whole(patterns + box(20, 20, 60, 60, 'fill="url(#p1)"'))
    # Red fills half of the columns halfway.
    np.testing.assert_allclose(actual[25:55, 25:55, 3].mean(), 0.5, atol=0.01)
    assert np.isfinite(whole(patterns + box(20, 20, 60, 60, 'fill="url(#p7)"'))).all()


def test_garbled_drawings_are_drawn_or_refused():
    random = np.random.default_rng(6)
    good = svg(
        '<mask id="m"><rect width="60" height="60" fill="white"/></mask><filter id="f">'
        '<feGaussianBlur stdDeviation="2"/><feOffset dx="3"/></filter><clipPath id="c">'
        '<circle r="50"/></clipPath><pattern id="p" width="9" height="9" '
        'patternUnits="userSpaceOnUse"><rect width="5" height="5"/></pattern>'
        '<marker id="k" orient="auto"><path d="M0 0H3V3"/></marker>'
        '<g opacity=".5" mask="url(#m)" filter="url(#f)"><path d="M5 5L50 9 20 70z" '
        'fill="url(#p)" stroke="red" marker-mid="url(#k)"/></g><g clip-path="url(#c)" '
        'style="mix-blend-mode:hue"><rect width="40" height="40" transform="rotate(9)"/></g>'
    )
    letters = np.frombuffer(b'<>"0123456789.eE-+ ()#%;:,zaMQ', np.uint8)
    for _ in range(150):
        data = np.frombuffer(good.encode(), np.uint8).copy()
        places = random.integers(120, len(data), random.integers(1, 6))
        data[places] = random.choice(letters, len(places))
        try:
            actual, _ = prefilter.rasterize_svg(data.tobytes(), 12, 12)
        except ValueError as error:
            assert str(error).startswith("source")  # noqa: PT017
        else:
            assert np.isfinite(actual).all()


LAYERED = (
    f'<mask id="m">{box(0, 0, 60, 60, "fill=" + chr(34) + "#ccc" + chr(34))}</mask>'
    f'<g mask="url(#m)" opacity="0.4">{box(5, 5, 50.5, 50)}<circle cx="40" cy="40" r="31"/></g>'
    '<circle cx="60" cy="60" r="30" fill="red" style="mix-blend-mode:soft-light"/>'
)


def test_threads_do_not_change_bits():
    one, many = (whole(LAYERED, 200, threads=threads) for threads in (1, 4))
    np.testing.assert_array_equal(one, many)


def test_progress_and_canceling():
    told = []
    whole(LAYERED, progress=told.append)
    assert told == sorted(told)
    assert 0.0 <= told[0] <= told[-1] <= 1.0
    for limit in (0.1, 0.5):
        with pytest.raises(prefilter.Cancelled):
            whole(LAYERED, progress=lambda share, limit=limit: share < limit)


def test_bad_arguments():
    with pytest.raises(ValueError, match="light: 'both' is not one of linear, srgb"):
        whole("", light="both")
    with pytest.raises(ValueError, match="filter: 'sharp' is not one of box"):
        whole("", filter="sharp")
    with pytest.raises(ValueError, match="dtype"):
        whole("", dtype=np.uint16)
    with pytest.raises(ValueError, match="threads: -1"):
        whole("", threads=-1)
    with pytest.raises(ValueError, match="width: 0"):
        prefilter.rasterize_svg(svg(""), 0, 9)
    with pytest.raises(ValueError, match="source: no SVG drawing"):
        prefilter.rasterize_svg("<html/>", 9, 9)
