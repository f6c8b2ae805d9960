# SPDX-License-Identifier: GPL-3.0-or-later

"""Files that are written beside their target and renamed, and names that every system allows."""
