# SPDX-License-Identifier: GPL-3.0-or-later

"""Files that the add-on reads and writes, each staged beside its target and renamed into place."""
