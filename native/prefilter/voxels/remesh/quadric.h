// SPDX-License-Identifier: GPL-3.0-or-later

// Quadric error metric: sums of squared distances from planes.
#pragma once

#include <cmath>

#include "prefilter/base/geometry.h"

namespace prefilter {

/// Area-weighted sum of squared distances from planes.
struct Quadric {
  double xx = 0.0, yy = 0.0, zz = 0.0, xy = 0.0, yz = 0.0, zx = 0.0;
  double x = 0.0, y = 0.0, z = 0.0, constant = 0.0;
  double weight = 0.0;

  /// Adds the plane dot(unit, p) + offset = 0, with a unit normal.
  void add_plane(const Vector3& unit, double offset, double area) {
    const Vector3 n = {area * unit[0], area * unit[1], area * unit[2]};
    xx += n[0] * unit[0];
    yy += n[1] * unit[1];
    zz += n[2] * unit[2];
    xy += n[0] * unit[1];
    yz += n[1] * unit[2];
    zx += n[2] * unit[0];
    x += n[0] * offset;
    y += n[1] * offset;
    z += n[2] * offset;
    constant += area * offset * offset;
    weight += area;
  }
  void add(const Quadric& other) {
    xx += other.xx;
    yy += other.yy;
    zz += other.zz;
    xy += other.xy;
    yz += other.yz;
    zx += other.zx;
    x += other.x;
    y += other.y;
    z += other.z;
    constant += other.constant;
    weight += other.weight;
  }
  /// Mean squared distance of a point from the planes.
  double mean_at(const Vector3& p) const {
    const double rx = xx * p[0] + 2.0 * (xy * p[1] + x);
    const double ry = yy * p[1] + 2.0 * (yz * p[2] + y);
    const double rz = zz * p[2] + 2.0 * (zx * p[0] + z);
    return std::abs(rx * p[0] + ry * p[1] + rz * p[2] + constant) / weight;
  }
};

}  // namespace prefilter
