# SPDX-License-Identifier: GPL-3.0-or-later

"""The files of meshes that `mesh_files` writes, and those that it reads."""

TARGETS = (".obj", ".ply", ".stl", ".glb")
ENDINGS = (".obj", ".ply", ".stl", ".glb", ".gltf", ".off")
