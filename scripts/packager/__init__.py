# SPDX-License-Identifier: GPL-3.0-or-later

"""Makes wheels and extensions from a build, and checks them; see command_line.py."""
