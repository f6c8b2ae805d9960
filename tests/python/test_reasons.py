# SPDX-License-Identifier: GPL-3.0-or-later

"""Error messages for users."""

import errno

import pytest
from prefilter.workflows.outcome import reason

FULL = "No space left on device"


@pytest.mark.parametrize(
    ("error", "expected"),
    [
        (OSError(errno.ENOSPC, FULL, "/a/o.exr"), f"{FULL}: '/a/o.exr'"),
        (OSError(errno.ENOSPC, FULL, b"/a/o.exr"), f"{FULL}: '/a/o.exr'"),
        (OSError(errno.EXDEV, "Other device", "a", None, "b"), "Other device: 'a' -> 'b'"),
        (OSError(errno.ENOSPC, FULL), FULL),
        (OSError("file 'a': cannot be written"), "file 'a': cannot be written"),
        (ValueError("depth: 30; 1 to 15 are allowed"), "depth: 30; 1 to 15 are allowed"),
        (MemoryError(), "there is not enough memory"),
        (MemoryError("of 1 GB"), "there is not enough memory: of 1 GB"),
    ],
)
def test_errors_of_the_system_have_no_number(error, expected):
    assert reason(error) == expected
