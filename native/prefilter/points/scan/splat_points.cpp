// SPDX-License-Identifier: GPL-3.0-or-later

// Kerbl et al., 3D Gaussian Splatting for Real-Time Radiance Field Rendering (2023). Their files
// store logarithms of scales, quaternions (w first) that need not be normalized, logits of
// opacities, and coefficients of spherical harmonics.
#include "prefilter/points/scan/splat_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "prefilter/base/elementary.h"
#include "prefilter/points/scan/point_fields.h"

namespace prefilter {
namespace {

// The constant spherical harmonic, 1 / (2 sqrt(pi)), and the offset of colors.
constexpr double kFirstHarmonic = 0.28209479177387814;
constexpr double kColorOffset = 0.5;

using Indices = std::vector<std::size_t>;

// Indices of "scale_0" and so on, as many as exist.
Indices numbered_attributes(const std::vector<PointAttribute>& attributes, const std::string& name,
                            std::size_t most) {
  Indices indices;
  while (indices.size() < most) {
    const auto index = attribute_index(attributes, name + "_" + std::to_string(indices.size()));
    if (!index) break;
    indices.push_back(*index);
  }
  return indices;
}

bool belongs_to_splats(std::string_view name) {
  return name == "opacity" || name.starts_with("scale_") || name.starts_with("rot_") ||
         name.starts_with("f_dc_") || name.starts_with("f_rest_");
}

// Indices of a splat's parameters among its attributes.
struct Splat {
  Indices scales;
  Indices rotation;
  Indices color;  // three, or none
  std::size_t opacity = 0;
};

std::optional<Splat> splat_of(const std::vector<PointAttribute>& attributes) {
  Splat splat{numbered_attributes(attributes, "scale", 3),
              numbered_attributes(attributes, "rot", 4), numbered_attributes(attributes, "f_dc", 3),
              0};
  const auto opacity = attribute_index(attributes, "opacity");
  if (splat.scales.size() < 2 || splat.rotation.size() < 4 || !opacity) return std::nullopt;
  splat.opacity = *opacity;
  if (splat.color.size() < 3) splat.color.clear();
  return splat;
}

// Column `axis` of a quaternion's rotation matrix; zero for an invalid quaternion.
std::array<float, 3> rotated_axis(std::array<double, 4> q, std::size_t axis) {
  const double size = std::max({std::abs(q[0]), std::abs(q[1]), std::abs(q[2]), std::abs(q[3])});
  if (!(size > 0.0) || !std::isfinite(size)) return {};
  for (double& each : q) each /= size;
  const auto& [w, x, y, z] = q;
  const double scale = 1.0 / (w * w + x * x + y * y + z * z);
  const auto scaled = [&](double a, double b, double c) {
    return std::array<float, 3>{static_cast<float>(a * scale), static_cast<float>(b * scale),
                                static_cast<float>(c * scale)};
  };
  if (axis == 0) {
    return scaled(w * w + x * x - y * y - z * z, 2.0 * (x * y + w * z), 2.0 * (x * z - w * y));
  }
  if (axis == 1) {
    return scaled(2.0 * (x * y - w * z), w * w - x * x + y * y - z * z, 2.0 * (y * z + w * x));
  }
  return scaled(2.0 * (x * z + w * y), 2.0 * (y * z - w * x), w * w - x * x - y * y + z * z);
}

float color_byte(double coefficient) {
  if (std::isnan(coefficient)) return 0.0F;
  const double share = std::clamp(kColorOffset + kFirstHarmonic * coefficient, 0.0, 1.0);
  return static_cast<float>(std::round(255.0 * share));
}

class SplatPoints final : public PointSource {
 public:
  SplatPoints(std::unique_ptr<PointSource> source, Splat splat)
      : source_(std::move(source)), splat_(std::move(splat)) {
    const std::vector<PointAttribute>& all = source_->attributes();
    const bool has_color = !splat_.color.empty();
    for (std::size_t a = 0; a < all.size(); ++a) {
      const std::string& name = all[a].name;
      const bool is_color = name == "red" || name == "green" || name == "blue";
      if (belongs_to_splats(name) || (has_color && is_color)) continue;
      retained_.push_back(a);
      attributes_.push_back(all[a]);
    }
    for (const char* name : {"red", "green", "blue"}) {
      if (has_color) attributes_.push_back({name, true});
    }
  }

  std::optional<std::size_t> count() const override { return source_->count(); }
  bool has_normals() const override { return true; }
  bool are_normals_directed() const override { return false; }
  const std::vector<PointAttribute>& attributes() const override { return attributes_; }
  std::optional<Vector3> viewpoint() const override { return source_->viewpoint(); }
  std::vector<std::string> warnings() const override { return source_->warnings(); }
  bool is_double() const override { return source_->is_double(); }
  std::optional<std::size_t> rows() const override { return source_->rows(); }
  void choose_rows(std::size_t begin, std::size_t end) override {
    source_->choose_rows(begin, end);
  }
  void rewind() override { source_->rewind(); }

  bool read(std::size_t most, PointBatch* batch) override {
    if (!source_->read(most, batch)) return false;
    const std::size_t count = batch->positions.size();
    const std::size_t width = source_->attributes().size();
    std::vector<float> values;
    values.reserve(count * attributes_.size());
    batch->normals.resize(count);
    batch->weights.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
      const float* const own = batch->attributes.data() + i * width;
      batch->normals[i] = normal_of(own);
      batch->weights[i] = opacity_of(own[splat_.opacity]);
      for (const std::size_t index : retained_) values.push_back(own[index]);
      for (const std::size_t index : splat_.color) values.push_back(color_byte(own[index]));
    }
    batch->attributes = std::move(values);
    return true;
  }

 private:
  std::array<float, 3> normal_of(const float* values) const {
    std::size_t axis = 2;
    for (std::size_t a = 0; splat_.scales.size() == 3 && a < 2; ++a) {
      if (values[splat_.scales[a]] < values[splat_.scales[axis]]) axis = a;
    }
    std::array<double, 4> rotation{};
    for (std::size_t k = 0; k < 4; ++k) rotation[k] = values[splat_.rotation[k]];
    return rotated_axis(rotation, axis);
  }

  // A NaN counts as transparent.
  static float opacity_of(float logit) {
    if (std::isnan(logit)) return 0.0F;
    return static_cast<float>(1.0 / (1.0 + elementary::exp(-static_cast<double>(logit))));
  }

  std::unique_ptr<PointSource> source_;
  Splat splat_;
  Indices retained_;  // indices of the source's attributes
  std::vector<PointAttribute> attributes_;
};

}  // namespace

std::unique_ptr<PointSource> as_points_of_splats(std::unique_ptr<PointSource> source) {
  std::optional<Splat> splat = splat_of(source->attributes());
  if (!splat) return source;
  return std::make_unique<SplatPoints>(std::move(source), std::move(*splat));
}

}  // namespace prefilter
