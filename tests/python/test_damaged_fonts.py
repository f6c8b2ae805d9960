# SPDX-License-Identifier: GPL-3.0-or-later

"""Damaged fonts are left out with a warning, and text uses another font."""

import os
import struct

import numpy as np
import prefilter
import pytest
from box_fonts import make_font, make_variable

pytest.importorskip("tinycss2", reason="the packages that read SVG are not installed")

SIZE = 40
TABLES = ("cmap", "glyf", "head", "hhea", "hmtx", "loca", "maxp", "name", "OS/2", "post", "CFF ")


def drawn(family, folder, letter="A"):
    """Returns the alpha of a letter, and the subjects of the warnings."""
    source = (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{SIZE}" height="{SIZE}">'
        f'<text x="2" y="30" font-size="40" font-family="{family}">{letter}</text></svg>'
    )
    image, warnings = prefilter.rasterize_svg(source, SIZE, SIZE, fonts=[folder])
    return image[..., 3], [str(warning) for warning in warnings]


def entries(data):
    """Yields where the entry of each table is, and its tag, offset and length."""
    (count,) = struct.unpack_from(">H", data, 4)
    for at in range(12, 12 + 16 * count, 16):
        tag, _, offset, length = struct.unpack_from(">4sIII", data, at)
        yield at, tag.decode(), offset, length


def with_entry(data, wanted, offset=None, length=None):
    changed = bytearray(data)
    for at, tag, old_offset, old_length in entries(data):
        if tag == wanted:
            new = old_offset if offset is None else offset, old_length if length is None else length
            struct.pack_into(">II", changed, at + 8, *new)
    return bytes(changed)


def damages(data):
    """Yields whether a letter may lie elsewhere, and the damaged contents of a font."""
    lengths = (0, 1, 4, 40, len(data) // 2, len(data) * 9 // 10, len(data) - 1)
    yield from ((False, data[:length]) for length in lengths)
    yield from ((False, fill) for fill in (b"\0" * 1000, b"hello"))
    yield False, data[:12] + b"\xff" * (len(data) - 12)
    for _, tag, offset, length in list(entries(data)):
        if tag not in TABLES:
            continue
        yield False, with_entry(data, tag, offset=len(data) + 1000)
        yield False, with_entry(data, tag, length=2**31)
        yield False, with_entry(data, tag, length=0)
        yield False, with_entry(data, tag, length=length // 2)
        yield False, data.replace(tag.encode(), b"gone", 1)
        for fill in (b"\0", b"\xff"):
            filled = data[:offset] + fill * length + data[offset + length :]
            yield tag == "hmtx", filled


@pytest.fixture
def good(tmp_path):
    """A folder with a good font, whose letter has another width than in the damaged ones."""
    make_font(tmp_path / "good.ttf", family="Good", widths={"A": 700})
    return tmp_path


@pytest.mark.parametrize("kind", ["ttf", "otf", "variable"])
def test_text_is_drawn_in_another_font(good, kind):
    """The damaged font itself may serve where its damage does not show."""
    path = good / ("bad.otf" if kind == "otf" else "bad.ttf")
    if kind == "variable":
        make_variable(path)
    else:
        make_font(path, family="Bad", widths={"A": 600}, is_cff=kind == "otf")
    data = path.read_bytes()
    family = "Boxes" if kind == "variable" else "Bad"
    whole, warnings = drawn(family, good)
    assert not warnings
    other, _ = drawn("Good", good)
    assert whole.sum() > 0
    assert not np.array_equal(whole, other)
    told_of_file = 0
    for wrong_advance, damaged in damages(data):
        path.write_bytes(damaged)
        image, warnings = drawn(family, good)
        if np.array_equal(image, other):
            assert warnings
            told_of_file += any(f"font file '{path}': left out" in one for one in warnings)
        elif not wrong_advance:
            np.testing.assert_array_equal(image, whole)
    assert told_of_file > 20


def test_a_glyph_that_is_damaged_is_taken_from_another_font(good):
    path = make_font(good / "bad.ttf", family="Bad", widths={"A": 600, "V": 600})
    data = bytearray(path.read_bytes())
    at = {tag: offset for _, tag, offset, _ in entries(data)}
    (long_places,) = struct.unpack_from(">h", data, at["head"] + 50)
    assert long_places == 0
    start = 2 * struct.unpack_from(">H", data, at["loca"] + 2)[0]  # The glyph behind .notdef is A.
    struct.pack_into(">h", data, at["glyf"] + start, 30000)
    path.write_bytes(data)
    image, warnings = drawn("Bad", good)
    np.testing.assert_array_equal(image, drawn("Good", good)[0])
    assert any("font 'Bad': damaged: some letters" in one for one in warnings)
    intact, warnings = drawn("Bad", good, "V")
    assert intact.sum() > 0
    assert not any("damaged" in one for one in warnings)


def test_what_is_no_file_is_left_out(good):
    (good / "folder.ttf").mkdir()
    (good / "link.ttf").symlink_to("nowhere")
    image, warnings = drawn("Good", good)
    assert image.sum() > 0
    assert any("link.ttf" in one for one in warnings)
    assert not any("folder.ttf" in one for one in warnings)


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() == 0, reason="root reads all")
def test_a_file_that_may_not_be_read(good):
    path = make_font(good / "bad.ttf", family="Bad", widths={"A": 600})
    path.chmod(0)
    image, warnings = drawn("Bad", good)
    assert image.sum() > 0
    assert any("bad.ttf" in one for one in warnings)


def test_one_that_is_named_is_refused(tmp_path):
    (tmp_path / "bad.ttf").write_bytes(b"no font")
    with pytest.raises(ValueError, match=r"bad\.ttf' is no font that can be read: it is damaged"):
        drawn("Bad", tmp_path / "bad.ttf")
