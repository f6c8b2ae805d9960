# SPDX-License-Identifier: GPL-3.0-or-later

"""Pictures of other sizes, and in other places."""
