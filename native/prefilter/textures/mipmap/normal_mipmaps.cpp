// SPDX-License-Identifier: GPL-3.0-or-later

// Filters unit vectors with the mipmap filters, and derives the roughness from their variance.
#include "prefilter/textures/normal_mipmaps.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "prefilter/base/elementary.h"
#include "prefilter/base/error.h"
#include "prefilter/base/parallel.h"
#include "prefilter/base/text.h"
#include "prefilter/geometry/texels/coverage.h"
#include "prefilter/images/filters/push_pull.h"
#include "prefilter/textures/mipmap/argument_checks.h"
#include "prefilter/textures/mipmap/lookup_means.h"
#include "prefilter/textures/mipmaps.h"
#include "prefilter/textures/texture_use.h"

namespace prefilter {
namespace {

// Maximum length of a vector without a direction: neutral gray in 8 bits decodes to less.
constexpr double kMinNormalLength = 0.02;

// Calls change(texel) for each texel.
template <typename Change>
void for_each_texel(Image* image, const Run& run, const Change& change) {
  parallel_for(image->height, run, [&](std::int64_t row) {
    float* texel = image->texel(0, static_cast<int>(row));
    for (int x = 0; x < image->width; ++x, texel += image->channels) change(texel);
  });
}

// Vectors that are not finite get NaN components.
void make_unit(float* vector) {
  const double x = vector[0];
  const double y = vector[1];
  const double z = vector[2];
  const double length = std::sqrt(x * x + y * y + z * z);
  if (length < kMinNormalLength) {
    vector[0] = 0.0F;
    vector[1] = 0.0F;
    vector[2] = 1.0F;
    return;
  }
  vector[0] = static_cast<float>(x / length);
  vector[1] = static_cast<float>(y / length);
  vector[2] = static_cast<float>(z / length);
}

// Roughness from the mean difference of the unit normals from (0, 0, 1) and the mean alpha^2. A
// unit vector n = (0, 0, 1) + d has |d|^2 = -2 d_z, so the variance of the normals, 1 - L^2, is -2
// E[d_z] - |E[d]|^2.
float roughness_of(const float* means) {
  const double x = means[0];
  const double y = means[1];
  const double z = means[2];
  const double variance = std::clamp(-2.0 * z - (x * x + y * y + z * z), 0.0, 1.0);
  const double lost = variance / (1.0 + std::sqrt(1.0 - variance));  // 1 - L, without cancellation
  return static_cast<float>(elementary::pow(std::clamp(means[3] + 2.0 * lost, 0.0, 1.0), 0.25));
}

class NormalFilter {
 public:
  NormalFilter(const ImageView& normals, const ImageView* roughness,
               const std::vector<const Surface*>& surfaces, const NormalMipmapOptions& options)
      : roughness_(roughness), surfaces_(surfaces), options_(options), vectors_(normals) {}

  NormalMipmaps run() {
    const double share = roughness_ == nullptr ? 1.0 : 0.5;
    NormalMipmaps levels;
    decode(options_.run.part(0.0, 0.2 * share));
    MipmapOptions means = mipmap_options(options_.filter, false, 0.2 * share, share);
    means.footprint = options_.footprint;
    levels.normals = coarser_levels(vectors_.view(), surfaces_, means);
    for (Image& level : levels.normals) finish(options_.run.part(share, share), &level);
    if (roughness_ != nullptr) levels.roughness = rougher_levels();
    options_.run.report(1.0);
    return levels;
  }

 private:
  MipmapOptions mipmap_options(const MipmapFilter& filter, bool premultiplied, double from,
                               double to) const {
    MipmapOptions options;
    options.image_name = "normals";
    options.filter = filter;
    options.wrap = options_.wrap;
    options.bounds = {std::nullopt, std::nullopt};
    options.levels = options_.levels;
    options.premultiplied = premultiplied;
    options.run = options_.run.part(from, to);
    return options;
  }

  void decode(const Run& run) {
    const bool encoded = options_.encoded;
    for_each_texel(&vectors_, run, [encoded](float* vector) {
      for (int c = 0; c < 3 && encoded; ++c) vector[c] = 2.0F * vector[c] - 1.0F;
      make_unit(vector);
    });
  }

  // Removes what least squares overshoots below the surface, and renormalizes.
  void finish(const Run& run, Image* level) {
    const bool lift = points_below(*level, nullptr, run) && !map_points_below(run);
    const bool encoded = options_.encoded;
    for_each_texel(level, run, [lift, encoded](float* vector) {
      if (lift) vector[2] = std::max(vector[2], 0.0F);
      make_unit(vector);
      for (int c = 0; c < 3 && encoded; ++c) vector[c] = (vector[c] + 1.0F) / 2.0F;
    });
  }

  // Whether any vector points below the surface; with weights, any with a weight above 0.
  bool points_below(const Image& vectors, const Image* weights, const Run& run) const {
    std::atomic<bool> found{false};
    parallel_for(vectors.height, run, [&](std::int64_t row) {
      const int y = static_cast<int>(row);
      for (int x = 0; x < vectors.width && !found.load(std::memory_order_relaxed); ++x) {
        if (!(vectors.texel(x, y)[2] < 0.0F)) continue;
        if (weights == nullptr || *weights->texel(x, y) > 0.0F) found.store(true);
      }
    });
    return found.load();
  }

  // Whether a texel of the map that counts points below the surface.
  bool map_points_below(const Run& run) {
    if (!map_points_below_) {
      map_points_below_ = points_below(vectors_, nullptr, run);
      if (*map_points_below_ && !surfaces_.empty()) {
        const Image weights =
            texel_weights(surfaces_, vectors_.width, vectors_.height, options_.wrap, run);
        map_points_below_ = points_below(vectors_, &weights, run);
      }
    }
    return *map_points_below_;
  }

  std::vector<Image> rougher_levels() {
    Image rough(*roughness_);
    MipmapFilter means = SurfaceFilter::kBox;
    if (const auto* in_texture = std::get_if<TextureSpaceFilter>(&options_.filter)) {
      means = TextureSpaceFilter{&box_kernel(), in_texture->weighting};
    } else if (!needs_surface(options_.filter)) {
      means = TextureSpaceFilter{&box_kernel(), Weighting::kAll};
    }
    if (needs_surface(means)) fill_unused_texels(&rough);
    check_roughness(rough);
    for_each_texel(&rough, Run(options_.run.threads()),
                   [](float* value) { *value = std::clamp(*value, 0.0F, 1.0F); });
    const Image shown =
        lookup_means(vectors_.view(), rough.view(), options_.wrap,
                     static_cast<float>(kMinNormalLength), options_.run.part(0.65, 0.8));
    vectors_ = Image();
    rough = Image();
    std::vector<Image> levels;
    for (const Image& level :
         coarser_levels(shown.view(), surfaces_, mipmap_options(means, true, 0.8, 0.95))) {
      Image& rougher = levels.emplace_back(level.width, level.height, 1);
      parallel_for(level.height, options_.run.part(0.95, 0.95), [&](std::int64_t row) {
        const int y = static_cast<int>(row);
        for (int x = 0; x < level.width; ++x) {
          *rougher.texel(x, y) = roughness_of(level.texel(x, y));
        }
      });
    }
    return levels;
  }

  void fill_unused_texels(Image* rough) {
    const std::vector<unsigned char> used = looked_up_texels(
        surfaces_, vectors_.width, vectors_.height, options_.wrap, options_.run.part(0.5, 0.58));
    if (std::find(used.begin(), used.end(), 1) == used.end()) throw_outside();
    const std::vector<float> weights(used.begin(), used.end());
    const auto fill = [&](double from, double to, Image* image) {
      fill_holes(weights, options_.wrap, image->channels, options_.run.part(from, to), image);
    };
    fill(0.58, 0.63, &vectors_);
    fill(0.63, 0.65, rough);
  }

  void check_roughness(const Image& rough) const {
    std::vector<int> finite(
        static_cast<std::size_t>(rough.height));  // leading finite values per row
    parallel_for(rough.height, Run(options_.run.threads()), [&](std::int64_t row) {
      const float* values = rough.texel(0, static_cast<int>(row));
      while (finite[row] < rough.width && std::isfinite(values[finite[row]])) ++finite[row];
    });
    for (int row = 0; row < rough.height; ++row) {
      const int column = finite[row];
      if (column == rough.width) continue;
      throw_invalid("roughness: the texel in row " + std::to_string(row) + ", column " +
                    std::to_string(column) + " holds " + to_text(*rough.texel(column, row)) +
                    "; texels that count must be finite");
    }
  }

  const ImageView* roughness_;
  const std::vector<const Surface*>& surfaces_;
  const NormalMipmapOptions& options_;
  Image vectors_;  // the map, decoded and normalized
  std::optional<bool> map_points_below_;
};

void check(const ImageView& normals, const ImageView* roughness) {
  const auto text_of = [](const ImageView& image) {
    return std::to_string(image.width) + " x " + std::to_string(image.height) + " texels of " +
           std::to_string(image.channels) + " channels";
  };
  if (normals.channels != 3) {
    throw_invalid("normals: " + text_of(normals) + "; 3 channels are needed");
  }
  if (roughness != nullptr && (roughness->channels != 1 || roughness->width != normals.width ||
                               roughness->height != normals.height)) {
    throw_invalid("roughness: " + text_of(*roughness) + "; 1 channel and the " +
                  std::to_string(normals.width) + " x " + std::to_string(normals.height) +
                  " texels of the normals are needed");
  }
}

}  // namespace

NormalMipmaps normal_mipmaps(const ImageView& normals, const ImageView* roughness,
                             const std::vector<const Surface*>& surfaces,
                             const NormalMipmapOptions& options) {
  check(normals, roughness);
  return NormalFilter(normals, roughness, surfaces, options).run();
}

}  // namespace prefilter
