# SPDX-License-Identifier: GPL-3.0-or-later

"""Settings for voxelization and Boolean operations."""

import math
from dataclasses import dataclass

import prefilter

from .options import Choice, number, one_of, switch, text, threads

RESOLUTIONS = {
    "depth": Choice("Depth", "Halve the cube around the object this many times"),
    "size": Choice("Voxel Size", "Cells of this size, in the units of the world"),
}
HOLES = {
    "smooth": Choice("Smooth", "Patches that continue the surface around each hole"),
    "flat": Choice("Flat", "Patches of the smallest area"),
    "fan": Choice("Fan", "Triangles to the center of the border"),
}
INTERPOLANTS = {
    "sharp": Choice(
        "Sharp", "Like Plane, and keeps sharp edges and corners, including where meshes meet"
    ),
    "plane": Choice(
        "Plane", "A plane fitted to each cell and its neighbors: the most exact vertices"
    ),
    "occupancy": Choice("Occupancy", "A plane in each cell that preserves the volume of the cell"),
    "linear": Choice(
        "Linear", "Values interpolated between cells, as in marching cubes: shows ripples"
    ),
}
FACES = {
    "triangles": Choice("Triangles", "Small at edges, and large where the surface allows"),
    "quads": Choice(
        "Quads",
        "Quads alone, of the size of the cells, as for sculpting. Adaptivity and Clean Up do not "
        "apply",
    ),
}
OUTPUTS = {
    "mesh": Choice("Mesh", "Replace the object's mesh by the surface"),
    "volume": Choice(
        "Volume",
        "Add a volume object with an OpenVDB file, whose density is the filled share of each cell",
    ),
}
ORIGINALS = {
    "keep": Choice("Keep", "Keep it with the result, hidden, for Show Source and Update"),
    "replace": Choice("Replace", "Keep nothing of a mesh, which makes the file smaller"),
}
OPERATIONS = {
    "difference": Choice("Difference", "Subtract the others from the active object"),
    "union": Choice("Union", "Keep the space inside any of the objects"),
    "intersection": Choice("Intersection", "Keep the space inside all of the objects"),
}
OPERANDS = {
    "keep": Choice("Keep", "The other objects stay as they are"),
    "hide": Choice("Hide", "The other objects are hidden, in renders too"),
    "delete": Choice("Delete", "The other objects are deleted"),
}


@dataclass(frozen=True)
class VoxelSettings:
    """Settings that voxelization and Boolean operations share."""

    resolution: str = one_of(
        "depth", "Resolution", "How to specify the size of the cells", RESOLUTIONS, flag=""
    )
    depth: int = number(
        8,
        "Depth",
        "Octree depth: 8 gives 256 cells per axis, and each step quadruples the triangles",
        low=1,
        high=prefilter.MAX_DEPTH,
        display={"soft_max": 10},
        metavar="N",
    )
    voxel_size: float = number(
        0.1,
        "Voxel Size",
        "The side of a cell in world space",
        low=1e-6,
        subtype="DISTANCE",
        display={"soft_min": 0.001, "precision": 4, "step": 1},
        flag_description="The side of a cell in world space, instead of a depth",
        metavar="LENGTH",
    )
    interpolant: str = one_of(
        "sharp",
        "Interpolant",
        "How the surface is placed inside the cells",
        INTERPOLANTS,
        metavar="NAME",
    )
    faces: str = one_of(
        "triangles", "Faces", "The kind of faces of the surface", FACES, metavar="NAME"
    )
    adaptivity: float = number(
        0.05,
        "Adaptivity",
        "Make triangles larger where the surface is flat or gently curved, as long as it stays "
        "within this distance, in cells. Edges stay sharp. Triangles stay small where colors are "
        "painted",
        low=0.0,
        high=10.0,
        display={"soft_max": 1.0, "precision": 2, "step": 1},
        metavar="CELLS",
    )
    thickness: float = number(
        1.5,
        "Min Thickness",
        "Thinner parts and sheets get this thickness, in cells. If 0, they break up or are lost",
        low=0.0,
        high=100.0,
        display={"soft_max": 5.0, "precision": 2, "step": 10},
        metavar="CELLS",
    )
    gap: float = number(
        2.0,
        "Largest Gap",
        "Where the orientation of faces encloses nothing, fill the space that the outside does "
        "not reach through gaps of this width, in cells",
        low=0.0,
        high=100.0,
        display={"soft_max": 10.0, "precision": 2, "step": 10},
        metavar="CELLS",
    )
    use_close_holes: bool = switch(
        True,
        "Close Holes",
        "Close the holes of the mesh first. If off, the surface ends in steps there",
    )
    holes: str = one_of("smooth", "Holes", "How holes are closed", HOLES, metavar="NAME")
    use_cleanup: bool = switch(
        True,
        "Clean Up",
        "Remove narrow triangles, which shade badly: about a quarter fewer triangles",
    )
    use_materials: bool = switch(
        True,
        "Materials",
        "Each face keeps the material of its source face",
    )
    use_uv_maps: bool = switch(
        True,
        "UV Maps",
        "Keep UV maps. No face crosses a seam",
    )
    use_colors: bool = switch(
        True,
        "Color Attributes",
        "Keep color attributes, up to the edges where objects or charts meet",
    )
    use_attributes: bool = switch(
        True,
        "Other Attributes",
        "Keep vertex groups, custom normals and other attributes of the surface",
    )
    use_smooth_shading: bool = switch(True, "Smooth Shading", "Shade the result smooth", flag="")
    smooth_angle: float = number(
        math.radians(30.0),
        "Angle",
        "Keep edges sharp where faces meet at this angle, or a greater one",
        low=0.0,
        high=math.pi,
        subtype="ANGLE",
        flag_description="Keep edges sharp where faces meet at this angle, or a greater one; 0 "
        "shades flat",
        metavar="DEGREES",
    )
    originals: str = one_of(
        "keep", "Original", "How to treat the original object", ORIGINALS, flag=""
    )
    threads: int = threads()


@dataclass(frozen=True)
class VoxelizeSettings(VoxelSettings):
    """Settings of `prefilter.voxelize`."""

    output: str = one_of("mesh", "Output", "Type of the result", OUTPUTS, flag="")
    filepath: str = text(
        "",
        "File",
        "OpenVDB file of the volume. If empty, it is named after the object and written beside the "
        ".blend file",
        subtype="FILE_PATH",
        flag="",
    )


@dataclass(frozen=True)
class BooleanSettings(VoxelSettings):
    """Settings of Boolean operations."""

    operation: str = one_of(
        "difference", "Operation", "How to combine the objects", OPERATIONS, metavar="OPERATION"
    )
    operands: str = one_of(
        "hide", "Others", "What to do with the other selected objects", OPERANDS, flag=""
    )
    use_keep_resolution: bool = switch(
        True,
        "Keep Resolution",
        "Use cells as large as those of the active object, if an earlier run has made it",
        flag_description="use cells as large as those of the first operand, if an earlier run has "
        "made it and no resolution is given",
    )
