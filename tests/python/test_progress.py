# SPDX-License-Identifier: GPL-3.0-or-later

"""Progress, and stopping."""

import time

import numpy as np
import prefilter
import pytest
from scenes import random_image, random_soup, square

FILTERS = ["lanczos3", "lanczos3-covered", "pam-box", "pam-bilinear", "pam-trilinear"]


@pytest.mark.parametrize("filter", FILTERS)
def test_progress_rises_to_one(filter):
    seen = []
    prefilter.mipmaps(
        random_image(0, 512, 512, 3), square().surface, filter=filter, progress=seen.append
    )
    assert seen == sorted(seen)
    assert seen[0] >= 0.0
    assert seen[-1] == 1.0


@pytest.mark.parametrize("filter", FILTERS)
def test_returning_false_stops_soon(filter):
    image = random_image(0, 2048, 2048, 3)
    surface = random_soup(0, 50).surface
    stopped = []

    def stop_after_a_while(fraction):
        if fraction > 0.02:
            stopped.append(time.process_time())
            return False
        return True

    with pytest.raises(prefilter.Cancelled):
        prefilter.mipmaps(image, surface, filter=filter, progress=stop_after_a_while)
    assert len(stopped) == 1
    # Seconds of processors, which other programs do not change; the whole takes many.
    assert time.process_time() - stopped[0] < 1.0


def test_an_exception_in_the_callback_passes_through():
    def fail(fraction):
        raise KeyError("mine")

    with pytest.raises(KeyError, match="mine"):
        prefilter.mipmaps(random_image(0, 64, 64, 3), square().surface, progress=fail)


def test_error_reports_progress_too():
    image = random_image(0, 256, 256, 3)
    levels = prefilter.mipmaps(image, square().surface)
    with pytest.raises(prefilter.Cancelled):
        prefilter.mipmap_error(levels, image, square().surface, [1.0], progress=lambda f: False)


def test_other_values_than_false_go_on():
    answers = iter([None, 0, np.bool_(True), ""] + [None] * 1000)
    levels = prefilter.mipmaps(
        random_image(0, 64, 64, 1), square().surface, progress=lambda f: next(answers)
    )
    assert len(levels) == 7
