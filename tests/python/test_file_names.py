# SPDX-License-Identifier: GPL-3.0-or-later

"""File names that every system can write."""

import pytest
from prefilter.files.file_names import check_windows_names, identities, portable

DEVICES = ("CON", "nul", "PRN", "Aux", "COM1", "com9", "LPT0", "COM\u00b2", "CONIN$", "conout$")


@pytest.mark.parametrize("name", [*DEVICES, *(f"{name}.tar.gz" for name in DEVICES)])
def test_devices_get_an_underscore(name):
    stem, dot, rest = name.partition(".")
    assert portable(name) == f"{stem}_{dot}{rest}"
    with pytest.raises(ValueError, match="Windows does not allow"):
        check_windows_names(f"C:\\out\\{name}", is_windows=True)
    check_windows_names(f"C:\\out\\{name}", is_windows=False)


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("Wood", "Wood"),
        ("COM10.png", "COM10.png"),
        ("console.png", "console.png"),
        (".hidden", ".hidden"),
        ('a<b>c:d"e/f\\g|h?i*j', "a_b_c_d_e_f_g_h_i_j"),
        ("tab\there\x7f", "tab_here_"),
        ("dots...", "dots___"),
        ("space ", "space_"),
        ("con .txt", "con _.txt"),
        ("..", "__"),
        ("e\u0301", "\u00e9"),
        ("x\udcff", "x_"),
        ("\u5199\u771f", "\u5199\u771f"),
    ],
)
def test_portable_names(name, expected):
    assert portable(name) == expected
    assert portable(expected) == expected


@pytest.mark.parametrize(
    "path", ["C:\\a\\b.png", "..\\b.png", "a/./b.png", "C:b.png", "cafe\u0301.png"]
)
def test_what_windows_allows(path):
    check_windows_names(path, is_windows=True)


@pytest.mark.parametrize("path", ["a.png.", "what?.png", "ab:c.png", "aux/x.png", "x.png "])
def test_what_windows_forbids(path):
    with pytest.raises(ValueError, match=r"-o: '.*': Windows does not allow the name"):
        check_windows_names(path, "-o: ", is_windows=True)


def test_paths_to_one_file(tmp_path):
    file = tmp_path / "a.png"
    file.write_bytes(b"a")
    (tmp_path / "link").symlink_to(file)
    (tmp_path / "hard").hardlink_to(file)
    (tmp_path / "other").write_bytes(b"a")
    for name in ("A.PNG", "link", "hard", "./a.png", f"../{tmp_path.name}/a.png"):
        assert identities(file) & identities(tmp_path / name)
    for name in ("other", "none"):
        assert not identities(file) & identities(tmp_path / name)
