// SPDX-License-Identifier: GPL-3.0-or-later

// Ericson, Real-Time Collision Detection (2005), section 5.1.5.
#include "prefilter/geometry/spatial/triangle_point.h"

#include <algorithm>

namespace prefilter {
namespace {

// Parameter in [0, 1] of the point of the segment from the origin along `edge` that is nearest to a
// point; `along` is the point's scalar product with the edge.
double on_segment(double along, double squared_length) {
  return squared_length > 0.0 ? std::clamp(along / squared_length, 0.0, 1.0) : 0.0;
}

}  // namespace

Vector3 nearest_weights(const Vector3& p, const Vector3& a, const Vector3& b, const Vector3& c) {
  const Vector3 ab = b - a;
  const Vector3 ac = c - a;
  const Vector3 ap = p - a;
  const double d1 = dot(ab, ap);
  const double d2 = dot(ac, ap);
  if (d1 <= 0.0 && d2 <= 0.0) return {1.0, 0.0, 0.0};
  const Vector3 bp = p - b;
  const double d3 = dot(ab, bp);
  const double d4 = dot(ac, bp);
  if (d3 >= 0.0 && d4 <= d3) return {0.0, 1.0, 0.0};
  const Vector3 cp = p - c;
  const double d5 = dot(ab, cp);
  const double d6 = dot(ac, cp);
  if (d6 >= 0.0 && d5 <= d6) return {0.0, 0.0, 1.0};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) {
    const double t = on_segment(d1, d1 - d3);
    return {1.0 - t, t, 0.0};
  }
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) {
    const double t = on_segment(d2, d2 - d6);
    return {1.0 - t, 0.0, t};
  }
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0) {
    const double t = on_segment(d4 - d3, (d4 - d3) + (d5 - d6));
    return {0.0, 1.0 - t, t};
  }
  const double sum = va + vb + vc;
  if (!(sum > 0.0)) return {1.0, 0.0, 0.0};
  const double v = vb / sum;
  const double w = vc / sum;
  return {std::max(0.0, 1.0 - v - w), v, w};
}

}  // namespace prefilter
