// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/contour/height_crossing.h"

#include <cmath>

#include "prefilter/voxels/contour/height_patch.h"
#include "prefilter/wavelet/column_height.h"

namespace prefilter {
namespace {

constexpr float kSlack = 0.05F;
// Maximum difference of heights in cells; larger ones indicate an edge.
constexpr float kMostCurved = 0.5F;
// The same for nine columns, and their maximum deviation from a quadratic.
constexpr double kMostCurvedAround = 0.4;
constexpr double kMostOffAround = 0.02;

// `up` is the stride toward the empty end.
std::optional<float> height_at(const float* cell, std::ptrdiff_t up) {
  return column_height([&](int step) { return cell[step * up]; });
}

struct Profile {
  float slope = 0.0F;
  float curvature = 0.0F;
  bool has_slope = false;
};

// Slope and curvature along one axis across the columns.
Profile profile(const float* cell, std::ptrdiff_t across, std::ptrdiff_t up, float height) {
  const std::optional<float> low = height_at(cell - across, up);
  const std::optional<float> high = height_at(cell + across, up);
  Profile result;
  if (!low || !high) return result;  // A one-sided slope would be off by half the curvature.
  result.slope = (*high - *low) / 2.0F;
  result.curvature = *high - 2.0F * height + *low;
  result.has_slope = true;
  return result;
}

// The axis along which the occupancies around the two cells change most.
int steepest_axis(const float* cell, const float* neighbor,
                  const std::array<std::ptrdiff_t, 3>& strides, float* change) {
  int steepest = 0;
  float most = -1.0F;
  for (int axis = 0; axis < 3; ++axis) {
    const std::ptrdiff_t step = strides[axis];
    float difference = 0.0F;
    for (const float* center : {cell, neighbor}) {
      difference += 2.0F * (center[step] - center[-step]);
      for (int across = 0; across < 3; ++across) {
        if (across == axis) continue;
        const std::ptrdiff_t side = strides[across];
        difference += center[side + step] - center[side - step];
        difference += center[step - side] - center[-step - side];
      }
    }
    if (std::abs(difference) > most) {
      most = std::abs(difference);
      steepest = axis;
      *change = difference;
    }
  }
  return steepest;
}

// The surface over a cell: its height over the center, and profiles along both axes.
struct LocalSurface {
  float height;
  Profile first;
  Profile second;
};

std::optional<LocalSurface> surface_over(const float* cell, std::ptrdiff_t up,
                                         const std::array<std::ptrdiff_t, 2>& across) {
  const std::optional<float> height = height_at(cell, up);
  if (!height) return std::nullopt;
  const Profile first = profile(cell, across[0], up, *height);
  const Profile second = profile(cell, across[1], up, *height);
  // Converts the mean over the column to the height at its center.
  const float at_center = *height - (first.curvature + second.curvature) / 24.0F - 0.5F;
  return LocalSurface{at_center, first, second};
}

// The crossing seen from one of the cells; `along` is the stride to the other one.
std::optional<float> crossing_from(const float* cell, std::ptrdiff_t along, std::ptrdiff_t up,
                                   const std::array<std::ptrdiff_t, 2>& across) {
  const std::optional<LocalSurface> surface = surface_over(cell, up, across);
  if (!surface) return std::nullopt;
  const float at_center = surface->height;
  if (along == up) return at_center;
  if (along == -up) return -at_center;
  const bool is_first = along == across[0] || along == -across[0];
  const Profile& profile_along = is_first ? surface->first : surface->second;
  if (!profile_along.has_slope) return std::nullopt;
  const bool is_forward = along == across[0] || along == across[1];
  const float slope = is_forward ? profile_along.slope : -profile_along.slope;
  const float curvature = profile_along.curvature;
  // Solves at_center + slope t + curvature t^2 / 2 = 0 for the root near the linear solution.
  if (slope == 0.0F) return std::nullopt;
  float t = -at_center / slope;
  for (int i = 0; i < 3; ++i) {
    const float derivative = slope + curvature * t;
    if (std::abs(derivative) < 0.25F * std::abs(slope)) return -at_center / slope;
    t -= (at_center + slope * t + 0.5F * curvature * t * t) / derivative;
  }
  return t;
}

// Whether the heights of the nine columns around a cell form a smooth surface.
bool is_smooth_around(const float* cell, std::ptrdiff_t up,
                      const std::array<std::ptrdiff_t, 2>& across) {
  std::array<std::array<double, 3>, 3> heights;
  for (std::ptrdiff_t i = -1; i <= 1; ++i) {
    for (std::ptrdiff_t j = -1; j <= 1; ++j) {
      const std::optional<float> height = height_at(cell + i * across[0] + j * across[1], up);
      if (!height) return false;
      heights[static_cast<std::size_t>(i + 1)][static_cast<std::size_t>(j + 1)] =
          static_cast<double>(*height);
    }
  }
  HeightPatch patch;
  return fit_heights(heights, &patch, kMostCurvedAround, kMostOffAround);
}
}  // namespace

std::optional<float> height_crossing(const float* cell,
                                     const std::array<std::ptrdiff_t, 3>& strides, int face) {
  const int along_axis = face / 2;
  const std::ptrdiff_t along = (face & 1) != 0 ? strides[along_axis] : -strides[along_axis];
  const float* neighbor = cell + along;
  float change = 0.0F;
  const int axis = steepest_axis(cell, neighbor, strides, &change);
  const std::ptrdiff_t up = change < 0.0F ? strides[axis] : -strides[axis];
  const std::array<std::ptrdiff_t, 2> across = {strides[(axis + 1) % 3], strides[(axis + 2) % 3]};
  std::optional<float> t = crossing_from(cell, along, up, across);
  if (axis != along_axis && (!t || *t > 0.5F)) {
    // The other cell is closer to the surface.
    const std::optional<float> back = crossing_from(neighbor, -along, up, across);
    if (back) t = 1.0F - *back;
  }
  if (!t || !(*t >= -kSlack && *t <= 1.0F + kSlack)) return std::nullopt;
  return t;
}

bool is_smooth_at(const float* cell, const std::array<std::ptrdiff_t, 3>& strides, int face) {
  const std::ptrdiff_t along = (face & 1) != 0 ? strides[face / 2] : -strides[face / 2];
  float change = 0.0F;
  const int axis = steepest_axis(cell, cell + along, strides, &change);
  const std::ptrdiff_t up = change < 0.0F ? strides[axis] : -strides[axis];
  const std::array<std::ptrdiff_t, 2> across = {strides[(axis + 1) % 3], strides[(axis + 2) % 3]};
  return is_smooth_around(cell, up, across) &&
         (axis == face / 2 || is_smooth_around(cell + along, up, across));
}

std::optional<float> height_over_center(const float* cell,
                                        const std::array<std::ptrdiff_t, 3>& strides) {
  float change = 0.0F;
  const int axis = steepest_axis(cell, cell, strides, &change);
  const std::ptrdiff_t up = change < 0.0F ? strides[axis] : -strides[axis];
  const std::optional<LocalSurface> surface =
      surface_over(cell, up, {strides[(axis + 1) % 3], strides[(axis + 2) % 3]});
  if (!surface || std::abs(surface->first.curvature) > kMostCurved ||
      std::abs(surface->second.curvature) > kMostCurved) {
    return std::nullopt;
  }
  return surface->height;
}

}  // namespace prefilter
