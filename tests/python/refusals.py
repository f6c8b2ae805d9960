# SPDX-License-Identifier: GPL-3.0-or-later

"""Helpers for tests of bad input."""

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
    """Expects the block to raise `error` with a message that starts with the first word.

    The message must contain all words; the first is the argument's name.
    """
    with pytest.raises(error, match=re.escape(words[0])) as caught:
        yield
    for word in words:
        assert word in str(caught.value)


def check_refusal(function, arguments, words, error=ValueError):
    """Calls a function with its good arguments, except for the given ones."""
    call, good = function
    with refused(words, error):
        call(**{**good, **arguments})
