# SPDX-License-Identifier: GPL-3.0-or-later

"""Workflows that the add-on and the command share: pictures are arrays, and Blender is absent."""
