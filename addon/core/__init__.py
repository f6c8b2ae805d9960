# SPDX-License-Identifier: GPL-3.0-or-later

"""What every subject stands on: jobs, operators, commands, choices. It knows no subject."""
