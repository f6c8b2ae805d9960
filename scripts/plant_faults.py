#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later

"""Plants faults of one line each, and says which of them the tests see.

tests/faults.toml lists faults, and the tests that are to see them. This makes a checkout of the
last commit in build/faults, plants one fault after the other there, and runs its tests. It exits
with 1 where a fault stays unseen, or a test fails without one.

usage: scripts/plant_faults.py [PATTERN]     (only the faults whose files match it)
"""

import re
import subprocess
import sys
import time
import tomllib
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
LIST = ROOT / "tests" / "faults.toml"
CHECKOUT = ROOT / "build" / "faults" / "checkout"
LONGEST = 300.0
"""Seconds that the tests of a fault may take: an endless loop counts as detected, too."""


@dataclass(frozen=True)
class Fault:
    """A line that is changed, and the tests that see it.

    Attributes:
        file: Relative to the checkout.
        old: A part of one line that occurs once in the file.
        new: Its replacement.
        native: The filter of the C++ tests; empty for none.
        python: Arguments of pytest, for tests of the package; empty for none.
        blender: The same for tests inside Blender, of the add-on; empty for none.
    """

    file: str
    old: str
    new: str
    native: str = ""
    python: str = ""
    blender: str = ""

    @property
    def tests(self) -> str:
        """The tests that must detect it, in any of the three runners."""
        return self.native or self.python or self.blender


def read_faults(path: Path = LIST) -> list[Fault]:
    """Reads a list of faults.

    Raises:
        ValueError: One has no test, or is not of one line.
    """
    faults = [Fault(**one) for one in tomllib.loads(path.read_text(encoding="utf-8"))["fault"]]
    for fault in faults:
        if [fault.native, fault.python, fault.blender].count("") != 2:
            raise ValueError(f"{fault.file}: '{fault.old}' needs native, python or blender")
        if "\n" in fault.old + fault.new or not fault.old.strip() or fault.old == fault.new:
            raise ValueError(f"{fault.file}: '{fault.old}' is not one line that changes")
    return faults


def planted(text: str, fault: Fault) -> str:
    """Returns a file with the fault in it; raises ValueError unless its line is there once."""
    if text.count(fault.old) != 1:
        raise ValueError(f"{fault.file}: '{fault.old}' is there {text.count(fault.old)} times")
    return text.replace(fault.old, fault.new)


def _check_out() -> None:
    if not CHECKOUT.exists():
        subprocess.run(["git", "worktree", "prune"], cwd=ROOT, check=True)
        add = ["git", "worktree", "add", "--quiet", "--detach", str(CHECKOUT)]
        subprocess.run(add, cwd=ROOT, check=True)
    head = subprocess.run(
        ["git", "rev-parse", "HEAD"], cwd=ROOT, check=True, capture_output=True, text=True
    ).stdout.strip()
    subprocess.run(["git", "reset", "--quiet", "--hard", head], cwd=CHECKOUT, check=True)


def _in_checkout(command: str) -> "subprocess.CompletedProcess[str]":
    """Runs a command of the shell with the functions of scripts/lib.sh."""
    return subprocess.run(
        ["bash", "-c", f". scripts/lib.sh; setup; configure_release; {command}"],
        cwd=CHECKOUT,
        capture_output=True,
        text=True,
        timeout=LONGEST,
        check=False,
    )


def _build(targets: str) -> bool:
    command = f"ninja -C build/release {targets}"
    return _in_checkout(command).returncode == 0


def _tests_pass(fault: Fault) -> bool:
    if fault.native:
        command = f"build/release/tests/native/prefilter_tests --gtest_filter='{fault.native}'"
    elif fault.blender:
        command = (
            "ensure_extension; (exec_with_blender blender --background --factory-startup "
            "--python-exit-code 1 --python tests/blender/run.py -- "
            f"-qx {fault.blender})"
        )
    else:
        command = (
            "ensure_decoders $blender_tag; "
            'path="$build_dir/release/python/$blender_tag:$decoders"; '
            f'(exec_with_blender env PYTHONPATH="$path" python3 -m pytest -qx {fault.python})'
        )
    try:
        ran = _in_checkout(command)
    except subprocess.TimeoutExpired:
        return False
    if re.search(r"\b0 tests from|no tests ran", ran.stdout):
        raise ValueError(f"{fault.file}: '{fault.tests}' has no test")
    return ran.returncode == 0


def _outcome(fault: Fault) -> str:
    path = CHECKOUT / fault.file
    text = path.read_text(encoding="utf-8")
    path.write_text(planted(text, fault), encoding="utf-8")
    try:
        if not _build("prefilter_tests" if fault.native else "package_$blender_tag"):
            return "NO BUILD"
        return "NOT SEEN" if _tests_pass(fault) else "seen"
    finally:
        path.write_text(text, encoding="utf-8")


def main() -> int:
    """Plants all faults, or those whose file matches, and prints a line for each."""
    pattern = sys.argv[1] if len(sys.argv) > 1 else ""
    faults = [fault for fault in read_faults() if re.search(pattern, fault.file)]
    _check_out()
    subprocess.run(
        [
            "bash",
            "-c",
            ". scripts/lib.sh; setup; configure_release; compile release "
            "prefilter_tests package_$blender_tag",
        ],
        cwd=CHECKOUT,
        check=True,
    )
    broken = []
    for key in {(fault.native, fault.tests): fault for fault in faults}.values():
        if not _tests_pass(key):
            broken.append(key.tests)
    if broken:
        print("these fail without a fault:", *broken, sep="\n  ")
        return 1
    seen = 0
    for fault in faults:
        began = time.monotonic()
        outcome = _outcome(fault)
        seen += outcome == "seen"
        change = f"{fault.file}: {fault.new.strip() or 'without ' + fault.old.strip()}"
        print(f"{outcome:8}  {time.monotonic() - began:4.0f} s  {change}", flush=True)
    print(f"{seen} of {len(faults)} faults are seen")
    return int(seen < len(faults))


if __name__ == "__main__":
    raise SystemExit(main())
