# SPDX-License-Identifier: GPL-3.0-or-later

"""Data safety when writing fails or a program is killed."""
