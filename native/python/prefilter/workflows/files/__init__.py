# SPDX-License-Identifier: GPL-3.0-or-later

"""Files of pictures and of their levels, staged beside their targets."""
