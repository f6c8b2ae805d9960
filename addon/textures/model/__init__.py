# SPDX-License-Identifier: GPL-3.0-or-later

"""The bake of all images of a model: plan, decisions per image, files, and the bake itself."""
