# SPDX-License-Identifier: GPL-3.0-or-later

"""Computing and writing mipmap levels of an image on its surfaces."""
