# SPDX-License-Identifier: GPL-3.0-or-later

"""Filters: read from markup, and applied to pixels."""
