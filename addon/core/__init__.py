# SPDX-License-Identifier: GPL-3.0-or-later

"""Code that every subject uses: jobs, operators, commands, options. It imports no subject."""
