# SPDX-License-Identifier: GPL-3.0-or-later

"""Messages, and words that several of them share."""

from prefilter.workflows.wording import Sentence, amount, counted, either, joined, listed, together

__all__ = ("Sentence", "amount", "counted", "either", "joined", "listed", "together")
