# SPDX-License-Identifier: GPL-3.0-or-later

"""Checks of the arguments of public functions, the same everywhere."""
