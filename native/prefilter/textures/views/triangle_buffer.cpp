// SPDX-License-Identifier: GPL-3.0-or-later

// Scanline rasterization with a z-buffer.
#include "prefilter/textures/views/triangle_buffer.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace prefilter {

TriangleBuffer::TriangleBuffer(const View& view, bool is_second) : view_(&view) {
  const double middle = 0.5 * view.size;
  const std::array<double, 2> from = {is_second ? view.step[0] : 0.0,
                                      is_second ? view.step[1] : 0.0};
  points_.reserve(view.surface->positions.size());
  for (const Vector3& p : view.surface->positions) {
    const Vector3 offset = (1.0 / view.pixel) * (p - view.center);
    points_.push_back({dot(offset, view.right) + middle + from[0],
                       dot(offset, view.up) + middle + from[1],
                       static_cast<float>(dot(offset, view.toward))});
  }
}

void TriangleBuffer::draw(int begin, int end, int samples, std::vector<std::uint32_t>* triangles) {
  const int width = view_->size * samples;
  const int height = (end - begin) * samples;
  const auto count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  triangles->assign(count, kNothing);
  depths_.assign(count, -std::numeric_limits<float>::infinity());
  const auto& all = view_->surface->triangles;
  for (std::uint32_t t = 0; t < all.size(); ++t) {
    // In samples; the first sample is at 0.
    std::array<std::array<double, 2>, 3> p;
    std::array<double, 3> z;
    for (std::size_t k = 0; k < 3; ++k) {
      const Point& point = points_[static_cast<std::size_t>(all[t][k])];
      p[k] = {point.x * samples - 0.5, (point.y - begin) * samples - 0.5};
      z[k] = point.depth;
    }
    const auto [low, high] = std::minmax({p[0][1], p[1][1], p[2][1]});
    if (high < 0.0 || low > height - 1) continue;
    const double area =
        (p[1][0] - p[0][0]) * (p[2][1] - p[0][1]) - (p[2][0] - p[0][0]) * (p[1][1] - p[0][1]);
    if (!(std::abs(area) > 1e-9)) continue;
    const double depth_x =
        ((z[1] - z[0]) * (p[2][1] - p[0][1]) - (z[2] - z[0]) * (p[1][1] - p[0][1])) / area;
    const double depth_y =
        ((z[2] - z[0]) * (p[1][0] - p[0][0]) - (z[1] - z[0]) * (p[2][0] - p[0][0])) / area;
    const int first = static_cast<int>(std::ceil(std::max(low, 0.0)));
    const int last = static_cast<int>(std::floor(std::min(high, height - 1.0)));
    for (int y = first; y <= last; ++y) {
      double from = std::numeric_limits<double>::infinity();
      double to = -from;
      for (std::size_t k = 0; k < 3; ++k) {
        const auto& a = p[k];
        const auto& b = p[(k + 1) % 3];
        if (std::min(a[1], b[1]) > y || std::max(a[1], b[1]) < y) continue;
        const double rise = b[1] - a[1];
        // Horizontal edges are skipped: the adjacent edges contribute their end points.
        if (rise == 0.0) continue;
        const double x = a[0] + (y - a[1]) / rise * (b[0] - a[0]);
        from = std::min(from, x);
        to = std::max(to, x);
      }
      if (!(from <= width - 1.0 && to >= 0.0)) continue;
      const int left = static_cast<int>(std::ceil(std::max(from, 0.0)));
      const int right = static_cast<int>(std::floor(std::min(to, width - 1.0)));
      const std::size_t row = static_cast<std::size_t>(y) * static_cast<std::size_t>(width);
      for (int x = left; x <= right; ++x) {
        const auto depth =
            static_cast<float>(z[0] + (x - p[0][0]) * depth_x + (y - p[0][1]) * depth_y);
        const std::size_t at = row + static_cast<std::size_t>(x);
        if (!(depth > depths_[at])) continue;
        depths_[at] = depth;
        (*triangles)[at] = t;
      }
    }
  }
}

ScreenMap TriangleBuffer::map_of(std::uint32_t triangle) const {
  const auto& [a, b, c] = view_->surface->triangles[triangle];
  const Point& p = points_[static_cast<std::size_t>(a)];
  const Point& q = points_[static_cast<std::size_t>(b)];
  const Point& r = points_[static_cast<std::size_t>(c)];
  const auto& uvs = view_->surface->uvs[triangle];
  const double area = (q.x - p.x) * (r.y - p.y) - (r.x - p.x) * (q.y - p.y);
  ScreenMap map;
  const auto put = [&](std::size_t i, double of_p, double of_q, double of_r) {
    map.by_x[i] = ((of_q - of_p) * (r.y - p.y) - (of_r - of_p) * (q.y - p.y)) / area;
    map.by_y[i] = ((of_r - of_p) * (q.x - p.x) - (of_q - of_p) * (r.x - p.x)) / area;
    map.at[i] = of_p - p.x * map.by_x[i] - p.y * map.by_y[i];
  };
  put(0, uvs[0].u, uvs[1].u, uvs[2].u);
  put(1, uvs[0].v, uvs[1].v, uvs[2].v);
  return map;
}

}  // namespace prefilter
