# SPDX-License-Identifier: GPL-3.0-or-later

"""Sampling of images: by tables, probes and exact filters; images under transforms."""
