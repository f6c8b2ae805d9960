# SPDX-License-Identifier: GPL-3.0-or-later

"""Atomic replacement of files, and portable file names."""
