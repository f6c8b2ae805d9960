# SPDX-License-Identifier: GPL-3.0-or-later

"""The effort of block compression, observed in files."""

import io

import numpy as np
import prefilter
import pytest

EFFORTS = ("fast", "normal", "best")


def noisy(side: int) -> np.ndarray:
    """Waves with noise upon them, more texels than levels have that always get the best."""
    y, x = np.mgrid[0:side, 0:side] / 5
    waves = np.stack([np.sin(x + c) * np.cos(1.3 * y - c) for c in range(3)], axis=2)
    noise = np.random.default_rng(4).integers(-20, 21, waves.shape)
    return np.clip(np.rint(127 + 80 * waves + noise), 0, 255).astype(np.uint8)


def written(level: np.ndarray, **options: object) -> io.BytesIO:
    file = io.BytesIO()
    prefilter.write_ktx2(file, [level], **options)
    return file


@pytest.mark.parametrize(
    "format", ["bc1-rgb", "bc5", "bc7", "etc2-rgb", "astc-4x4", "uastc", "etc1s"]
)
def test_more_effort_comes_closer(format):
    level = noisy(72)
    errors, sizes = [], set()
    for effort in EFFORTS:
        file = written(level, format=format, effort=effort)
        sizes.add(file.tell())
        file.seek(0)
        (found,), _ = prefilter.read_ktx2(file)
        channels = 2 if format == "bc5" else 3
        difference = found[..., :channels].astype(float) - level[..., :channels]
        errors.append(np.mean(difference**2))
    assert format == "etc1s" or len(sizes) == 1
    assert errors[2] <= errors[1] * 1.02
    assert errors[2] < errors[0]


def test_bc6h_has_it_too():
    level = noisy(72).astype(np.float32) / 64
    files = {written(level, format="bc6h", effort=effort).getvalue() for effort in EFFORTS}
    assert len(files) == 3


def test_normal_effort_is_what_one_gets():
    level = noisy(72)
    made = written(level, format="bc7").getvalue()
    assert made == written(level, format="bc7", effort="normal").getvalue()
    assert made != written(level, format="bc7", effort="fast").getvalue()


def test_formats_without_blocks_know_no_effort():
    files = {written(noisy(8), effort=effort).getvalue() for effort in EFFORTS}
    assert len(files) == 1


@pytest.mark.parametrize("effort", ["slow", "", None, 1])
@pytest.mark.parametrize("write", [prefilter.write_dds, prefilter.write_ktx2])
def test_other_efforts_are_refused(tmp_path, write, effort):
    with pytest.raises(ValueError, match=f"effort: {effort!r} is not one of fast, normal, best"):
        write(tmp_path / "file", [noisy(8)], effort=effort)
    assert not list(tmp_path.iterdir())
