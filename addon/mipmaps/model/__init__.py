# SPDX-License-Identifier: GPL-3.0-or-later

"""Every image of a model at once: what there is to bake, how, into which files, and the bake."""
