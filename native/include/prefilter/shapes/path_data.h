// SPDX-License-Identifier: GPL-3.0-or-later

// SVG path data: lines, curves and elliptical arcs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "prefilter/base/outline.h"

namespace prefilter {

/// Consecutive path segments in a compact form. A letter gives the kind of a segment, and its
/// numbers are the coordinates of its points after the current one: M moves, L is a line, Q and C
/// are Bezier curves, W is a conic, whose weight is between its two points, and Z closes the
/// contour.
struct PathSteps {
  std::string letters;
  std::vector<double> numbers;
};

/// Number of numbers that follow a letter; -1 for an unknown letter.
int number_count(char letter);

/// How reading path data ended.
enum class PathOutcome : std::uint8_t {
  kWhole,
  kBroken,   // read up to an error
  kTooMany,  // exceeded the limit of segments
};

/// Appends the segments of path data up to their first error. Arcs become conics of at most a
/// quarter ellipse ("Conversion from endpoint to center parameterization", SVG 1.1, F.6.5). Stops
/// with kTooMany above `most` segments.
PathOutcome read_path_data(std::string_view text, std::size_t most, PathSteps* steps);

/// Appends the leading numbers of a text. Returns whether the text contains nothing else.
bool read_numbers(std::string_view text, std::vector<double>* numbers);

/// Smallest box around the drawn steps, ignoring moves that draw nothing; empty without a point.
/// The steps must be complete, with weights above 0.
Box2 drawn_box(std::string_view letters, std::span<const double> numbers);

}  // namespace prefilter
