// SPDX-License-Identifier: GPL-3.0-or-later

// Path data, as SVG writes them: lines, curves, and arcs of ellipses.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "prefilter/base/outline.h"

namespace prefilter {

/// Segments in a row, without an object for each. A letter says what one is, and its numbers are
/// the coordinates of the points behind the one where it begins: M moves, L is a line, Q and C are
/// Bezier curves, W a conic, whose weight is between its two points, and Z closes.
struct PathSteps {
  std::string letters;
  std::vector<double> numbers;
};

/// How many numbers follow a letter; -1 for one that is no segment's.
int number_count(char letter);

/// What reading a text came to.
enum class PathOutcome : std::uint8_t {
  kWhole,
  kBroken,   // up to an error
  kTooMany,  // segments
};

/// Appends what path data draw up to their first error: arcs become conics of a quarter or less
/// ("Conversion from endpoint to center parameterization" in the appendix of SVG 1.1, F.6.5). Ends
/// with kTooMany where there are more than `most` segments.
PathOutcome read_path_data(std::string_view text, std::size_t most, PathSteps* steps);

/// Appends the numbers that a text begins with, and returns whether it holds nothing else.
bool read_numbers(std::string_view text, std::vector<double>* numbers);

/// The smallest box around what the steps draw, where a move that draws nothing does not count;
/// empty without a point. The steps are those of whole segments, of weights above 0.
Box2 drawn_box(std::string_view letters, std::span<const double> numbers);

}  // namespace prefilter
