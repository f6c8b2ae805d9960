# SPDX-License-Identifier: GPL-3.0-or-later

"""Splitting work into tasks that the machines of a render farm do separately.

Together the tasks leave the same files, byte for byte, as one undivided run.
"""

import argparse
import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

from . import cli_common

T = TypeVar("T")


@dataclass(frozen=True)
class TaskPart:
    """One of `count` parts of the tasks, which takes every `count`-th of them.

    Attributes:
        number: Which part, from 1.
        count: How many parts there are.
    """

    number: int
    count: int

    def select(self, tasks: Sequence[T]) -> list[T]:
        """Returns the tasks in this part; none if there are fewer tasks than parts."""
        return list(tasks[self.number - 1 :: self.count])


def add_flags(parser: argparse.ArgumentParser, thing: str, *, needs: str = "") -> None:
    """Adds the flags that split the work.

    Args:
        parser: The parser that gets the flags; `check` validates them.
        thing: What one task does, such as "file".
        needs: Prefix of the help texts, where another flag is required.
    """
    parser.add_argument(
        "--task",
        metavar="K/N",
        type=_parse_part,
        help=f"{needs}do part K of N, from 1/N to N/N; with as many parts as --list has tasks, "
        f"each is one {thing}",
    )
    parser.add_argument(
        "--list", action="store_true", help=f"{needs}only say what would be done, as a table"
    )
    parser.add_argument(
        "--json", action="store_true", help="with --list, the tasks as JSON, for programs"
    )


def check(options: argparse.Namespace) -> None:
    """Ends the program if the flags contradict one another."""
    if options.json and not options.list:
        options.usage_error("--json: needs --list")
    if options.task and options.list:
        options.usage_error("--task: not allowed with --list, which says all tasks")


def select(options: argparse.Namespace, tasks: Sequence[T]) -> list[T]:
    """Returns the tasks to do here; prints a line if there are none."""
    if options.task is None:
        return list(tasks)
    selected: list[T] = options.task.select(tasks)
    if not selected:
        cli_common.print_line(
            f"Nothing to do in part {options.task.number} of {options.task.count}"
        )
    return selected


def print_json(tasks: Sequence[Mapping[str, Any]], **more: Any) -> None:
    """Prints numbered tasks, and more values, as one JSON object on a line."""
    numbered = [{"task": number, **task} for number, task in enumerate(tasks, start=1)]
    cli_common.print_line(json.dumps({"tasks": numbered, **more}))


def _parse_part(text: str) -> TaskPart:
    match = re.fullmatch(r"(\d{1,9})/(\d{1,9})", text, re.ASCII)
    if match is None or not 1 <= int(match[1]) <= int(match[2]):
        raise argparse.ArgumentTypeError(f"found '{text}'; K/N is needed, with K from 1 to N")
    return TaskPart(int(match[1]), int(match[2]))
