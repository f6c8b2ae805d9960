"""What a user may choose for voxels and booleans, and how the choices are presented."""

import math
from dataclasses import dataclass

from ..core.choices import Choice

MOST_DEPTH = 12
LEAST_SIZE = 1e-6

RESOLUTIONS = {
    "depth": Choice("Depth", "Halve the cube around the object this many times"),
    "size": Choice("Voxel Size", "Cells of this size, in the units of the world"),
}
INTERPOLANTS = {
    "plane": Choice(
        "Plane", "A plane through each cell, fitted to its neighbours too: the smoothest"
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
    "difference": Choice("Difference", "What the active object has, and the others have not"),
    "union": Choice("Union", "What any of the objects has"),
    "intersection": Choice("Intersection", "What all of the objects have"),
}
OPERANDS = {
    "keep": Choice("Keep", "The other objects stay as they are"),
    "hide": Choice("Hide", "The other objects are hidden, in renders too"),
    "delete": Choice("Delete", "The other objects are deleted"),
}


@dataclass(frozen=True)
class VoxelSettings:
    """How to voxelize, and what to make of it.

    Attributes:
        resolution: A key of `RESOLUTIONS`: which of the two below counts.
        depth: Cells along an axis are 2 to the power of this; 1 to 12.
        voxel_size: The side of a cell in world space, above 0.
        interpolant: A key of `INTERPOLANTS`: how the surface runs through cells.
        use_close_holes: Whether holes get caps before the mesh is voxelized.
        use_cleanup: Whether to collapse short edges: fewer triangles, and no slivers to shade.
        use_materials: Whether triangles get the material of the nearest face of the source.
        use_colors: Whether vertices get the colour attributes of the nearest point of the source.
        use_smooth: Whether the result is shaded smooth.
        smooth_angle: Edges with a greater angle, in radians, stay sharp.
        threads: How many threads to use; 0 for all.
    """

    resolution: str = "depth"
    depth: int = 7
    voxel_size: float = 0.1
    interpolant: str = "plane"
    use_close_holes: bool = True
    use_cleanup: bool = True
    use_materials: bool = True
    use_colors: bool = True
    use_smooth: bool = True
    smooth_angle: float = math.radians(30.0)
    threads: int = 0


@dataclass(frozen=True)
class VoxelizeSettings(VoxelSettings):
    """What `prefilter.voxelize` does.

    Attributes:
        output: A key of `OUTPUTS`.
        filepath: The OpenVDB file of a volume; empty for one beside the .blend file.
    """

    output: str = "mesh"
    filepath: str = ""


@dataclass(frozen=True)
class BooleanSettings(VoxelSettings):
    """What `prefilter.boolean` does.

    Attributes:
        operation: A key of `OPERATIONS`.
        operands: A key of `OPERANDS`: what becomes of the other objects.
    """

    operation: str = "difference"
    operands: str = "hide"
