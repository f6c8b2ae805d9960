# SPDX-License-Identifier: GPL-3.0-or-later

"""What is kept where writing fails, or a program is killed."""
