"""What a user may choose for an option, and how it is presented."""

from collections.abc import Mapping
from typing import NamedTuple


class Choice(NamedTuple):
    """One value of an option."""

    label: str
    description: str


def items(choices: Mapping[str, Choice]) -> list[tuple[str, str, str]]:
    """Returns the items of an enumeration property."""
    return [(key, choice.label, choice.description) for key, choice in choices.items()]
