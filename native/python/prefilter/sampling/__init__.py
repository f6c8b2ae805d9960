# SPDX-License-Identifier: GPL-3.0-or-later

"""Samples of images: by tables, probes and exact filters; images through transforms."""
