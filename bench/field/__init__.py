# SPDX-License-Identifier: GPL-3.0-or-later

"""Runs what ships over ordinary files, and judges the results by checks that know no method."""
