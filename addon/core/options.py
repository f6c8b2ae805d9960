# SPDX-License-Identifier: GPL-3.0-or-later

"""Declaration of options; the package declares the ones that its command shares."""

from prefilter.options.options import (
    Option,
    check,
    declared,
    number,
    numbers,
    one_of,
    option,
    rgba,
    switch,
    table,
    text,
    threads,
)

__all__ = (
    "Option",
    "check",
    "declared",
    "number",
    "numbers",
    "one_of",
    "option",
    "rgba",
    "switch",
    "table",
    "text",
    "threads",
)
