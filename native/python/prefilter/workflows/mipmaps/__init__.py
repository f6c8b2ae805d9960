# SPDX-License-Identifier: GPL-3.0-or-later

"""The levels of an image on its surfaces, by what it holds."""
