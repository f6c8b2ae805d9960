# SPDX-License-Identifier: GPL-3.0-or-later

"""Values of options that have a fixed set of them, as users see them."""

from typing import NamedTuple


class Choice(NamedTuple):
    """One value of an option."""

    label: str
    description: str
