// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/textures/mipmap/seam_links.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <tuple>
#include <unordered_map>

#include "prefilter/base/cancel_check.h"
#include "prefilter/base/elementary.h"

namespace prefilter {
namespace {

// UV coordinates closer than this are equal. The tolerance is far below a texel, and above the
// rounding errors of floats in subdivided meshes.
constexpr double kSameUvTolerance = 1e-6;

// Texels. Longer seams are skipped; they cross a texture that repeats extremely often.
constexpr double kMaxSeamTexels = 1 << 16;

struct PositionHash {
  std::size_t operator()(const Vector3& position) const {
    std::uint64_t hash = 0x9E3779B97F4A7C15U;
    for (const double value : position) {
      hash ^= std::bit_cast<std::uint64_t>(value);
      hash *= 0xBF58476D1CE4E5B9U;
      hash ^= hash >> 29U;
    }
    return hash;
  }
};

// For each vertex the first vertex at its position.
std::vector<std::int32_t> weld(const std::vector<Vector3>& positions, CancelCheck* cancel_check) {
  std::unordered_map<Vector3, std::int32_t, PositionHash> first;
  first.reserve(positions.size());
  std::vector<std::int32_t> welded(positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    cancel_check->step();
    Vector3 position = positions[i];
    for (double& value : position) value += 0.0;  // -0 is 0
    welded[i] = first.try_emplace(position, static_cast<std::int32_t>(i)).first->second;
  }
  return welded;
}

struct Edge {
  std::int32_t low, high;  // welded vertices
  TextureCoordinate at_low, at_high;
};

double area_of_mesh(const Surface& surface) {
  double sum = 0.0;
  for (const std::array<std::int32_t, 3>& triangle : surface.triangles) {
    const Vector3& p = surface.positions[triangle[0]];
    sum +=
        0.5 * length(cross(surface.positions[triangle[1]] - p, surface.positions[triangle[2]] - p));
  }
  return sum;
}

bool same(const TextureCoordinate& a, const TextureCoordinate& b) {
  return std::abs(a.u - b.u) < kSameUvTolerance && std::abs(a.v - b.v) < kSameUvTolerance;
}

// Adds the taps of a bilinear lookup to a link, merging those of the same texel.
void add_lookup(const TextureCoordinate& at, int width, int height, WrapModes wrap, float sign,
                SeamLink* link) {
  // Lookups outside a clamped image read its edge.
  const auto place = [](double coordinate, int size, Wrap mode, int* texel) {
    const double clamped = mode == Wrap::kClamp ? std::clamp(coordinate, 0.0, 1.0) : coordinate;
    const double from_center = clamped * size - 0.5;
    *texel = static_cast<int>(std::floor(from_center));
    return from_center - *texel;
  };
  int column = 0;
  int row = 0;
  const double x = place(at.u, width, wrap.u, &column);
  const double y = place(at.v, height, wrap.v, &row);
  for (int k = 0; k < 4; ++k) {
    const int i = wrap_index(column + k % 2, width, wrap.u);
    const int j = wrap_index(row + k / 2, height, wrap.v);
    const double share = (k % 2 == 0 ? 1.0 - x : x) * (k / 2 == 0 ? 1.0 - y : y);
    if (i < 0 || j < 0 || share == 0.0) continue;
    int slot = 0;
    while (slot < link->count && (link->x[slot] != i || link->y[slot] != j)) ++slot;
    if (slot == link->count) {
      link->x[slot] = i;
      link->y[slot] = j;
      link->shares[slot] = 0.0F;
      ++link->count;
    }
    link->shares[slot] += sign * static_cast<float>(share);
  }
}

double texel_length(const std::array<TextureCoordinate, 2>& ends, int width, int height) {
  return elementary::hypot((ends[1].u - ends[0].u) * width, (ends[1].v - ends[0].v) * height);
}

// Adds the points where the line between two coordinates, in texels, crosses texel centers, as
// fractions of its length.
void add_stops(double from, double to, std::vector<double>* stops) {
  const double low = std::min(from, to);
  const double high = std::max(from, to);
  for (double center = std::floor(low - 0.5) + 1.5; center < high; center += 1.0) {
    stops->push_back((center - from) / (to - from));
  }
}

TextureCoordinate between(const std::array<TextureCoordinate, 2>& ends, double f) {
  return {ends[0].u + f * (ends[1].u - ends[0].u), ends[0].v + f * (ends[1].v - ends[0].v)};
}

Lanes lookup(const TextureCoordinate& at, const ImageView& image, WrapModes wrap) {
  SeamLink link;
  add_lookup(at, image.width, image.height, wrap, 1.0F, &link);
  Lanes value{};
  for (int k = 0; k < link.count; ++k) {
    const float* texel = image.texel(link.x[k], link.y[k]);
    for (int c = 0; c < image.channels; ++c) value[c] += link.shares[k] * texel[c];
  }
  return value;
}

double sum_of_squares(Lanes value) {
  double sum = 0.0;
  for (int c = 0; c < kMaxChannels; ++c) sum += static_cast<double>(value[c]) * value[c];
  return sum;
}

// Calls use(center) for the n * n congruent triangles that subdivide a triangle.
template <typename Use>
void for_each_part(const std::array<TextureCoordinate, 3>& triangle, int n, const Use& use) {
  const auto at = [&](double b1, double b2) {
    const double b0 = n - b1 - b2;
    const auto& [p, q, r] = triangle;
    return TextureCoordinate{(b0 * p.u + b1 * q.u + b2 * r.u) / n,
                             (b0 * p.v + b1 * q.v + b2 * r.v) / n};
  };
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n - i; ++j) {
      use(at(i + 1.0 / 3.0, j + 1.0 / 3.0));
      if (i + j < n - 1) use(at(i + 2.0 / 3.0, j + 2.0 / 3.0));
    }
  }
}

// Variance of the image over the surfaces, from sample points of about equal area, at least one per
// triangle.
double variance_on(const std::vector<const Surface*>& surfaces, const ImageView& image,
                   WrapModes wrap, CancelCheck* cancel_check) {
  constexpr double kPoints = 1 << 14;
  double area = 0.0;
  for (const Surface* surface : surfaces) area += surface->total_area();
  double mass = 0.0;
  double squares = 0.0;
  std::array<double, kMaxChannels> mean{};
  for (const Surface* surface : surfaces) {
    for (std::size_t k = 0; k < surface->triangle_count(); ++k) {
      cancel_check->step();
      if (!(surface->areas[k] > 0.0)) continue;
      const int n = static_cast<int>(std::ceil(std::sqrt(kPoints * surface->areas[k] / area)));
      const double part = surface->areas[k] / (static_cast<double>(n) * n);
      for_each_part(surface->uvs[k], n, [&](const TextureCoordinate& point) {
        const Lanes value = lookup(point, image, wrap);
        mass += part;
        squares += part * sum_of_squares(value);
        for (int c = 0; c < kMaxChannels; ++c) mean[c] += part * value[c];
      });
    }
  }
  double variance = squares / mass;
  for (const double sum : mean) variance -= (sum / mass) * (sum / mass);
  return variance;
}

// Fractions from 0 to 1 where either side of a seam crosses a texel center along an axis. Between
// them the difference of the lookups is quadratic.
std::vector<double> stops_of(const SeamEdge& seam, int width, int height) {
  std::vector<double> stops = {0.0, 1.0};
  for (const std::array<TextureCoordinate, 2>& side : {seam.left, seam.right}) {
    add_stops(side[0].u * width, side[1].u * width, &stops);
    add_stops(side[0].v * height, side[1].v * height, &stops);
  }
  std::sort(stops.begin(), stops.end());
  return stops;
}

// Root mean square difference across a seam, in standard deviations of the image: seams up to the
// first value are hidden, those above the second are features of the image.
constexpr double kHiddenStep = 0.1;
constexpr double kShownStep = 0.12;

constexpr double kMinSeamPart = 1e-9;

// Three-point Gauss rule, exact up to degree 5.
constexpr double kGaussWeights[3] = {5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0};
const double kGaussOffset = std::sqrt(0.6);

double gauss_point(double begin, double end, int k) {
  return 0.5 * (begin + end) + 0.5 * (end - begin) * (k - 1) * kGaussOffset;
}

}  // namespace

std::vector<SeamEdge> find_seams(const Surface& surface, const Run& run) {
  CancelCheck cancel_check(run);
  const std::vector<std::int32_t> welded = weld(surface.positions, &cancel_check);
  std::vector<Edge> edges;
  edges.reserve(3 * surface.triangles.size());
  for (std::size_t k = 0; k < surface.triangles.size(); ++k) {
    cancel_check.step();
    for (int corner = 0; corner < 3; ++corner) {
      const int next = (corner + 1) % 3;
      Edge edge{welded[surface.triangles[k][corner]], welded[surface.triangles[k][next]],
                surface.uvs[k][corner], surface.uvs[k][next]};
      if (edge.low == edge.high) continue;
      if (edge.low > edge.high) {
        std::swap(edge.low, edge.high);
        std::swap(edge.at_low, edge.at_high);
      }
      edges.push_back(edge);
    }
  }
  std::stable_sort(edges.begin(), edges.end(), [&](const Edge& a, const Edge& b) {
    cancel_check.step();
    return std::tie(a.low, a.high) < std::tie(b.low, b.high);
  });
  const auto same_line = [](const Edge& a, const Edge& b) {
    return a.low == b.low && a.high == b.high;
  };
  const double mesh_area = area_of_mesh(surface);
  const double area_scale = mesh_area > 0.0 ? surface.total_area() / mesh_area : 1.0;
  std::vector<SeamEdge> seams;
  std::size_t end = 0;
  for (std::size_t begin = 0; begin < edges.size(); begin = end) {
    cancel_check.step();
    end = begin + 1;
    while (end < edges.size() && same_line(edges[begin], edges[end])) ++end;
    if (end - begin != 2) continue;
    const Edge& a = edges[begin];
    const Edge& b = edges[begin + 1];
    if (same(a.at_low, b.at_low) && same(a.at_high, b.at_high)) continue;
    const double size = length(surface.positions[a.high] - surface.positions[a.low]);
    if (!(size > 0.0)) continue;
    seams.push_back({{a.at_low, a.at_high}, {b.at_low, b.at_high}, size, area_scale});
  }
  return seams;
}

std::vector<SeamEdge> find_seams(const std::vector<const Surface*>& surfaces, const Run& run) {
  std::vector<SeamEdge> seams;
  for (const Surface* surface : surfaces) {
    const std::vector<SeamEdge> own = find_seams(*surface, run);
    seams.insert(seams.end(), own.begin(), own.end());
  }
  return seams;
}

double mean_square_across(const SeamEdge& seam, const ImageView& image, WrapModes wrap) {
  const std::vector<double> stops = stops_of(seam, image.width, image.height);
  double mean = 0.0;
  for (std::size_t i = 1; i < stops.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      const double f = gauss_point(stops[i - 1], stops[i], k);
      const Lanes step =
          lookup(between(seam.left, f), image, wrap) - lookup(between(seam.right, f), image, wrap);
      mean += kGaussWeights[k] * (stops[i] - stops[i - 1]) * sum_of_squares(step);
    }
  }
  return mean;
}

void weigh_seams(const ImageView& image, const std::vector<const Surface*>& surfaces,
                 WrapModes wrap, const Run& run, std::vector<SeamEdge>* seams) {
  CancelCheck cancel_check(run);
  const double variance = variance_on(surfaces, image, wrap, &cancel_check);
  for (SeamEdge& seam : *seams) {
    cancel_check.step();
    const double difference = mean_square_across(seam, image, wrap);
    if (!(difference > 0.0)) continue;
    const double step = variance > 0.0 ? std::sqrt(difference / variance) : HUGE_VAL;
    const double shown = std::clamp((step - kHiddenStep) / (kShownStep - kHiddenStep), 0.0, 1.0);
    seam.area_scale *= 1.0 - shown * shown * (3.0 - 2.0 * shown);
  }
}

std::vector<SeamLink> link_seams(const std::vector<SeamEdge>& seams, int width, int height,
                                 WrapModes wrap, const Run& run) {
  CancelCheck cancel_check(run);
  std::vector<SeamLink> links;
  double length = 0.0;
  double texels = 0.0;
  for (const SeamEdge& seam : seams) {
    cancel_check.step();
    const double left = texel_length(seam.left, width, height);
    const double right = texel_length(seam.right, width, height);
    if (!(left + right > 0.0) || left + right > kMaxSeamTexels) continue;
    length += seam.length;
    texels += 0.5 * (left + right);
    if (!(seam.area_scale > 0.0)) continue;
    const std::vector<double> stops = stops_of(seam, width, height);
    for (std::size_t i = 1; i < stops.size(); ++i) {
      if (stops[i] - stops[i - 1] < kMinSeamPart) continue;
      for (int k = 0; k < 3; ++k) {
        SeamLink link;
        const double f = gauss_point(stops[i - 1], stops[i], k);
        add_lookup(between(seam.left, f), width, height, wrap, 1.0F, &link);
        add_lookup(between(seam.right, f), width, height, wrap, -1.0F, &link);
        link.strip_area =
            seam.area_scale * kGaussWeights[k] * (stops[i] - stops[i - 1]) * seam.length;
        links.push_back(link);
      }
    }
  }
  // Normalized to strips one texel wide on average over all seams: each seam counts by its length,
  // as in the seam contrast. Individual widths would be arbitrary for edges that are tiny in the
  // texture.
  for (SeamLink& link : links) link.strip_area *= length / texels;
  return links;
}

}  // namespace prefilter
