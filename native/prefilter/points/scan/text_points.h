// SPDX-License-Identifier: GPL-3.0-or-later

// Points as lines of numbers: XYZ and PTS.
#pragma once

#include <memory>
#include <string>

#include "prefilter/points/point_source.h"

namespace prefilter {

/// A line for each point: x y z and what more there is, separated by blanks, commas or semicolons;
/// "#" or "//" begins a comment. What follows x y z is told by how many numbers there are, and by
/// those of the first thousands of lines: three are a color where they are whole, none is negative
/// and not all are 0 or 1, else a normal; a single one is the intensity, before them (as in PTS)
/// or after. All others are attributes, "value7" in the seventh column. The first line, or a
/// comment there, may name the columns instead. Commas are decimal ones where the first lines have
/// something else between numbers, and no points in them. A line of one number, as PTS files have,
/// says how many points follow. Throws Error for what is no such file; a line with more or fewer
/// numbers than the first, and points that are not as many as was said, are found when they are
/// read.
std::unique_ptr<PointSource> open_text_points(const std::string& path);

}  // namespace prefilter
