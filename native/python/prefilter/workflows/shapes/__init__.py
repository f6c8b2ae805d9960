# SPDX-License-Identifier: GPL-3.0-or-later

"""Images of vector shapes."""
