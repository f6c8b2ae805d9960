# SPDX-License-Identifier: GPL-3.0-or-later

"""Extensions of mesh files, apart from `mesh_files`, which loads numpy."""

WRITABLE = (".obj", ".ply", ".stl", ".glb")
READABLE = (*WRITABLE, ".gltf", ".off")
