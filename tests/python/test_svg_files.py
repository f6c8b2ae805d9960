# SPDX-License-Identifier: GPL-3.0-or-later

"""SVG files: sources, warnings, refusals."""

import gzip
import math
import tracemalloc

import numpy as np
import prefilter
import pytest
from drawings import SIZE, image, read, same, svg

BOX = '<rect width="9" height="9"/>'
CLIP = "<clipPath id='c' transform='scale(2)'><rect x='5' width='15' height='50'/></clipPath>"


@pytest.mark.parametrize(
    ("body", "name"),
    [
        ("<foreignObject/>", "<foreignObject>"),
        (
            f'<filter id="f"><feWarp/></filter><g filter="url(#f)">{BOX}</g>',
            "filter with <feWarp>",
        ),
        (f'<filter id="f"><feOffset/></filter><g filter="url(#f)">{BOX}</g>', "filter"),
        ('<image width="9" height="9" href="http://example.org/a.png"/>', "<image>"),
        ('<rect width="9" height="9" clip-path="circle(4px)"/>', "clip-path"),
        ('<rect width="9" height="9" vector-effect="fixed-position"/>', "vector-effect"),
        ("<script>alert(1)</script>", "<script>"),
        (f'<mask id="m"><rect width="9" height="9"/></mask><g mask="url(#m)">{BOX}</g>', "mask"),
        (f"<style>g{{mix-blend-mode:multiply}}</style><g>{BOX}</g>", "mix-blend-mode"),
        (
            f'<pattern id="p" width="1" height="1">{BOX}</pattern>'
            '<rect width="9" height="9" fill="url(#p)"/>',
            "<pattern> as paint",
        ),
        ('<rect width="9vw" height="9"/>', "unit 'vw'"),
        ('<path d="M 0 0 H 9" stroke="red" stroke-linejoin="arcs"/>', "stroke-linejoin 'arcs'"),
        ("<style>@import url(a.css);</style>", "@import 'a.css'"),
        ("<style>rect ~ rect{fill:red}</style>", "selector 'rect ~ rect'"),
        (
            '<g opacity="0.5"><rect width="9" height="9"/><rect width="9" height="9"/></g>',
            "opacity of a group",
        ),
    ],
)
def test_unsupported_features(body, name):
    (warning,) = read("\n" + body).warnings
    assert (warning.kind, warning.name, warning.line, warning.count) == ("unsupported", name, 2, 1)
    assert name in str(warning)
    assert "line 2" in str(warning)


@pytest.mark.parametrize(
    ("body", "name"),
    [
        ('<image width="9" height="9" href="data:image/png;base64,iVBORw0KGgoAAAAA"/>', "<image>"),
        ('<image width="9" height="9" href="#a"/>', "<image>"),
        ('<g mask="url(#none)"/>', "mask"),
        ('<rect width="9" height="9" filter="url(#f)"/>', "filter"),
        ('<path d="M 0 0 H 9" marker-end="url(#none)"/>', "marker"),
        ('<g transform-origin="middle"/>', "transform-origin"),
        ('<rect width="9" height="9" fill="#12"/>', "fill '#12'"),
        ('<rect width="9 9" height="9"/>', "width '9 9'"),
        ('<rect width="9" height="9" transform="turn(3)"/>', "transform"),
        ('<polygon points="1 2 3 4 5"/>', "points"),
        ('<use href="#none"/>', "<use>"),
        ('<g clip-path="url(#none)"/>', "clip-path"),
        ('<g id="a"><use href="#a"/></g>', "<use>"),
        ('<rect width="9" height="9" fill="url(#none)"/>', "url(#none)"),
        ('<g id="a"/><rect width="9" height="9" fill="url(#a)"/>', "<g> as paint"),
        ('<rect width="1e300" height="9"/>', "<rect>"),
        ('<rect width="9" height="9" stroke="red" stroke-width="1e300"/>', "<rect>"),
        (
            '<rect width="9" height="9" stroke="red" stroke-dasharray="1e-9"/>',
            "stroke-dasharray",
        ),
        ("<style>rect{fill:red</style><style>rect}{fill:red}</style>", "style sheet"),
    ],
)
def test_broken_features(body, name):
    (warning,) = read(body).warnings
    assert (warning.kind, warning.name) == ("broken", name)


def test_features_without_warnings():
    body = (
        '<title>T</title><desc/><metadata><a xmlns="x"/></metadata><defs><text/></defs><g/>'
        '<x:y xmlns:x="z"/><symbol><text/></symbol><g opacity="0.5">'
        '<rect width="9" height="9"/><rect x="20" width="9" height="9"/></g>'
        '<switch><rect requiredExtensions="z" width="9" height="9"/>'
        '<rect systemLanguage="en-GB" width="9" height="9"/><rect width="9" height="9"/></switch>'
    )
    drawing = read(body)
    assert drawing.warnings == ()
    assert len(drawing.shapes) == 3


@pytest.mark.parametrize(
    "body",
    [
        f"{CLIP}<rect clip-path='url(#c)' x='10' width='30' height='200'/>",
        f"{CLIP}<g clip-path='url(#c)'><circle cx='25' cy='20' r='15'/></g>",
        f"{CLIP}<g clip-path='none'><rect width='99' height='9'/></g>",
        "<rect id='r' width='200' height='200'/><clipPath id='c'><use href='#r'/></clipPath>"
        "<g transform='rotate(90) translate(0 -100)' clip-path='url(#c)'>"
        "<rect y='3' width='9' height='9'/></g>",
        "<clipPath id='c'><path d='M0 0H100V100H0Z'/></clipPath><g clip-path='url(#c)'>"
        "<circle cx='-5' r='400'/></g>",
        "<svg width='5' height='5'><rect width='5' height='5'/></svg>",
        "<svg width='5' height='5' overflow='visible'><rect width='9' height='9'/></svg>",
    ],
)
def test_clip_paths_without_effect_cause_no_warning(body):
    assert read(body).warnings == ()


def test_equal_warnings_are_counted():
    (warning,) = read("<foreignObject/>\n" * 3).warnings
    assert (warning.count, warning.line) == (3, 1)
    assert "3 times" in str(warning)


def test_sources(tmp_path):
    markup = svg('<rect width="9" height="9"/>')
    (tmp_path / "a.svg").write_text(markup)
    (tmp_path / "a.svgz").write_bytes(gzip.compress(markup.encode()))
    declared = '<?xml version="1.0" encoding="{}"?>' + svg('<rect id="\xe9" width="9" height="9"/>')
    sources = [
        markup,
        "\ufeff  " + markup,
        markup.encode(),
        markup.encode("utf-16"),
        tmp_path / "a.svg",
    ]
    sources += [str(tmp_path / "a.svg"), tmp_path / "a.svgz", bytearray(markup.encode())]
    sources += [declared.format(name).encode(name) for name in ("utf-8", "latin-1", "cp1252")]
    sources += [declared.format("utf-16"), markup.replace("xmlns=", "xmlns:a=")]
    for source in sources:
        drawing = prefilter.read_svg(source)
        assert (drawing.width, drawing.height, drawing.light) == (100, 100, "srgb")
        assert len(drawing.shapes) == 1


def test_shapes_are_deterministic():
    drawing = read('<circle cx="50" cy="50" r="40"/>')
    first, second = drawing.shapes, drawing.shapes
    assert first is not second
    same(image(first), image(second))
    same(image(drawing.shapes_for(50, 50), 50, 50), image(drawing.shapes_for(50, 50), 50, 50))


def nested(count):
    return "<g>" * count + '<rect width="9" height="9"/>' + "</g>" * count


def bomb():
    """Rectangles repeated ten times at each of several levels."""
    tens = [
        f'<g id="g{k}">' + f'<use href="#g{k - 1}"/>' * 10 + "</g>"
        if k
        else '<g id="g0"><rect/></g>'
        for k in range(12)
    ]
    return svg("".join(tens))


LAUGHS = '<!DOCTYPE svg [<!ENTITY a "ha"><!ENTITY b "&a;&a;">]>' + svg("<title>&b;</title>")
LONG = f'<!DOCTYPE svg [<!ENTITY a "{"x" * 60000}">]>' + svg("&a;" * 60000)


@pytest.mark.parametrize(
    ("source", "words"),
    [
        (b"", "source is empty"),
        (b" \n", "source is empty"),
        ("<", "source, line 1, column 1: unclosed token"),
        ("<svg>\n<g></svg>", "source, line 2, column 6: mismatched tag"),
        (svg("<title>\xe9</title>").encode("latin-1"), "not well-formed"),
        ("<html/>", "no SVG drawing: found <html>"),
        ('<g xmlns="http://www.w3.org/2000/svg"/>', "found <g>"),
        (b"\x89PNG\r\n\x1a\n", "not well-formed"),
        (b'<?xml version="1.0" encoding="Shift_JIS"?><svg/>', "its encoding cannot be read"),
        (b'<?xml version="1.0" encoding="nonsense"?><svg/>', "its encoding cannot be read"),
        ('<svg><use xlink:href="#a"/></svg>', "unbound prefix"),
        (svg("", 'width="0" height="9"'), "width '0'; a drawing needs a positive one"),
        (svg("", 'height="-1"'), "height '-1'"),
        (svg("", 'width="1e300"'), "width '1e300'; a drawing needs a positive one below 1e+09"),
        (svg(nested(300)), "nested more than 256 deep"),
        (LAUGHS, "the entity 'b' would make the file too large"),
        (LONG, "the entity 'a' would make the file too large"),
        (gzip.compress(svg("").encode())[:-9], "compressed, and ends early"),
        (b"\x1f\x8bnonsense", "compressed, and damaged"),
        (svg(f'<g style="fill:{"(" * 9000}"/>'), "nested too deeply"),
        (3, "source: 3; a path, markup, or bytes are needed"),
    ],
    ids=lambda value: str(value)[:40],
)
def test_files_that_are_refused(source, words):
    with pytest.raises(ValueError, match="source") as caught:
        prefilter.read_svg(source)
    assert words in str(caught.value)


def test_refusals_name_the_file(tmp_path):
    path = tmp_path / "broken.svg"
    path.write_text("<svg>\n\n<")
    with pytest.raises(ValueError, match=r"broken\.svg', line 3, column 1"):
        prefilter.read_svg(path)
    with pytest.raises(FileNotFoundError):
        prefilter.read_svg(tmp_path / "none.svg")
    with pytest.raises(IsADirectoryError):
        prefilter.read_svg(tmp_path)


def test_decompression_is_limited():
    large = gzip.compress(svg(" " * (1 << 27)).encode())
    tracemalloc.start()
    with pytest.raises(ValueError, match="more than 64 MiB when unpacked"):
        prefilter.read_svg(large)
    _, most = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert most < 1 << 23


def test_repetition_is_checked_before_drawing(monkeypatch):
    from prefilter.shapes._svg.draw.drawing import TreeBuilder

    def drawn(*_):
        raise AssertionError

    monkeypatch.setattr(TreeBuilder, "_visit", drawn)
    with pytest.raises(
        ValueError, match="source: <use>, masks, patterns and markers repeat more than 250000"
    ):
        prefilter.read_svg(bomb())


def used(count, each="<rect width='9' height='9'/>"):
    """A group that is used `count` times."""
    return f"<defs><g id='a'>{each}</g></defs>" + "<use href='#a'/>" * count


def test_repetition_limit(monkeypatch):
    from prefilter.shapes._svg.model import limits

    # Each `use` is an element of the file, and repeats two.
    monkeypatch.setattr(limits, "MAX_USED", 20)
    assert len(read(used(10)).shapes) == 10
    with pytest.raises(ValueError, match="repeat more than 20 elements"):
        read(used(30))


@pytest.mark.parametrize(
    "body",
    [
        "<path d='M0 0" + "h1v1" * 60 + "'/>",
        used(3, "<path d='M0 0" + "h1v1" * 20 + "'/>"),
        "<path fill='none' stroke='red' stroke-dasharray='1' d='M0 0H40'/>",
        "<polygon points='" + "1 2 " * 101 + "'/>",
    ],
)
def test_lines_curves_and_dashes_are_counted(monkeypatch, body):
    from prefilter.shapes._svg.model import limits, outline

    for module in (limits, outline):
        monkeypatch.setattr(module, "MAX_SEGMENTS", 200)
    assert len(read(body).shapes) > 0
    for module in (limits, outline):
        monkeypatch.setattr(module, "MAX_SEGMENTS", 100)
    with pytest.raises(ValueError, match="source: more than 100 lines and curves"):
        read(body)


def test_elements_are_counted_while_they_are_read(monkeypatch):
    from prefilter.shapes._svg.read import document

    monkeypatch.setattr(document, "MAX_ELEMENTS", 100)
    assert read("<g/>" * 99).shapes == []
    with pytest.raises(ValueError, match="source, line 3: more than 100 elements"):
        read("\n" + "<g/>" * 50 + "\n" + "<g/>" * 50)


@pytest.mark.parametrize(
    "body",
    [
        nested(250),
        '<g id="a"><use href="#b"/></g><g id="b"><use href="#a"/></g>',
        '<linearGradient id="a" href="#b"/><linearGradient id="b" href="#a"/>'
        '<rect width="9" height="9" fill="url(#a)"/>',
        "".join(f'<linearGradient id="g{k}" href="#g{k + 1}"/>' for k in range(2000))
        + '<rect width="9" height="9" fill="url(#g0)"/>',
        '<path d="M 1e308 1e308 l 1e308 1e308 -1e308 0 z"/><circle r="1e200"/>',
        '<g transform="scale(1e200)"><rect transform="scale(1e200)" width="9" height="9"/></g>',
        '<svg viewBox="0 0 1e300 1e-300"><rect width="9" height="9"/></svg>',
        '<rect width="inf" height="nan"/><rect width="9" height="9" fill="hsl(1e999,9%,9%)"/>',
        f'<path d="M 0 0 L {"9" * 100_000} 1"/>',
        f'<path d="M 0 0 {" " * 100_000}{"," * 100_000}"/>',
        f'<rect width="1{" " * 100_000}z" height="1"/>',
        f'<path d="M 0 0 A 1 1 0 0 0 {" " * 100_000}"/>',
        f'<rect width="9" height="9" fill="{"(" * 20_000}"/>',
        f"<style>{':not(' * 2000}</style><rect/>",
        f"<style>rect{{{'{' * 2000}</style><rect/>",
        "<style>rect:nth-of-type(3){fill:red}</style>" + "<rect/>" * 2000,
        '<rect width="9" height="9" style=";;:red;}{fill:blue"/>',
    ],
    ids=lambda body: body[:40],
)
def test_odd_drawings_are_read(body):
    for shape in read(body).shapes_for(SIZE, SIZE):
        assert np.isfinite(shape.bounds).all()


def test_entities_are_expanded():
    doctype = (
        '<!DOCTYPE svg PUBLIC "-//W3C//DTD SVG 1.1//EN" "http://www.w3.org/svg11.dtd" '
        '[<!ENTITY ns "http://www.w3.org/2000/svg"><!ENTITY other SYSTEM "file:///etc/hostname">]>'
    )
    body = '<title>&other;</title><rect width="9" height="9"/>'
    drawing = prefilter.read_svg(f'{doctype}<svg xmlns="&ns;" viewBox="0 0 9 9">{body}</svg>')
    assert len(drawing.shapes) == 1


def test_garbled_files_are_read_or_refused():
    random = np.random.default_rng(5)
    good = svg(
        "<style>#a .b{fill:red;stroke:url(#g) blue;stroke-dasharray:2 1px}</style>"
        '<radialGradient id="g" fx="20%"><stop offset="0.2" stop-color="#123"/>'
        '<stop offset="70%" stop-opacity=".5"/></radialGradient>'
        '<g id="a" transform="rotate(30)"><path class="b" d="M1 2a3 4 5 0 1 6 7z"/></g>'
    )
    letters = np.frombuffer(b'<>"0123456789.eE-+ ()#%;:,zaMQ', np.uint8)
    for _ in range(200):
        data = np.frombuffer(good.encode(), np.uint8).copy()
        places = random.integers(150, len(data), random.integers(1, 9))
        data[places] = random.choice(letters, len(places))
        try:
            prefilter.read_svg(data.tobytes()).shapes_for(16, 16)
        except ValueError as error:
            assert str(error).startswith("source")  # noqa: PT017


def test_bad_arguments():
    with pytest.raises(ValueError, match="light: 'both' is not one of linear, srgb"):
        read("", light="both")
    with pytest.raises(ValueError, match="progress"):
        read("", progress=3)
    drawing = read("")
    for name, size in (
        ("width", (0, 9)),
        ("height", (9, -1)),
        ("width", (math.nan, 9)),
        ("height", (9, 1e9)),
    ):
        with pytest.raises(ValueError, match=f"{name}: .* a positive number of pixels is needed"):
            drawing.shapes_for(*size)


def test_progress_and_canceling():
    body = '<rect width="9" height="9"/>' * 3000
    told = []
    drawing = read(body, progress=told.append)
    assert told == sorted(told)
    assert len(told) > 5
    assert told[0] >= 0.0
    assert told[-1] <= 1.0
    for limit in (0.1, 0.4, 0.9):
        with pytest.raises(prefilter.Cancelled):
            read(body, progress=lambda share, limit=limit: share < limit)
    with pytest.raises(prefilter.Cancelled):
        drawing.shapes_for(SIZE, SIZE, progress=lambda _: False)


def test_entities_equal_their_markup():
    body = "<switch><foreignObject/><x/><rect width='9' height='9'/><rect/></switch>"
    drawing = read(body)
    assert len(drawing.shapes) == 1
    assert [str(each) for each in drawing.warnings] == [
        "<foreignObject>: replaced by what follows it (in line 1)"
    ]
    (warning,) = read("<switch><foreignObject/></switch>").warnings
    assert warning.effect == "left out"
