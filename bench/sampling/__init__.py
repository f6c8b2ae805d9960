# SPDX-License-Identifier: GPL-3.0-or-later

"""Samples of mipmaps: throughput beside other samplers."""
