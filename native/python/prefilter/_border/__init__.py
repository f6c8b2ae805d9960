# SPDX-License-Identifier: GPL-3.0-or-later

"""The border to callers: their arguments checked, and files written, the same way everywhere."""
