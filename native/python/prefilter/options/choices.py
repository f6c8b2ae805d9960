# SPDX-License-Identifier: GPL-3.0-or-later

"""What a user may choose for an option, and how it is presented."""

from typing import NamedTuple


class Choice(NamedTuple):
    """One value of an option."""

    label: str
    description: str
