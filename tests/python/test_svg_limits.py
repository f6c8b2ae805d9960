# SPDX-License-Identifier: GPL-3.0-or-later

"""Resource limits: small drawings that would take much memory or time are refused."""

import gc
import gzip
import tracemalloc

import numpy as np
import prefilter
import pytest
from drawings import drawn, polygon, read, svg


def refused(body, words):
    for source in (svg(body), gzip.compress(svg(body).encode())):
        with pytest.raises(ValueError, match=f"source.*: {words}"):
            prefilter.rasterize_svg(source, 16, 16)


def test_attributes_are_counted(monkeypatch):
    from prefilter.shapes._svg.read import document

    monkeypatch.setattr(document, "MAX_ATTRIBUTES", 100)
    assert read("<g a='1' b='2'/>" * 40).shapes == []
    refused("<g a='1' b='2'/>" * 60, "more than 100 attributes")


@pytest.mark.parametrize(
    "body",
    [
        '<rect style="{}"/>',
        '<rect transform="{}"/>',
        '<text x="{}">a</text>',
        '<rect fill="{}"/>',
        '<polygon points="{}"/>',
    ],
)
def test_long_attributes_are_refused(monkeypatch, body):
    from prefilter.shapes._svg.read import document

    monkeypatch.setattr(document, "MAX_VALUE", 1000)
    monkeypatch.setitem(document._MAX_VALUES, "points", 1000)
    read(body.format("1 " * 400))
    refused(body.format("1 " * 600), r"the attribute '\w+' has 1200 characters; at most 1000 are")


def test_long_paths_and_foreign_attributes_are_read(monkeypatch):
    from prefilter.shapes._svg.read import document

    monkeypatch.setattr(document, "MAX_VALUE", 1000)
    path = "M0 0" + "h1v1" * 400
    body = f'<path d="{path}" xmlns:other="http://example.org" other:original-d="{path}"/>'
    assert len(read(body).shapes) == 1


def test_text_is_counted(monkeypatch):
    from prefilter.shapes._svg.read import document

    monkeypatch.setattr(document, "MAX_TEXT", 1000)
    for tag in ("text", "style"):
        read(f"<{tag}>{' ' * 500}</{tag}>")
        refused(f"<{tag}>{' ' * 600}</{tag}>" * 2, "more than 1000 characters of text and style")


def test_style_sheets_are_counted_without_quoted_texts(monkeypatch):
    from prefilter.shapes._svg.read import style_rules

    monkeypatch.setattr(style_rules, "MAX_CHARACTERS", 1000)
    font = f"@font-face {{ src: url(data:font/ttf;base64,{'A' * 4000}) }}"
    read(f"<style>{font}</style>" * 2)
    refused(f"<style>{'a{fill:red}' * 60}</style>" * 2, "style sheets of more than 0 MiB")


@pytest.mark.parametrize(
    "selector",
    [
        "* " * 500,
        "g > " * 500 + "rect",
        ":not(" * 90 + "a" + ")" * 90,
        ":is(" * 40 + "a" + ")" * 40,
    ],
)
def test_selectors_of_many_compounds_are_ignored(selector):
    drawing = read(f"<style>{selector}{{fill:red}}</style><rect width='9' height='9'/>")
    assert len(drawing.shapes) == 1
    assert [warning.effect for warning in drawing.warnings] == ["ignored"]


def test_selectors_in_a_list_count_separately():
    style = "<style>" + ",".join(["svg g rect"] * 40) + "{fill:#f00}</style>"
    drawing = read(style + "<g><rect width='9' height='9'/></g>")
    assert drawing.warnings == ()
    np.testing.assert_array_equal(drawing.shapes[0].color, (1, 0, 0, 1))


def test_visited_ancestors_are_counted(monkeypatch):
    from prefilter.shapes._svg.read import styles

    monkeypatch.setattr(styles, "MAX_ANCESTORS", 200_000)
    # Each compound is tried at each ancestor, in 100 over 10 ways.
    style = f"<style>{'a ' + '* ' * 10}{{fill:red}}</style>"
    body = "<g>" * 100 + "<rect width='9' height='9'/>" + "</g>" * 100
    refused(style + body, "selectors look at more than 200000 elements")


def test_long_values_are_not_cached():
    from prefilter.shapes._svg.model import values
    from prefilter.shapes._svg.read import styles

    read("<rect style='fill:red'/>")
    tracemalloc.start()
    for k in range(4):
        read(f"<rect style='fill:red;--a{k}:{'x' * 100_000}'/>")
    gc.collect()
    kept, _ = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert kept < 100_000
    assert values.parse_color("#f00") is values.parse_color("#f00")
    assert styles._parse_declarations("fill:red") is styles._parse_declarations("fill:red")


def filtered(steps):
    return f'<filter id="f">{steps}</filter><rect filter="url(#f)" width="9" height="9"/>'


def named(count):
    """A filter that merges this many results."""
    offsets = "".join(f'<feOffset in="SourceGraphic" result="r{k}"/>' for k in range(count))
    nodes = "".join(f'<feMergeNode in="r{k}"/>' for k in range(count))
    return filtered(offsets + f"<feMerge>{nodes}</feMerge>")


def test_stored_filter_results_are_counted():
    prefilter.rasterize_svg(svg(named(60)), 16, 16)
    refused(named(70), "a filter keeps the results of more than 64 steps")


def test_unread_filter_results_are_freed():
    steps = "".join(f'<feOffset in="SourceGraphic" result="r{k}"/>' for k in range(100))
    actual, _ = prefilter.rasterize_svg(svg(filtered(steps)), 100, 100)
    plain, _ = prefilter.rasterize_svg(svg(filtered('<feOffset in="SourceGraphic"/>')), 100, 100)
    np.testing.assert_array_equal(actual, plain)


def test_merging_takes_as_much_memory_for_any_number_of_inputs():
    def most(count):
        body = filtered("<feMerge>" + '<feMergeNode in="SourceGraphic"/>' * count + "</feMerge>")
        tracemalloc.start()
        prefilter.rasterize_svg(svg(body), 256, 256, light="linear")
        _, peak = tracemalloc.get_traced_memory()
        tracemalloc.stop()
        return peak

    most(2)
    assert most(40) < 1.2 * most(4)


def test_distant_clips():
    body = (
        '<clipPath id="c"><path d="M0 0H1e120V5H0z"/></clipPath>'
        '<path fill="green" d="M0 0L5 5L3 9z" clip-path="url(#c)"/>'
    )
    # The triangle above y = 5: its edge from (0, 0) to (3, 9) passes it at 5 / 3.
    np.testing.assert_allclose(drawn(body), polygon((0, 0), (5, 5), (5 / 3, 5)), atol=1e-4)
