// SPDX-License-Identifier: GPL-3.0-or-later

#include "bench/shapes/patterns.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace prefilter::bench {
namespace {

constexpr double kPi = std::numbers::pi;
// The control points of four cubics around a unit circle, which they leave by 2.7e-4 at most.
constexpr double kQuarter = 0.5522847498307936;

/// Adds an ellipse of four cubics, clockwise where `turn` is -1.
void add_ellipse(Path& path, double x, double y, double radius_x, double radius_y, int turn) {
  const auto at = [&](double u, double v) {
    return std::pair(x + radius_x * u, y + radius_y * turn * v);
  };
  double u = 1.0, v = 0.0;
  path.move_to(x + radius_x, y);
  for (int quarter = 0; quarter < 4; ++quarter) {
    const double next_u = -v, next_v = u;
    const auto [x1, y1] = at(u + kQuarter * next_u, v + kQuarter * next_v);
    const auto [x2, y2] = at(next_u + kQuarter * u, next_v + kQuarter * v);
    const auto [x3, y3] = at(next_u, next_v);
    path.cubic_to(x1, y1, x2, y2, x3, y3);
    u = next_u;
    v = next_v;
  }
  path.close();
}

/// Goes along two quadratic curves from one angle to another around the origin.
void add_arc(Path& path, double radius, double from, double to) {
  const double half = (to - from) / 2;
  for (int part = 0; part < 2; ++part) {
    const double middle = from + (part + 0.5) * half, end = from + (part + 1) * half;
    const double control = radius / std::cos(half / 2);
    path.quadratic_to(control * std::cos(middle), control * std::sin(middle),
                      radius * std::cos(end), radius * std::sin(end));
  }
}

}  // namespace

int point_count(Verb verb) {
  return verb == Verb::kClose ? 0 : std::max(1, static_cast<int>(verb));
}

void Path::move_to(double x, double y) {
  verbs.push_back(Verb::kMove);
  points.insert(points.end(), {x, y});
}

void Path::line_to(double x, double y) {
  verbs.push_back(Verb::kLine);
  points.insert(points.end(), {x, y});
}

void Path::quadratic_to(double x1, double y1, double x2, double y2) {
  verbs.push_back(Verb::kQuadratic);
  points.insert(points.end(), {x1, y1, x2, y2});
}

void Path::cubic_to(double x1, double y1, double x2, double y2, double x3, double y3) {
  verbs.push_back(Verb::kCubic);
  points.insert(points.end(), {x1, y1, x2, y2, x3, y3});
}

void Path::close() { verbs.push_back(Verb::kClose); }

Pattern fan() {
  constexpr int kSize = 128, kQuads = 256;
  constexpr double kNear = 4.0, kFar = 0.5;  // pixels from a line to the next
  Pattern pattern{"fan", kSize, kSize, {}, false, 1};
  for (int quad = 0; quad < kQuads; ++quad) {
    const double left = quad - kQuads / 2, right = left + 0.5;
    pattern.path.move_to(kSize / 2 + kNear * left, 0.0);
    pattern.path.line_to(kSize / 2 + kNear * right, 0.0);
    pattern.path.line_to(kSize / 2 + kFar * right, kSize);
    pattern.path.line_to(kSize / 2 + kFar * left, kSize);
    pattern.path.close();
  }
  return pattern;
}

Pattern star() {
  constexpr int kSize = 64, kTriangles = 32;
  constexpr double kCenter = kSize / 2.0, kRadius = 31.0;
  Pattern pattern{"star", kSize, kSize, {}, false, 1};
  for (int triangle = 0; triangle < kTriangles; ++triangle) {
    pattern.path.move_to(kCenter, kCenter);
    for (const double side : {-0.25, 0.25}) {
      const double angle = 2 * kPi * (triangle + side) / kTriangles;
      pattern.path.line_to(kCenter + kRadius * std::cos(angle),
                           kCenter + kRadius * std::sin(angle));
    }
    pattern.path.close();
  }
  return pattern;
}

Pattern rings() {
  constexpr int kSize = 64, kRings = 32;
  Pattern pattern{"rings", kSize, kSize, {}, true, 1};
  for (int ring = 0; ring < kRings; ++ring) {
    const double inner = kSize * std::sqrt((2 * ring + 1) / (2.0 * kRings));
    const double outer = kSize * std::sqrt((2 * ring + 2) / (2.0 * kRings));
    pattern.path.move_to(outer, 0.0);
    add_arc(pattern.path, outer, 0.0, kPi / 2);
    pattern.path.line_to(0.0, inner);
    add_arc(pattern.path, inner, kPi / 2, 0.0);
    pattern.path.close();
  }
  return pattern;
}

Pattern glyphs() {
  constexpr int kSize = 1024, kGlyphs = 3390, kColumns = 58;
  constexpr double kAdvance = kSize / static_cast<double>(kColumns);
  constexpr double kLine = kSize / std::ceil(kGlyphs / static_cast<double>(kColumns));
  Pattern pattern{"glyphs", kSize, kSize, {}, true, 2};
  for (int glyph = 0; glyph < kGlyphs; ++glyph) {
    const double x = (glyph % kColumns + 0.5) * kAdvance, y = (glyph / kColumns + 0.5) * kLine;
    add_ellipse(pattern.path, x, y, 0.42 * kAdvance, 0.45 * kLine, 1);
    add_ellipse(pattern.path, x, y, 0.24 * kAdvance, 0.36 * kLine, -1);
  }
  return pattern;
}

Pattern circle() {
  constexpr int kSize = 1024, kVertices = 1'000'000;
  constexpr double kCenter = kSize / 2.0, kRadius = 500.0;
  Pattern pattern{"circle", kSize, kSize, {}, false, 1};
  for (int vertex = 0; vertex < kVertices; ++vertex) {
    const double angle = 2 * kPi * vertex / kVertices;
    const double x = kCenter + kRadius * std::cos(angle), y = kCenter + kRadius * std::sin(angle);
    if (vertex == 0) {
      pattern.path.move_to(x, y);
    } else {
      pattern.path.line_to(x, y);
    }
  }
  pattern.path.close();
  return pattern;
}

Pattern disc() {
  constexpr int kSize = 4096;
  Pattern pattern{"disc", kSize, kSize, {}, true, 1};
  add_ellipse(pattern.path, kSize / 2.0, kSize / 2.0, 2000.0, 2000.0, 1);
  return pattern;
}

std::vector<Pattern> patterns(const std::vector<std::string>& names) {
  std::vector<Pattern> made = {fan(), star(), rings(), glyphs(), circle(), disc()};
  if (names.empty()) return made;
  std::erase_if(made, [&](const Pattern& pattern) {
    return std::find(names.begin(), names.end(), pattern.name) == names.end();
  });
  return made;
}

Pattern abutting_quads() {
  constexpr int kSize = 64, kQuads = 64;
  const auto lean = [](int edge) { return edge > 0 && edge < kQuads ? 1.0 : 0.0; };
  Pattern pattern{"abutting", kSize, kSize, {}, false, 1};
  for (int quad = 0; quad < kQuads; ++quad) {
    pattern.path.move_to(quad, 0.0);
    pattern.path.line_to(quad + 1, 0.0);
    pattern.path.line_to(quad + 1 + lean(quad + 1), kSize);
    pattern.path.line_to(quad + lean(quad), kSize);
    pattern.path.close();
  }
  return pattern;
}

std::vector<Path> contours(const Path& path) {
  std::vector<Path> found;
  const double* p = path.points.data();
  for (const Verb verb : path.verbs) {
    if (verb == Verb::kMove) found.emplace_back();
    found.back().verbs.push_back(verb);
    const int count = 2 * point_count(verb);
    found.back().points.insert(found.back().points.end(), p, p + count);
    p += count;
  }
  return found;
}

}  // namespace prefilter::bench
