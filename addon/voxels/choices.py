"""What a user may set for voxels and booleans."""

import math
from dataclasses import dataclass

import prefilter

from ..core.choices import Choice
from ..core.options import number, one_of, switch, text, threads

RESOLUTIONS = {
    "depth": Choice("Depth", "Halve the cube around the object this many times"),
    "size": Choice("Voxel Size", "Cells of this size, in the units of the world"),
}
INTERPOLANTS = {
    "plane": Choice(
        "Plane", "A plane through each cell, fitted to its neighbors too: the smoothest"
    ),
    "occupancy": Choice("Occupancy", "A plane that leaves each cell the volume that it has"),
    "linear": Choice("Linear", "Values interpolated between cells, as marching cubes do: ripples"),
}
OUTPUTS = {
    "mesh": Choice("Mesh", "The surface takes the place of the object's mesh"),
    "volume": Choice(
        "Volume", "A new volume object of an OpenVDB file, with the share of each cell as density"
    ),
}
OPERATIONS = {
    "difference": Choice("Difference", "Subtract the others from the active object"),
    "union": Choice("Union", "Keep what lies in any of the objects"),
    "intersection": Choice("Intersection", "Keep what lies in all of the objects"),
}
OPERANDS = {
    "keep": Choice("Keep", "The other objects stay as they are"),
    "hide": Choice("Hide", "The other objects are hidden, in renders too"),
    "delete": Choice("Delete", "The other objects are deleted"),
}


@dataclass(frozen=True)
class VoxelSettings:
    """How to voxelize, and what to make of it."""

    resolution: str = one_of(
        "depth", "Resolution", "How the size of the cells is given", RESOLUTIONS, flag=""
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
        "occupancy",
        "Interpolant",
        "How the surface runs through the cells",
        INTERPOLANTS,
        metavar="NAME",
    )
    use_close_holes: bool = switch(
        True,
        "Close Holes",
        "Close each hole by triangles to the middle of its border; without them the surface ends "
        "in steps there",
        flag_description="Leave holes open; the surface ends in steps there",
    )
    use_cleanup: bool = switch(
        True,
        "Clean Up",
        "Collapse short edges: a quarter fewer triangles, and no slivers, which shade badly",
        flag_description="Keep all triangles, slivers too",
    )
    use_materials: bool = switch(
        True,
        "Materials",
        "Triangles get the material of the nearest face",
        flag_description="Do not keep the materials of the nearest faces",
    )
    use_colors: bool = switch(
        True,
        "Color Attributes",
        "Vertices get the colors of the nearest point of the surface",
        flag_description="Do not keep the color attributes of the nearest points",
    )
    use_smooth: bool = switch(True, "Smooth Shading", "Shade the result smooth", flag="")
    smooth_angle: float = number(
        math.radians(30.0),
        "Angle",
        "Edges between faces that meet at a greater angle stay sharp",
        low=0.0,
        high=math.pi,
        subtype="ANGLE",
        flag_description="Edges with a greater angle stay sharp; 0 shades flat",
        metavar="DEGREES",
    )
    threads: int = threads()


@dataclass(frozen=True)
class VoxelizeSettings(VoxelSettings):
    """What `prefilter.voxelize` does."""

    output: str = one_of("mesh", "Output", "What to make", OUTPUTS, flag="")
    filepath: str = text(
        "",
        "File",
        "The OpenVDB file of the volume; empty for one beside the .blend file, named after the "
        "object",
        subtype="FILE_PATH",
        flag="",
    )


@dataclass(frozen=True)
class BooleanSettings(VoxelSettings):
    """What `prefilter.boolean` does."""

    operation: str = one_of(
        "difference", "Operation", "What to keep", OPERATIONS, metavar="OPERATION"
    )
    operands: str = one_of(
        "hide", "Others", "What becomes of the other selected objects", OPERANDS, flag=""
    )
