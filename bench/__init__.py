# SPDX-License-Identifier: GPL-3.0-or-later

"""What docs/benchmarks/ is made with: a folder a subject, and what they share beside them.

Programs are started by their paths, put the checkout on sys.path, and import from here. What they
measure goes to results/ by `--json`, and pages.py makes the pages of it.
"""
