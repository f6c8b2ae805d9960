// SPDX-License-Identifier: GPL-3.0-or-later

#include "bench/shapes/reference.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace prefilter::bench {
namespace {

constexpr double kDeviation = 1e-7;  // of curves from their chords [pixels]

/// Each pixel holds the step of coverage from it on along its row.
class Differences {
 public:
  Differences(int width, int height)
      : width_(width), height_(height), sums_(static_cast<std::size_t>(width + 1) * height) {}

  void add_line(double x0, double y0, double x1, double y1) {
    if (y0 == y1) return;
    const double sign = y0 < y1 ? 1.0 : -1.0;
    if (y0 > y1) {
      std::swap(x0, x1);
      std::swap(y0, y1);
    }
    const double slope = (x1 - x0) / (y1 - y0);
    const int last = static_cast<int>(std::min<double>(height_, std::ceil(y1)));
    for (int row = static_cast<int>(std::max(0.0, std::floor(y0))); row < last; ++row) {
      const double low = std::max<double>(row, y0), high = std::min<double>(row + 1, y1);
      if (high > low) {
        add_in_row(row, x0 + (low - y0) * slope, x0 + (high - y0) * slope, sign * (high - low));
      }
    }
  }

  std::vector<double> coverage() const {
    std::vector<double> found;
    found.reserve(static_cast<std::size_t>(width_) * height_);
    for (int row = 0; row < height_; ++row) {
      double sum = 0.0;
      for (int x = 0; x < width_; ++x) {
        sum += sums_[static_cast<std::size_t>(row) * (width_ + 1) + x];
        found.push_back(std::abs(sum));
      }
    }
    return found;
  }

 private:
  /// The part of a row that is right of a line, which is `height` high within the row.
  void add_in_row(int row, double x0, double x1, double height) {
    if (x0 > x1) std::swap(x0, x1);
    if (x1 > x0) {
      const double left = std::clamp(-x0 / (x1 - x0), 0.0, 1.0);
      const double right = std::clamp((x1 - width_) / (x1 - x0), 0.0, 1.0);
      if (left > 0.0) sums_[static_cast<std::size_t>(row) * (width_ + 1)] += left * height;
      height *= std::max(0.0, 1.0 - left - right);
    }
    x0 = std::clamp<double>(x0, 0.0, width_);
    x1 = std::clamp<double>(x1, 0.0, width_);
    double* sums = sums_.data() + static_cast<std::size_t>(row) * (width_ + 1);
    const int first = std::min(width_ - 1, static_cast<int>(x0));
    const int last = std::clamp(static_cast<int>(std::ceil(x1)) - 1, first, width_ - 1);
    for (int x = first; x <= last; ++x) {
      const double low = std::max<double>(x, x0), high = std::min<double>(x + 1, x1);
      const double part = x1 > x0 ? height * (high - low) / (x1 - x0) : height;
      const double inside = x + 1 - (low + high) / 2;
      sums[x] += part * inside;
      sums[x + 1] += part * (1 - inside);
    }
  }

  int width_, height_;
  std::vector<double> sums_;
};

using Points = std::array<std::array<double, 2>, 4>;

std::array<double, 2> curve_point(const Points& points, int degree, double t) {
  Points p = points;
  for (int left = degree; left > 0; --left) {
    for (int i = 0; i < left; ++i) {
      for (int axis = 0; axis < 2; ++axis) {
        p[i][axis] = (1 - t) * p[i][axis] + t * p[i + 1][axis];
      }
    }
  }
  return p[0];
}

/// A chord of a curve over 1/n of its parameters is off by a bound of its second derivative / 8n^2.
int chord_count(const Points& points, int degree) {
  double bend = 0.0;
  for (int i = 0; i + 2 <= degree; ++i) {
    bend = std::max(bend, std::hypot(points[i][0] - 2 * points[i + 1][0] + points[i + 2][0],
                                     points[i][1] - 2 * points[i + 1][1] + points[i + 2][1]));
  }
  return 1 + static_cast<int>(std::sqrt(degree * (degree - 1) * bend / (8 * kDeviation)));
}

}  // namespace

std::vector<double> true_coverage(const Pattern& pattern) {
  Differences differences(pattern.width, pattern.height);
  const double* p = pattern.path.points.data();
  std::array<double, 2> start{}, at{};
  for (const Verb verb : pattern.path.verbs) {
    const int degree = point_count(verb);
    if (verb == Verb::kMove) {
      start = at = {p[0], p[1]};
    } else if (verb == Verb::kClose) {
      differences.add_line(at[0], at[1], start[0], start[1]);
      at = start;
    } else {
      Points points{at};
      for (int i = 0; i < degree; ++i) points[i + 1] = {p[2 * i], p[2 * i + 1]};
      const int count = chord_count(points, degree);
      for (int chord = 1; chord <= count; ++chord) {
        const auto next =
            chord == count ? points[degree] : curve_point(points, degree, chord / double(count));
        differences.add_line(at[0], at[1], next[0], next[1]);
        at = next;
      }
    }
    p += 2 * degree;
  }
  return differences.coverage();
}

Errors errors(const std::vector<float>& coverage, const std::vector<double>& truth) {
  double largest = 0.0, squares = 0.0;
  std::size_t count = 0;
  for (std::size_t pixel = 0; pixel < truth.size(); ++pixel) {
    const double error = std::abs(coverage[pixel] - truth[pixel]);
    largest = std::max(largest, error);
    if (truth[pixel] > 1e-9 && truth[pixel] < 1 - 1e-9) {
      squares += error * error;
      ++count;
    }
  }
  return {largest, count == 0 ? 0.0 : std::sqrt(squares / static_cast<double>(count))};
}

}  // namespace prefilter::bench
