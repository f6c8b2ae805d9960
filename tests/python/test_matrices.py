# SPDX-License-Identifier: GPL-3.0-or-later

"""Products and inverses of small matrices, against NumPy's."""

import numpy as np
import pytest
from prefilter.workflows import matrices


@pytest.mark.parametrize(
    ("first", "second"),
    [((3, 3), (3, 3)), ((50, 2), (2, 3)), ((7, 4), (5, 4, 3)), ((3, 1), (1, 9))],
)
def test_products_are_numpys(first: tuple[int, ...], second: tuple[int, ...]) -> None:
    generator = np.random.default_rng(5)
    a, b = generator.normal(size=first), generator.normal(size=second)
    np.testing.assert_allclose(matrices.product(a, b), a @ b, atol=1e-14)


def test_inner_products_are_numpys() -> None:
    a, b = np.random.default_rng(6).normal(size=(2, 9))
    assert matrices.inner(a, b) == pytest.approx(a @ b, abs=1e-14)
    with pytest.raises(ValueError, match="shorter"):
        matrices.inner(a, b[:8])


def test_inverses_are_numpys() -> None:
    for matrix in np.random.default_rng(7).normal(size=(100, 3, 3)):
        found, expected = matrices.inverse(matrix), np.linalg.inv(matrix)
        np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-9 * np.abs(expected).max())
