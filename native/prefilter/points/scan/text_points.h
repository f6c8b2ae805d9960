// SPDX-License-Identifier: GPL-3.0-or-later

// Points as lines of numbers: XYZ, PTS and CSV.
#pragma once

#include <memory>
#include <string>

#include "prefilter/points/point_source.h"

namespace prefilter {

/// Opens a text file with a line "x y z ..." per point, separated by blanks, commas or semicolons;
/// "#" or "//" starts a comment. Further columns are interpreted by their number and by the first
/// thousands of lines: a triple is a color if its values are integers, not negative and not all 0
/// or 1, otherwise a normal; a single column is the intensity, before the triples (as in PTS) or
/// after. All others are attributes, such as "value7" for the seventh column. The first line, or a
/// comment there, may name the columns instead. Commas are decimal if the first lines have another
/// separator and no decimal points. A line with one number, as in PTS, gives the count of points
/// that follow. Throws Error for files in another format; lines with a different number of values,
/// and wrong counts, are reported on reading.
std::unique_ptr<PointSource> open_text_points(const std::string& path);

}  // namespace prefilter
