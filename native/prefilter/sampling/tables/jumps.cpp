// SPDX-License-Identifier: GPL-3.0-or-later

// Compares the weights of samples on both sides of each border.
#include "prefilter/sampling/jumps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <tuple>
#include <utility>
#include <vector>

#include "prefilter/base/elementary.h"
#include "prefilter/images/kernel.h"
#include "prefilter/sampling/tables/subdomain.h"

namespace prefilter {
namespace {

constexpr double kBorderOffset = 1e-6;  // of a cell: distance of the points tested on both sides
// Midpoint rule: points per cell along an axis. The edges of boxes lie between them.
constexpr int kPointsPerCell = 32;

struct Point {
  double x;
  double y;
};
using Quad = std::array<Point, 4>;  // counterclockwise; the last two are equal for a triangle

Point between(const Point& a, const Point& b, double t) {
  return {a.x + (b.x - a.x) * t, a.y + (b.y - a.y) * t};
}
Point inside(const Quad& quad, double u, double v) {
  return between(between(quad[0], quad[1], u), between(quad[3], quad[2], u), v);
}

// A subdomain, placed in a plane whose unit is the base cell.
struct Piece {
  const TableSection* section;
  int index;
  int finer;   // level of its cell below the base cell's: 0 or 1
  int cell_x;  // in units of cells
  int cell_y;
  FoldedPlace fold;  // the symmetry from the plane to the subdomain
};

using Weights = std::map<std::tuple<int, int, int>, double>;  // by finer, x, y of a texel

class Borders {
 public:
  // `samples` is how many of the image there are along the base cell, or 0 for the plane.
  // `samples` is the number of image texels along the base cell, or 0 for the continuous plane.
  Borders(const SamplingTable& table, int samples)
      : shape_(table.shape), kernel_(*find_kernel(table.shape.filter)), samples_(samples) {}

  // Largest jump across the sides of a section's subdomains and between slices.
  double within(const TableSection& section);

  // Largest jump where the cell's level changes from that of `fine` to that of `coarse`, the base
  // cell's.
  double between_levels(const TableSection& fine, const TableSection& coarse);

 private:
  Piece piece_at(const TableSection& section, int finer, const Point& point, double f) const;
  Quad quad_of(const TableSection& section, int index) const;
  void add(const Piece& piece, const Point& point, double f, double sign, Weights* weights) const;
  double step(const Weights& difference);
  const std::vector<double>& profile(int finer, int i, int* first);
  // Number of test points of a border along each of its dimensions. Norms of linear functions are
  // largest at corners, so these suffice for degree 1.
  int points_along(const TableSection& section) const {
    return shape_.degree == 1 && section.levels > 1 ? 2 : 5;
  }

  const TableShape& shape_;
  const Kernel& kernel_;
  int samples_;
  std::map<std::pair<int, int>, std::pair<int, std::vector<double>>> profiles_;
};

Piece Borders::piece_at(const TableSection& section, int finer, const Point& point,
                        double f) const {
  const double x = std::ldexp(point.x, finer);
  const double y = std::ldexp(point.y, finer);
  const FoldedPlace fold = fold_place(x - std::floor(x), y - std::floor(y));
  return {&section,
          subdomain_of(shape_, section, fold.x, fold.y, f),
          finer,
          static_cast<int>(std::floor(x)),
          static_cast<int>(std::floor(y)),
          fold};
}

Quad Borders::quad_of(const TableSection& section, int index) const {
  const Subdomain subdomain(shape_, section, index);
  const double left = subdomain.x_low();
  const double right = subdomain.x_high();
  const double low = subdomain.y_low();
  const double high = subdomain.y_high();
  const Point last = left == low ? Point{right, high} : Point{left, high};
  return {{{left, low}, {right, low}, {right, high}, last}};
}

// Adds the weights of a piece's texels for a sample; levels are relative to the base cell's.
void Borders::add(const Piece& piece, const Point& point, double f, double sign,
                  Weights* weights) const {
  double x = std::ldexp(point.x, piece.finer) - piece.cell_x;
  double y = std::ldexp(point.y, piece.finer) - piece.cell_y;
  if (piece.fold.mirror_x) x = 1.0 - x;
  if (piece.fold.mirror_y) y = 1.0 - y;
  if (piece.fold.swapped) std::swap(x, y);
  const auto terms = static_cast<std::size_t>(shape_.terms());
  for (int i = 0; i < shape_.texels; ++i) {
    const std::size_t number = static_cast<std::size_t>(piece.index) * shape_.texels + i;
    const TexelOffset texel = unfold(piece.section->texels[number], piece.fold);
    const double weight = weight_at(piece.section->coefficients.data() + number * terms,
                                    shape_.degree, x, y, piece.section->levels == 1 ? x * y : f);
    (*weights)[{texel.finer + piece.finer, texel.x + (piece.cell_x << texel.finer),
                texel.y + (piece.cell_y << texel.finer)}] += sign * weight;
  }
}

// The weights of a texel's filter at the samples along an axis, from sample *first on.
const std::vector<double>& Borders::profile(int finer, int i, int* first) {
  const auto [place, is_new] = profiles_.try_emplace({finer, i});
  auto& [begin, values] = place->second;
  if (is_new) {
    const double width = std::ldexp(1.0, -finer);
    const double center = (i + 0.5) * width;
    if (samples_ > 0) {
      Taps taps = kernel_taps(kernel_, center * samples_, width * samples_);
      begin = taps.first;
      values = std::move(taps.weights);
    } else {
      const double reach = kernel_.radius() * width;
      begin = static_cast<int>(std::floor((center - reach) * kPointsPerCell));
      const int end = static_cast<int>(std::ceil((center + reach) * kPointsPerCell));
      for (int k = begin; k < end; ++k) {
        const double x = (k + 0.5) / kPointsPerCell;
        values.push_back(kernel_.value((x - center) / width) / (width * kPointsPerCell));
      }
    }
  }
  *first = begin;
  return values;
}

// The jump for weights that sum to 0: largest for the image that is 1 where the sum of their
// filters is positive, and 0 elsewhere.
double Borders::step(const Weights& difference) {
  struct Term {
    const std::vector<double>* along_x;
    const std::vector<double>* along_y;
    int x;
    int y;
    double weight;
  };
  std::vector<Term> terms;
  int left = 0;
  int right = 0;
  int low = 0;
  int high = 0;
  for (const auto& [texel, weight] : difference) {
    if (weight == 0.0) continue;
    const auto [finer, i, j] = texel;
    Term term{nullptr, nullptr, 0, 0, weight};
    term.along_x = &profile(finer, i, &term.x);
    term.along_y = &profile(finer, j, &term.y);
    left = std::min(left, term.x);
    low = std::min(low, term.y);
    right = std::max(right, term.x + static_cast<int>(term.along_x->size()));
    high = std::max(high, term.y + static_cast<int>(term.along_y->size()));
    terms.push_back(term);
  }
  const auto width = static_cast<std::size_t>(right - left);
  std::vector<double> plane(width * static_cast<std::size_t>(high - low));
  for (const Term& term : terms) {
    for (std::size_t j = 0; j < term.along_y->size(); ++j) {
      const double factor = term.weight * (*term.along_y)[j];
      double* const row = plane.data() + (term.y - low + j) * width + (term.x - left);
      for (std::size_t i = 0; i < term.along_x->size(); ++i) row[i] += factor * (*term.along_x)[i];
    }
  }
  double norm = 0.0;
  for (const double value : plane) norm += std::abs(value);
  return 0.5 * norm;
}

double Borders::within(const TableSection& section) {
  double largest = 0.0;
  const int points = points_along(section);
  const auto at = [&](int k) { return static_cast<double>(k) / (points - 1); };
  const int subdomains = section.slices * shape_.subdomains_of_slice();
  for (int index = 0; index < subdomains; ++index) {
    const Subdomain subdomain(shape_, section, index);
    const Quad quad = quad_of(section, index);
    const Piece own =
        piece_at(section, 0, inside(quad, 0.5, 0.25), subdomain.f_low() + kBorderOffset);
    const auto look = [&](const Piece& other, const Point& point, double f) {
      Weights difference;
      add(own, point, f, 1.0, &difference);
      add(other, point, f, -1.0, &difference);
      largest = std::max(largest, step(difference));
    };
    for (int side = 0; side < 4; ++side) {
      const Point& a = quad[side];
      const Point& b = quad[(side + 1) % 4];
      const double length = elementary::hypot(b.x - a.x, b.y - a.y);
      if (length == 0.0) continue;
      const Point middle = between(a, b, 0.5);
      const Point beyond{middle.x + (b.y - a.y) / length * kBorderOffset,
                         middle.y - (b.x - a.x) / length * kBorderOffset};
      const Piece other = piece_at(section, 0, beyond, subdomain.f_low() + kBorderOffset);
      for (int k = 0; k < points; ++k) {
        for (int l = 0; l < (section.levels == 1 ? 1 : points); ++l) {
          look(other, between(a, b, at(k)),
               subdomain.f_low() + (subdomain.f_high() - subdomain.f_low()) * at(l));
        }
      }
    }
    Piece above = own;
    above.index += shape_.subdomains_of_slice();
    if (above.index >= subdomains) continue;
    for (int k = 0; k < points; ++k) {
      for (int l = 0; l < points; ++l) look(above, inside(quad, at(k), at(l)), subdomain.f_high());
    }
  }
  return largest;
}

double Borders::between_levels(const TableSection& fine, const TableSection& coarse) {
  double largest = 0.0;
  const int points = points_along(fine);
  const int of_slice = shape_.subdomains_of_slice();
  for (int number = 0; number < of_slice; ++number) {
    const Quad folded = quad_of(fine, (fine.slices - 1) * of_slice + number);
    for (int symmetry = 0; symmetry < 8; ++symmetry) {
      Quad quad = folded;  // in the base cell, whose first quarter is the fine cell
      for (Point& point : quad) {
        if ((symmetry & 1) != 0) std::swap(point.x, point.y);
        if ((symmetry & 2) != 0) point.x = 1.0 - point.x;
        if ((symmetry & 4) != 0) point.y = 1.0 - point.y;
        point = {0.5 * point.x, 0.5 * point.y};
      }
      const Point middle = inside(quad, 0.5, 0.25);
      const Piece of_fine = piece_at(fine, 1, middle, 1.0);
      const Piece of_coarse = piece_at(coarse, 0, middle, 0.0);
      for (int k = 0; k < points; ++k) {
        for (int l = 0; l < points; ++l) {
          const double u = static_cast<double>(k) / (points - 1);
          const double v = static_cast<double>(l) / (points - 1);
          Weights difference;
          add(of_fine, inside(quad, u, v), 1.0, 1.0, &difference);
          add(of_coarse, inside(quad, u, v), 0.0, -1.0, &difference);
          largest = std::max(largest, step(difference));
        }
      }
    }
  }
  return largest;
}

}  // namespace

double largest_jump(const SamplingTable& table, int levels) {
  const TableSection& section = table.section(levels);
  const TableSection& coarser = table.section(std::min(levels + 1, 3));
  // If there are few levels, a cell is as many image texels wide as there are levels.
  const bool has_image = levels < 3;
  Borders within(table, has_image ? levels : 0);
  Borders between(table, has_image ? 2 * levels : 0);
  return std::max(within.within(section), between.between_levels(section, coarser));
}

}  // namespace prefilter
