// SPDX-License-Identifier: GPL-3.0-or-later

// Refinement follows P. Liepa, Filling holes in meshes (2003). Fairing minimizes the integral of
// the squared mean curvature (Willmore energy), which spheres minimize among all surfaces with the
// same border and tangents, over the positions of the points. The mean curvature is the cotangent
// formula's; the tangents enter as a flux of the coordinates through the border, so the result does
// not depend on the triangles beyond it. In a fixed metric the energy is quadratic (M. Botsch, L.
// Kobbelt, An intuitive framework for real-time freeform modeling, 2004); its minimum is the
// initial value, and the same linear system preconditions descent along the exact gradient. it
// starts, and the same system then scales the steps along the exact gradient.
#include "prefilter/voxels/solid/fair_patch.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "prefilter/base/solve/sparse_factors.h"

namespace prefilter {
namespace {

constexpr std::size_t kMaxInteriorPoints = 20000;
// Increase of the target triangle size per unit of distance from the border; the first value that
// yields at most kMaxInteriorPoints is used.
constexpr std::array kSizeGrowths = {0.0, 0.05, 0.1, 0.2, 0.4, 0.8};
constexpr double kMaxTriangleSize = 0.1;   // upper limit of the size
constexpr double kCreaseCosine = 0.2588;   // 75 degrees
constexpr double kSimilarCosine = 0.7071;  // maximum angle, 45 degrees, between averaged normals
constexpr std::size_t kAveragedEdges = 3;  // edges on either side over which normals are averaged
constexpr std::size_t kAveragedAngles = 8;
constexpr int kFilmSteps = 3;
constexpr int kFilmRings = 8;
constexpr int kMaxDescentSteps = 16;
constexpr int kStepsPerMetric = 8;
constexpr double kMinRelativeGain = 1e-5;  // minimum decrease of the energy per step
// Maximum distance of a patch from the border's box, relative to the box's diagonal.
constexpr double kMaxBulge = 1.0;

Vector3 unit(const Vector3& v) {
  const double size = plain_length(v);
  return size > 0.0 ? (1.0 / size) * v : Vector3{};
}

// The patch, refined to the size of the border's edges, plus `growth` per distance from it; none if
// it has too many points.
std::optional<HolePatch> refined_patch(const HolePatch& whole, std::size_t border, double growth,
                                       const Run& run) {
  HolePatch patch = whole;
  std::vector<double> sizes(border);
  for (std::size_t i = 0; i < border; ++i) {
    const Vector3& p = patch.points()[i];
    sizes[i] = (plain_length(patch.points()[(i + 1) % border] - p) +
                plain_length(p - patch.points()[(i + border - 1) % border])) /
               2.0;
  }
  for (;;) {
    run.report(0.0);
    const auto count = static_cast<std::uint32_t>(patch.triangles().size());
    std::vector<std::uint32_t> changed;
    for (std::uint32_t t = 0; t < count; ++t) {
      const auto corners = patch.triangles()[t].corners;
      Vector3 middle{};
      for (const std::uint32_t c : corners) middle = middle + (1.0 / 3.0) * patch.points()[c];
      double size = growth > 0.0 ? kMaxTriangleSize : 0.0;
      for (const std::uint32_t c : corners) {
        if (growth > 0.0) {
          size = std::min(size, sizes[c] + growth * plain_length(patch.points()[c] - middle));
        } else {
          size += sizes[c] / 3.0;
        }
      }
      bool is_large = true;
      for (const std::uint32_t c : corners) {
        const double distance = std::sqrt(2.0) * plain_length(patch.points()[c] - middle);
        is_large = is_large && distance > size && distance > sizes[c];
      }
      if (!is_large) continue;
      changed.push_back(t);
      changed.push_back(static_cast<std::uint32_t>(patch.triangles().size()));
      changed.push_back(static_cast<std::uint32_t>(patch.triangles().size() + 1));
      patch.divide(t, middle);
      sizes.push_back(size);
      if (patch.points().size() > border + kMaxInteriorPoints && growth < kSizeGrowths.back())
        return {};
    }
    if (changed.empty()) return patch;
    patch.flip(changed, true, run.part(0.0, 0.0));
    patch.flip_all(true, run.part(0.0, 0.0));
  }
}

// The discrete curvature of a patch with fixed connectivity.
class Metric {
 public:
  // `clamped` holds for each border edge the unit direction in which the patch continues across it,
  // pointing out of the patch; zero at creases.
  Metric(const HolePatch& patch, std::span<const Vector3> clamped)
      : patch_(patch),
        border_(clamped.size()),
        flux_(clamped.size()),
        has_row_(patch.points().size(), 1) {
    for (std::size_t i = 0; i < border_; ++i) {
      const std::size_t next = (i + 1) % border_;
      const bool is_crease = dot(clamped[i], clamped[i]) == 0.0;
      const double half = plain_length(patch.points()[next] - patch.points()[i]) / 2.0;
      for (const std::size_t end : {i, next}) {
        flux_[end] = flux_[end] + half * clamped[i];
        if (is_crease) has_row_[end] = 0;
      }
    }
  }

  // Area gradients at points, which are the mean curvature normals times the points' areas.
  struct Curvature {
    std::vector<Vector3> normals;
    std::vector<double> areas;
    double energy = 0.0;
  };

  Curvature curvature(std::span<const Vector3> x) const {
    Curvature result{std::vector<Vector3>(x.size()), std::vector<double>(x.size(), 0.0), 0.0};
    for (const HolePatch::Triangle& triangle : patch_.triangles()) {
      const auto& corners = triangle.corners;
      const Vector3 doubled = cross(x[corners[1]] - x[corners[0]], x[corners[2]] - x[corners[0]]);
      const double size = plain_length(doubled);
      if (!(size > 0.0)) continue;
      const Vector3 normal = (1.0 / size) * doubled;
      for (int i = 0; i < 3; ++i) {
        const std::uint32_t own = corners[static_cast<std::size_t>(i)];
        const Vector3 across = x[corners[static_cast<std::size_t>(previous_corner(i))]] -
                               x[corners[static_cast<std::size_t>(next_corner(i))]];
        result.normals[own] = result.normals[own] + 0.5 * cross(normal, across);
        result.areas[own] += size / 6.0;
      }
    }
    for (std::size_t i = 0; i < border_; ++i) result.normals[i] = result.normals[i] - flux_[i];
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (has_row_[i] == 0 || !(result.areas[i] > 0.0)) {
        result.normals[i] = {};
        continue;
      }
      result.energy += dot(result.normals[i], result.normals[i]) / result.areas[i];
    }
    return result;
  }

  // Half the energy gradient, restricted to the points' normals.
  std::vector<Vector3> half_gradient(std::span<const Vector3> x, const Curvature& curvature) const {
    std::vector<Vector3> y(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (curvature.areas[i] > 0.0) y[i] = (1.0 / curvature.areas[i]) * curvature.normals[i];
    }
    std::vector<Vector3> gradient(x.size());
    std::vector<Vector3> normals(x.size());
    for (const HolePatch::Triangle& triangle : patch_.triangles()) {
      const auto& [a, b, c] = triangle.corners;
      const Vector3 ab = x[b] - x[a];
      const Vector3 ac = x[c] - x[a];
      const Vector3 doubled = cross(ab, ac);
      const double size = plain_length(doubled);
      if (!(size > 0.0)) continue;
      const Vector3 normal = (1.0 / size) * doubled;
      // Change of the area vector if all points move by y.
      const Vector3 change = cross(y[b] - y[a], ac) + cross(ab, y[c] - y[a]);
      const Vector3 turn = (1.0 / size) * (change - dot(normal, change) * normal);
      const double squares = (dot(y[a], y[a]) + dot(y[b], y[b]) + dot(y[c], y[c])) / 6.0;
      for (int i = 0; i < 3; ++i) {
        const std::uint32_t own = triangle.corners[static_cast<std::size_t>(i)];
        const std::uint32_t next = triangle.corners[static_cast<std::size_t>(next_corner(i))];
        const std::uint32_t last = triangle.corners[static_cast<std::size_t>(previous_corner(i))];
        const Vector3 across = x[last] - x[next];
        const Vector3 growth = 0.5 * cross(normal, across);
        const Vector3 bent = 0.5 * (cross(turn, across) + cross(normal, y[last] - y[next]));
        gradient[own] = gradient[own] + bent - squares * growth;
        normals[own] = normals[own] + doubled;
      }
    }
    for (std::size_t i = 0; i < x.size(); ++i) {
      const Vector3 normal = unit(normals[i]);
      gradient[i] = dot(normal, gradient[i]) * normal;
    }
    return gradient;
  }

  // Rows of the cotangent Laplacian: for each point, its neighbors and their weights, beginning
  // with the point itself.
  struct Row {
    std::vector<std::pair<std::uint32_t, double>> weights;
  };
  std::vector<Row> rows(std::span<const Vector3> x) const {
    std::vector<Row> result(x.size());
    for (std::uint32_t i = 0; i < x.size(); ++i) result[i].weights = {{i, 0.0}};
    const auto add = [&](std::uint32_t row, std::uint32_t column, double weight) {
      result[row].weights[0].second += weight;
      for (auto& [other, value] : result[row].weights) {
        if (other == column) {
          value -= weight;
          return;
        }
      }
      result[row].weights.emplace_back(column, -weight);
    };
    for (const HolePatch::Triangle& triangle : patch_.triangles()) {
      for (int i = 0; i < 3; ++i) {
        const std::uint32_t own = triangle.corners[static_cast<std::size_t>(i)];
        const std::uint32_t next = triangle.corners[static_cast<std::size_t>(next_corner(i))];
        const std::uint32_t last = triangle.corners[static_cast<std::size_t>(previous_corner(i))];
        const Vector3 u = x[next] - x[own];
        const Vector3 v = x[last] - x[own];
        const double size = plain_length(cross(u, v));
        if (!(size > 0.0)) continue;
        const double half_cotangent = 0.5 * dot(u, v) / size;
        add(next, last, half_cotangent);
        add(last, next, half_cotangent);
      }
    }
    return result;
  }

  std::size_t border() const { return border_; }
  std::span<const Vector3> flux() const { return flux_; }
  bool has_row(std::size_t i) const { return has_row_[i] != 0; }

 private:
  const HolePatch& patch_;
  std::size_t border_;
  std::vector<Vector3> flux_;
  std::vector<unsigned char> has_row_;
};

// Moves interior points to minimize the area, with fixed cotangent weights.
bool minimize_area(HolePatch* patch, std::size_t border, const Run& run) {
  const std::vector<Vector3> none(border);
  std::vector<Vector3> x(patch->points().begin(), patch->points().end());
  const std::vector<Metric::Row> rows = Metric(*patch, none).rows(x);
  std::vector<SparseEntry> entries;
  std::vector<Vector3> right(x.size() - border);
  for (std::size_t i = border; i < x.size(); ++i) {
    const auto own = static_cast<std::uint32_t>(i - border);
    for (const auto& [other, weight] : rows[i].weights) {
      if (other < border) {
        right[own] = right[own] - weight * x[other];
      } else if (other - border <= own) {
        entries.push_back({own, static_cast<std::uint32_t>(other - border), weight});
      }
    }
  }
  const SparseFactors factors(std::move(entries), std::span(x).subspan(border), run);
  if (!factors.is_definite()) return false;
  factors.solve(right);
  std::copy(right.begin(), right.end(), x.begin() + static_cast<std::ptrdiff_t>(border));
  patch->move_to(std::move(x));
  return true;
}

// The quadratic form of the energy in a fixed metric.
struct Plate {
  SparseFactors factors;
  std::vector<Vector3> right;  // for the interior points
};

Plate plate_of(const Metric& metric, std::span<const Vector3> x, const Run& run) {
  const std::size_t border = metric.border();
  const std::vector<Metric::Row> rows = metric.rows(x);
  const std::vector<double> areas = metric.curvature(x).areas;
  std::vector<SparseEntry> entries;
  std::vector<Vector3> right(x.size() - border);
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!metric.has_row(i) || !(areas[i] > 0.0)) continue;
    Vector3 known = i < border ? -1.0 * metric.flux()[i] : Vector3{};
    for (const auto& [other, weight] : rows[i].weights) {
      if (other < border) known = known + weight * x[other];
    }
    for (const auto& [a, weight] : rows[i].weights) {
      if (a < border) continue;
      right[a - border] = right[a - border] - (weight / areas[i]) * known;
      for (const auto& [b, other_weight] : rows[i].weights) {
        if (b < border || b > a) continue;
        entries.push_back({static_cast<std::uint32_t>(a - border),
                           static_cast<std::uint32_t>(b - border),
                           weight * other_weight / areas[i]});
      }
    }
  }
  return {SparseFactors(std::move(entries), x.subspan(border), run), std::move(right)};
}

// Weighted sums over nearby border edges with similar normals.
template <typename Value, typename Weighed>
std::vector<Value> averaged(std::span<const Vector3> normals, std::span<const double> lengths,
                            std::size_t most, const Weighed& weighed) {
  const std::size_t count = normals.size();
  const std::size_t reach = std::min(most, (count - 1) / 2);
  std::vector<Value> result(count);
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t k = 0; k < 2 * reach + 1; ++k) {
      const std::size_t j = (i + count + k - reach) % count;
      if (dot(normals[j], normals[i]) < kSimilarCosine) continue;
      result[i] = result[i] + weighed(j, lengths[j]);
    }
  }
  return result;
}

// For each border edge the direction in which the patch must continue; zero at creases.
std::vector<Vector3> continuation_directions(std::span<const Vector3> normals,
                                             const HolePatch& patch) {
  const std::size_t count = normals.size();
  const auto points = patch.points();
  std::vector<double> lengths(count);
  for (std::size_t i = 0; i < count; ++i) {
    lengths[i] = plain_length(points[(i + 1) % count] - points[i]);
  }
  // Averages the area-minimizing patch's normals over several rings, since it follows every tooth
  // of a jagged border.
  std::vector<Vector3> film(points.size());
  for (std::uint32_t t = 0; t < patch.triangles().size(); ++t) {
    const Vector3 normal = patch.normal(t);
    for (const std::uint32_t c : patch.triangles()[t].corners) film[c] = film[c] + normal;
  }
  for (int ring = 1; ring < kFilmRings; ++ring) {
    std::vector<Vector3> wider(points.size());
    for (const HolePatch::Triangle& triangle : patch.triangles()) {
      const auto& [a, b, c] = triangle.corners;
      const Vector3 sum = film[a] + film[b] + film[c];
      for (const std::uint32_t corner : triangle.corners) wider[corner] = wider[corner] + sum;
    }
    film = std::move(wider);
  }
  std::vector<Vector3> surface =
      averaged<Vector3>(normals, lengths, kAveragedEdges,
                        [&](std::size_t i, double length) { return length * normals[i]; });
  for (Vector3& normal : surface) normal = unit(normal);
  const auto cosines =
      averaged<double>(surface, lengths, kAveragedAngles, [&](std::size_t i, double length) {
        return length * (dot(surface[i], unit(film[i] + film[(i + 1) % count])) - kCreaseCosine);
      });
  std::vector<Vector3> result(count);
  for (std::size_t i = 0; i < count; ++i) {
    if (cosines[i] > 0.0) result[i] = unit(cross(points[(i + 1) % count] - points[i], surface[i]));
  }
  return result;
}

bool stays_near(std::span<const Vector3> x, std::size_t border) {
  Box box = kEmptyBox;
  for (std::size_t i = 0; i < border; ++i) box.include(x[i]);
  const double farthest = kMaxBulge * plain_length(box.high - box.low);
  // Written so that NaN fails the comparison.
  return std::all_of(x.begin(), x.end(), [&](const Vector3& p) {
    return box.squared_distance(p) <= farthest * farthest;
  });
}

// Moves interior points to minimize the bending energy; returns false on failure.
bool minimize_bending(std::span<const Vector3> clamped, HolePatch* patch, const Run& run) {
  const std::size_t border = clamped.size();
  const auto within = static_cast<std::ptrdiff_t>(border);
  {
    const Metric metric(*patch, clamped);
    std::vector<Vector3> x(patch->points().begin(), patch->points().end());
    Plate plate = plate_of(metric, x, run.part(0.0, 0.3));
    if (!plate.factors.is_definite()) return false;
    plate.factors.solve(plate.right);
    std::copy(plate.right.begin(), plate.right.end(), x.begin() + within);
    if (!stays_near(x, border)) return false;
    patch->move_to(std::move(x));
  }
  std::optional<Plate> plate;
  for (int step = 0; step < kMaxDescentSteps; ++step) {
    run.report(0.3 + 0.7 * step / kMaxDescentSteps);
    if (step % kStepsPerMetric == 0) {
      patch->flip_all(true, run.part(0.3, 0.3));
      plate = plate_of(Metric(*patch, clamped), patch->points(), run.part(0.3, 0.3));
      if (!plate->factors.is_definite()) return true;
    }
    const Metric metric(*patch, clamped);
    const auto x = patch->points();
    const Metric::Curvature before = metric.curvature(x);
    std::vector<Vector3> move = metric.half_gradient(x, before);
    plate->factors.solve(std::span(move).subspan(border));
    bool is_less = false;
    double gain = 0.0;
    for (double share = 1.0; share > 0.1 && !is_less; share /= 2.0) {
      std::vector<Vector3> moved(x.begin(), x.end());
      for (std::size_t i = border; i < moved.size(); ++i) {
        moved[i] = moved[i] - share * move[i];
      }
      const double energy = metric.curvature(moved).energy;
      is_less = energy < before.energy && stays_near(moved, border);
      gain = before.energy - energy;
      if (is_less) patch->move_to(std::move(moved));
    }
    if (!is_less || gain < kMinRelativeGain * before.energy) {
      if (step % kStepsPerMetric == 0) break;
      step += kStepsPerMetric - 1 - step % kStepsPerMetric;
    }
  }
  return true;
}

}  // namespace

void refine_patch(HolePatch* patch, const Run& run) {
  const std::size_t border = patch->points().size();
  for (const double growth : kSizeGrowths) {
    if (std::optional<HolePatch> refined = refined_patch(*patch, border, growth, run)) {
      *patch = std::move(*refined);
      break;
    }
  }
  run.report(1.0);
}

void fair_patch(std::span<const Vector3> normals, HolePatch* patch, const Run& run) {
  const std::size_t border = normals.size();
  if (patch->points().size() == border) return;
  for (int step = 0; step < kFilmSteps; ++step) {
    if (!minimize_area(patch, border, run.part(0.0, 0.2))) return;
    patch->flip_all(true, run.part(0.2, 0.2));
  }
  const std::vector<Vector3> clamped = continuation_directions(normals, *patch);
  const bool is_clamped =
      std::any_of(clamped.begin(), clamped.end(), [](const Vector3& v) { return dot(v, v) > 0.0; });
  if (!is_clamped) return;
  const HolePatch film = *patch;
  if (!minimize_bending(clamped, patch, run.part(0.2, 1.0))) *patch = film;
}

}  // namespace prefilter
