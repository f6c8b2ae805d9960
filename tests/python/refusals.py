# SPDX-License-Identifier: GPL-3.0-or-later

"""What tests of bad input have in common."""

import re
from contextlib import contextmanager

import numpy as np
import pytest

NAN = np.nan
WRAPS = "is not one of clamp, repeat, border"
NUMBERS = "real numbers are needed"
TEXELS = "floating-point numbers, uint8 (a 255th each), uint16 (a 65535th each) or bool are needed"
AXES = "(height, width) or (height, width, channels) is needed"
THREADS = "a whole number is needed, 0 meaning all processors"


def changed(array, index, value):
    copy = np.array(array)
    copy[index] = value
    return copy


@contextmanager
def refused(words, error=ValueError):
    """What is within raises the error, whose message holds the words: the argument's name first."""
    with pytest.raises(error, match=re.escape(words[0])) as caught:
        yield
    for word in words:
        assert word in str(caught.value)


def check_refusal(function, arguments, words, error=ValueError):
    """A function comes with good arguments, of which these differ."""
    call, good = function
    with refused(words, error):
        call(**{**good, **arguments})
