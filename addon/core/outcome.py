# SPDX-License-Identifier: GPL-3.0-or-later

"""What work ends with."""

from prefilter.workflows.outcome import FAILURES, Outcome, reason

__all__ = ("FAILURES", "Outcome", "reason")
