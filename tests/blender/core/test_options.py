# SPDX-License-Identifier: GPL-3.0-or-later

"""Options: properties, flags, checks and tables from one declaration."""

import argparse
import math
from dataclasses import dataclass

import pytest


@pytest.fixture
def settings(addon):
    """A dataclass with an option of every kind."""
    options, choice = addon("core.options"), addon("core.choices").Choice
    known = {"a": choice("Apple", "Round"), "b-c": choice("Bean", "Long")}

    @dataclass(frozen=True)
    class Settings:
        kind: str = options.one_of("a", "Kind", "What it is", known, metavar="KIND")
        kinds: tuple[str, ...] = options.one_of(("a",), "Kinds", "What they are", known)
        count: int = options.number(3, "Count", "How many", low=1, high=12, metavar="N")
        share: float = options.number(
            0.5, "Share", "100% at most", low=0.0, high=1.0, is_above=True
        )
        bend: float = options.number(
            math.radians(30), "Bend", "How far", low=0.0, high=math.pi, subtype="ANGLE"
        )
        use_it: bool = options.switch(True, "It", "Use it")
        use_more: bool = options.switch(False, "More", "Use more")
        name: str = options.text("", "Name", "What it is called", flag="--called", metavar="NAME")
        hidden: int = options.number(7, "Hidden", "No flag", flag="")
        ink: tuple[float, ...] = options.rgba(
            (1.0, 1.0, 1.0, 0.5), "Ink", "Its color", metavar="COLOR"
        )
        place: tuple[float, ...] = options.numbers(
            (0.0, 1.0), "Place", "Where", low=-9.0, high=9.0, metavar="N"
        )
        threads: int = options.threads()

    return Settings


@pytest.fixture
def read(addon, settings):
    """Returns a function that reads arguments into settings."""
    flags = addon("core.flags")

    def run(*arguments):
        parser = argparse.ArgumentParser()
        flags.add_flags(parser, settings, exclusive=("count", "share"))
        return settings(**flags.given(parser.parse_args(arguments), settings))

    return run


def test_omitted_settings_have_their_defaults(read, settings):
    assert read() == settings()


def test_flags(read, settings):
    found = read(
        *("--kind", "b-c", "--kinds", "a", "b-c", "--count", "12", "--bend", "180", "--no-it"),
        *("--more", "--called", "x", "--threads", "2"),
    )
    assert found == settings(
        kind="b-c",
        kinds=("a", "b-c"),
        count=12,
        bend=math.pi,
        use_it=False,
        use_more=True,
        name="x",
        threads=2,
    )
    assert read("--no-it", "--it").use_it
    assert not read("--more", "--no-more").use_more
    assert read("--share", "1").share == 1.0
    half = ((0x80 / 255 + 0.055) / 1.055) ** 2.4
    assert read("--ink", "#0080ff").ink == pytest.approx((0, half, 1, 1))
    assert read("--place", "-1.5", "2").place == (-1.5, 2.0)
    assert read("--ink", "0080FF33").ink == pytest.approx((0, half, 1, 0.2))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--kind", "c"], "--kind: found 'c'; allowed: a, b-c"),
        (["--kinds", "a", "c"], "--kinds: found 'c'; allowed: a, b-c"),
        (["--count", "0"], "--count: found '0'; allowed: 1 to 12"),
        (["--count", "13"], "--count: found '13'; allowed: 1 to 12"),
        (["--count", "2.5"], "--count: found '2.5'; allowed: 1 to 12"),
        (["--count", "2", "--share", "1"], "not allowed with argument --count"),
        (["--share", "0"], "--share: found '0'; allowed: above 0, up to 1"),
        (["--share", "nan"], "--share: found 'nan'; allowed: above 0, up to 1"),
        (["--bend", "181"], "--bend: found '181'; allowed: 0 to 180"),
        (["--threads", "-1"], "--threads: found '-1'; allowed: 0 and up"),
        (["--threads", "inf"], "--threads: found 'inf'; allowed: 0 and up"),
        (["--ink", "#fff"], "--ink: found '#fff'; allowed: #RRGGBB or #RRGGBBAA"),
        (["--ink", "#00000g"], "--ink: found '#00000g'; allowed: #RRGGBB or #RRGGBBAA"),
        (["--place", "1"], "--place: expected 2 arguments"),
        (["--place", "1", "10"], "--place: found '10'; allowed: -9 to 9"),
        (["--place", "1", "nan"], "--place: found 'nan'; allowed: -9 to 9"),
        (["--hidden", "1"], "unrecognized arguments: --hidden 1"),
    ],
)
def test_wrong_values(read, capsys, arguments, message):
    with pytest.raises(SystemExit):
        read(*arguments)
    assert message in capsys.readouterr().err


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"kind": "c"}, "Kind: found c; allowed: a, b-c"),
        ({"kinds": ("a", "c")}, "Kinds: found a c; allowed: a, b-c"),
        ({"count": 0}, "Count: found 0; allowed: 1 to 12"),
        ({"share": math.nan}, "Share: found nan; allowed: above 0, up to 1"),
        ({"bend": -1.0}, "Bend: found -57.29578; allowed: 0 to 180"),
        ({"ink": (0, 0, 2, 1)}, "Ink: found #0000ff; allowed: #RRGGBB or #RRGGBBAA.*"),
        ({"ink": (0, math.nan, 0, 1)}, "Ink: found .*; allowed: #RRGGBB or #RRGGBBAA.*"),
        ({"place": (1.0, math.inf)}, "Place: found 1 inf; allowed: -9 to 9"),
        ({"threads": -1}, "threads: found -1; allowed: 0 and up"),
    ],
)
def test_checks(addon, settings, values, message):
    check = addon("core.options").check
    check(settings())
    with pytest.raises(ValueError, match=f"^{message}$"):
        check(settings(**values))


def test_help(addon, settings):
    flags = addon("core.flags")
    parser = argparse.ArgumentParser()
    flags.add_flags(parser, settings)
    text = " ".join(parser.format_help().split())
    assert "--count N how many (1 to 12; default: 3)" in text
    assert "100% at most (above 0, up to 1; default: 0.5)" in text
    assert "how far (0 to 180; default: 30)" in text
    assert "--it, --no-it use it (default: on)" in text
    assert "--more, --no-more use more (default: off)" in text
    assert "--ink COLOR its color --place N N where (-9 to 9; default: 0 1) --threads" in text
    assert flags.tables(settings, "kind") == [
        "--kind:\n  a                 Round\n  b-c               Long"
    ]


def test_table(addon, settings):
    rows = addon("core.options").table(settings).splitlines()
    assert rows[0] == "| Setting | Default | Meaning |"
    assert len(rows) == 2 + 11
    assert rows[2] == (
        "| Kind | Apple | What it is.<br>**Apple** (`a`): Round.<br>**Bean** (`b-c`): Long. |"
    )
    assert rows[6] == "| Bend | 30° | How far. Allowed: 0 to 180. |"
    assert rows[7] == "| It | on | Use it. |"
    assert rows[11] == "| Ink | #ffffff80 | Its color. |"
    assert rows[12] == "| Place | 0 1 | Where. Allowed: -9 to 9. |"
