# SPDX-License-Identifier: GPL-3.0-or-later

"""Oriented points to surfaces."""
