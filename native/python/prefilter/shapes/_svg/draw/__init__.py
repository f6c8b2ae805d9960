# SPDX-License-Identifier: GPL-3.0-or-later

"""Drawings: built from documents, and rendered to shapes or pixels."""
