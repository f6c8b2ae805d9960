# SPDX-License-Identifier: GPL-3.0-or-later

"""Building blocks of messages, from the package."""

from prefilter.workflows.wording import Sentence, amount, counted, either, joined, listed, together

__all__ = ("Sentence", "amount", "counted", "either", "joined", "listed", "together")
