# SPDX-License-Identifier: GPL-3.0-or-later

"""Checks of messages: no tracebacks, no words of other libraries, the warnings that are due."""

import re
from collections.abc import Mapping
from typing import Any

from bench.field.runs import Run

_TRACEBACK = re.compile(r"^Traceback \(most recent call last\)|^\s+File \".*\", line \d+", re.M)
_FOREIGN = re.compile(
    r"\b(?:Errno|NoneType|KeyError|IndexError|TypeError|AttributeError|dtype|ndarray|subscriptable"
    r"|site-packages|codec can't|buffer size|0x[0-9a-f]{6,})\b"
)
_OURS = re.compile(r"^(?:prefilter: |error: |Error: |Warning: )", re.M)


def check(run: Run, truth: Mapping[str, Any]) -> list[str]:
    """Returns the faults in the exit status and the output of a run."""
    if run.status is None:
        return ["time limit: it did not end"]
    if run.status < 0 or run.status > 128:
        return [f"crash: status {run.status}, {_last_line(run.output)}"]
    if _TRACEBACK.search(run.output):
        return [f"traceback: {_last_line(run.output)}"]
    findings = []
    for line in run.output.splitlines():
        if _OURS.match(line) and (foreign := _FOREIGN.search(line)):
            findings.append(f"foreign words: '{foreign[0]}' in '{line[:160]}'")
    if run.status != 0:
        if truth.get("must_work"):
            findings.append(f"refused: {_last_line(run.output)}")
        elif not _OURS.search(run.output):
            findings.append(f"no message: status {run.status}, {_last_line(run.output)}")
    elif not run.target.exists():
        findings.append("no result: status 0, and no file")
    for pattern in truth.get("must_say", ()):
        if not re.search(pattern, run.output, re.IGNORECASE):
            findings.append(f"silent: nothing says '{pattern}'")
    return findings


def warnings(run: Run) -> list[str]:
    """Returns the lines of a run that warn of something."""
    return [line for line in run.output.splitlines() if re.search(r"\bwarning\b", line, re.I)]


def _last_line(text: str) -> str:
    lines = [line for line in text.strip().splitlines() if line.strip()]
    return lines[-1][:200] if lines else "nothing printed"
