# SPDX-License-Identifier: GPL-3.0-or-later

"""Real scans of public repositories: where each is, under which terms, and how it becomes a set.

Nothing of them is part of the project. The folder that PREFILTER_SCAN_CLONES names has a clone of
each repository, called OWNER+NAME. Files .las and .laz need laspy and lazrs, .e57 pye57.
"""

import os
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import prefilter

from bench.points.scans import merged
from bench.points.sets import Cloud

CLONES = "PREFILTER_SCAN_CLONES"
UP = "up"  # Normals of scans from the air.
PCL, PDAL = "PointCloudLibrary/data", "PDAL/PDAL"
SCAN_MATCHING = "thegyro/Project4-Scan-Matching"


@dataclass(frozen=True)
class Fetched:
    """A scan in a repository.

    Attributes:
        repository: OWNER/NAME.
        path: Of its file there; a .conf file names others.
        terms: The licence.
        what: Its subject.
        is_open: It is not of a thing seen from all sides.
        toward: Where normals point that the file does not have: to the viewpoint if it has one,
            `UP`, or outward.
    """

    repository: str
    path: str
    terms: str
    what: str
    is_open: bool = True
    toward: str = ""


STANFORD = "Stanford: credit, no commercial use"
FETCHED: dict[str, Fetched] = {
    "happy_scans": Fetched(
        SCAN_MATCHING,
        "data/happy_stand/happyStandRight.conf",
        STANFORD,
        "happy Buddha, 15 range scans",
        is_open=False,
    ),
    "lone_star": Fetched(
        PDAL, "test/data/ept/source/lone-star.laz", "BSD", "a geyser, scanned from the ground"
    ),
    "autzen": Fetched(
        PDAL, "test/data/las/autzen_trim.las", "BSD", "a stadium from the air", toward=UP
    ),
    "room": Fetched(PCL, "tutorials/room_scan1.pcd", "BSD", "a room, from within"),
    "capture": Fetched(PCL, "tutorials/pairwise/capture0001.pcd", "BSD", "a depth image"),
    "person": Fetched(PCL, "tutorials/template_alignment/person.pcd", "BSD", "a depth image"),
    "mug": Fetched(
        PCL, "tutorials/table_scene_mug_stereo_textured.pcd", "BSD", "a table, by stereo"
    ),
    "walls": Fetched(PCL, "tutorials/region_growing_tutorial.pcd", "BSD", "walls, from within"),
    "site": Fetched(PCL, "terrain/CSite1_red1-utm.pcd", "BSD", "a town from the air", toward=UP),
    "forest": Fetched(PCL, "terrain/FSite8_orig-utm.pcd", "BSD", "hills from the air", toward=UP),
    "shapes": Fetched(PCL, "tutorials/rops_tutorial/points.pcd", "BSD", "a figure", is_open=False),
    "indoor": Fetched(
        "uber-common/deck.gl-data",
        "examples/point-cloud-laz/indoor.0.1.laz",
        "MIT",
        "rooms, by a scanner that was carried",
    ),
    "lucy": Fetched(
        "uber-common/deck.gl-data",
        "examples/point-cloud-ply/lucy100k.ply",
        STANFORD,
        "a statue",
        is_open=False,
    ),
    "bunny_e57": Fetched(
        "asmaloney/libE57Format-test-data",
        "reference/bunnyDouble.e57",
        "libE57's: free with credit",
        "bunny without normals",
        is_open=False,
    ),
}


def cloud(name: str) -> Cloud:
    """Reads one."""
    found = FETCHED[name]
    path = Path(os.environ[CLONES]) / found.repository.replace("/", "+") / found.path
    if path.suffix == ".conf":
        return merged(path)
    scan = prefilter.read_points(path)
    whole = np.isfinite(scan.positions).all(axis=1)
    points = np.asarray(scan.positions[whole], np.float64)
    points -= np.round((points.min(axis=0) + points.max(axis=0)) / 2)  # Floats hold no survey.
    if scan.normals is not None:
        return points, np.asarray(scan.normals[whole], np.float32)
    viewpoint = scan.viewpoint
    if viewpoint is not None and np.ndim(viewpoint) == 2:
        viewpoint = viewpoint[whole]
    if viewpoint is not None:
        middle = (scan.positions[whole].min(axis=0) + scan.positions[whole].max(axis=0)) / 2
        viewpoint = viewpoint - np.round(middle)
    normals = prefilter.estimate_normals(points, viewpoint=viewpoint)
    if found.toward == UP:
        normals *= np.where(normals[:, 2:] < 0, -1, 1)
    return points, normals.astype(np.float32)
