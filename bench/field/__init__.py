# SPDX-License-Identifier: GPL-3.0-or-later

"""Runs the shipped entry points over ordinary files; the checks of the results know no method."""
