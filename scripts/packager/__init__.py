# SPDX-License-Identifier: GPL-3.0-or-later

"""Makes wheels and extensions of what is built, and checks them; see command_line.py."""
