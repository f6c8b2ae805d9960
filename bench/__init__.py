# SPDX-License-Identifier: GPL-3.0-or-later

"""Programs that measure the figures in docs/benchmarks/: a folder per subject, shared modules here.

Start a program by its path: it puts the checkout on sys.path and imports from here. With `--json`
it writes its figures to results/, from which pages.py makes the pages.
"""
