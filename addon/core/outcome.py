# SPDX-License-Identifier: GPL-3.0-or-later

"""The outcome of work, from the package."""

from prefilter.workflows.outcome import FAILURES, Outcome, reason

__all__ = ("FAILURES", "Outcome", "reason")
