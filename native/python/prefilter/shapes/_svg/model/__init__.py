# SPDX-License-Identifier: GPL-3.0-or-later

"""Elements of the drawn tree, and the values that they hold."""
