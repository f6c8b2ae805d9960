# SPDX-License-Identifier: GPL-3.0-or-later

"""Options; the package declares those that its command has too."""

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
