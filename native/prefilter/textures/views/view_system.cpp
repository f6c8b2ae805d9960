// SPDX-License-Identifier: GPL-3.0-or-later

// Conjugate gradients with a diagonal preconditioner, matrix-free: each product looks up all pixels
// and scatters the result back.
#include "prefilter/textures/views/view_system.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "prefilter/base/parallel.h"

namespace prefilter {
namespace {

constexpr std::int64_t kTexelsPerTask = 1 << 14;
constexpr std::size_t kPixelsPerBatch = 20'000;
constexpr std::size_t kMaxSlices = 8;
constexpr std::size_t kMinSlices = 2;
constexpr std::size_t kTexelsOfSlices = 12'000'000;  // bounds the memory of all slices
constexpr int kFirstIterations = 20;
constexpr int kBoundedIterations = 8;  // with the texels at their bounds fixed

Lanes all_lanes(float value) { return Lanes{} + value; }

}  // namespace

template <typename Visit>
void ViewSystem::for_lookup_kinds(const Visit& visit) const {
  const float share = lookups_ == Lookups::kBoth ? 0.5F : 1.0F;
  if (lookups_ != Lookups::kAnisotropic) visit(false, share);
  if (lookups_ != Lookups::kTrilinear) visit(true, share);
}

template <typename Visit>
void ViewSystem::for_texels_at(double u, double v, float mip, float share,
                               const Visit& visit) const {
  const auto last = static_cast<float>(levels_.size() - 1);
  const float value = std::clamp(mip, 0.0F, last);
  const auto finer = static_cast<std::size_t>(value);
  const float fraction = value - static_cast<float>(finer);
  for (const std::size_t level : {finer, finer + 1}) {
    const float level_share = share * (level == finer ? 1.0F - fraction : fraction);
    if (!(level_share > 0.0F)) continue;
    for_bilinear(levels_[level], wrap_, u, v, [&](std::size_t texel, float weight) {
      visit(level, texel, level_share * weight);
    });
  }
}

template <typename Visit>
void ViewSystem::for_texels(const ViewPixel& pixel, bool is_anisotropic, const Visit& visit) const {
  if (!is_anisotropic) return for_texels_at(pixel.uv[0], pixel.uv[1], pixel.mip, 1.0F, visit);
  const int count = pixel.count;
  for (int i = 1; i <= count; ++i) {
    const double at = static_cast<double>(i) / (count + 1) - 0.5;
    for_texels_at(pixel.uv[0] + at * pixel.along[0], pixel.uv[1] + at * pixel.along[1],
                  pixel.row_mip, 1.0F / static_cast<float>(count), visit);
  }
}

ViewSystem::ViewSystem(const std::vector<ImageView>& levels,
                       const std::vector<double>& start_weights, std::vector<ViewPixels> seen,
                       const ViewFitOptions& options, const Run& run)
    : levels_(levels),
      wrap_(options.wrap),
      lookups_(options.lookups),
      threads_(options.run.threads()),
      seen_(std::move(seen)) {
  begins_ = {0};
  for (const ImageView& level : levels) {
    if (begins_.size() == 1) {
      begins_.push_back(0);
      continue;
    }
    begins_.push_back(begins_.back() + level.texel_count());
    for (std::size_t i = 0; i < level.texel_count(); ++i) {
      LaneValues texel;
      for (int c = 0; c < level.channels; ++c) {
        texel.v[c] = level.data[i * static_cast<std::size_t>(level.channels) + c];
      }
      start_.push_back(texel);
    }
  }
  is_free_.assign(start_.size(), {all_lanes(1.0F)});
  make_slices();
  const Stages stages(run, {3, 3, 4});
  scale_steadiness(options.steadiness, stages[0]);
  compute_diagonal(start_weights, stages[1]);
  right_side_ = sum_slices(stages[2], [&](const ViewPixels& of_view, Texels* sums) {
    scatter(
        of_view,
        [&](const ViewPixel& p, bool is_anisotropic) { return residual_of(p, is_anisotropic); },
        sums);
  });
}

// The slices depend on the views and texels only, so that sums do not depend on the thread count.
void ViewSystem::make_slices() {
  const std::size_t count =
      std::clamp(kTexelsOfSlices / std::max<std::size_t>(1, start_.size()), kMinSlices, kMaxSlices);
  std::size_t pixels = 0;
  for (const ViewPixels& view_pixels : seen_) pixels += view_pixels.pixels.size();
  slices_ = {0};
  std::size_t sum = 0;
  for (std::size_t i = 0; i < seen_.size(); ++i) {
    sum += seen_[i].pixels.size();
    if (sum * count >= pixels * slices_.size() && slices_.size() < count) slices_.push_back(i + 1);
  }
  slices_.push_back(seen_.size());
}

Lanes ViewSystem::lookup(const ViewPixel& pixel, bool is_anisotropic, const Texels& texels,
                         bool with_image) const {
  Lanes sum{};
  for_texels(pixel, is_anisotropic, [&](std::size_t level, std::size_t texel, float weight) {
    if (level > 0) {
      sum += texels[begins_[level] + texel].v * all_lanes(weight);
    } else if (with_image) {
      const int channels = levels_[0].channels;
      const float* const values = levels_[0].data + texel * static_cast<std::size_t>(channels);
      for (int c = 0; c < channels; ++c) sum[c] += weight * values[c];
    }
  });
  return sum;
}

Lanes ViewSystem::residual_of(const ViewPixel& pixel, bool is_anisotropic) const {
  return pixel.target - lookup(pixel, is_anisotropic, start_, true);
}

template <typename Add>
auto ViewSystem::sum_slices(const Run& run, const Add& add) const -> Texels {
  const std::size_t count = slices_.size() - 1;
  std::vector<Texels> slices(count);
  for (Texels& sums : slices) sums.resize(start_.size());
  // In batches, so that cancelling need not wait for a whole slice.
  std::vector<std::size_t> next(slices_.begin(), slices_.end() - 1);
  bool is_done = false;
  while (!is_done) {
    parallel_for(static_cast<std::int64_t>(count), run, [&](std::int64_t k) {
      const auto s = static_cast<std::size_t>(k);
      std::size_t pixels = 0;
      while (next[s] < slices_[s + 1] && pixels < kPixelsPerBatch) {
        const ViewPixels& of_view = seen_[next[s]++];
        add(of_view, &slices[s]);
        pixels += of_view.pixels.size();
      }
    });
    is_done = true;
    for (std::size_t s = 0; s < count; ++s) is_done = is_done && next[s] == slices_[s + 1];
  }
  const auto texels = static_cast<std::int64_t>(start_.size());
  parallel_ranges(texels, kTexelsPerTask, run, [&](std::int64_t begin, std::int64_t end) {
    for (std::size_t s = 1; s < count; ++s) {
      for (std::int64_t j = begin; j < end; ++j) {
        const auto at = static_cast<std::size_t>(j);
        slices[0][at].v += slices[s][at].v;
      }
    }
  });
  return std::move(slices[0]);
}

template <typename Value>
void ViewSystem::scatter(const ViewPixels& seen, const Value& value, Texels* sums) const {
  const std::vector<ViewPixel>& pixels = seen.pixels;
  for_lookup_kinds([&](bool is_anisotropic, float share) {
    const float weight = share * static_cast<float>(seen.weight);
    const auto put = [&](const ViewPixel& pixel, float trust, Lanes difference) {
      const Lanes amount = all_lanes(weight * trust) * difference;
      for_texels(pixel, is_anisotropic, [&](std::size_t level, std::size_t texel, float part) {
        if (level > 0) (*sums)[begins_[level] + texel].v += amount * all_lanes(part);
      });
    };
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      const Lanes first = value(pixels[i], is_anisotropic);
      if (i + 1 == pixels.size() || !pixels[i + 1].is_second) {
        put(pixels[i], pixels[i].trust, first);
        continue;
      }
      const Lanes second = value(pixels[i + 1], is_anisotropic);
      const Lanes change = all_lanes(steadiness_) * (second - first);
      const float common_trust = std::min(pixels[i].trust, pixels[i + 1].trust);
      put(pixels[i], 1.0F, all_lanes(pixels[i].trust) * first - all_lanes(common_trust) * change);
      put(pixels[i + 1], 1.0F,
          all_lanes(pixels[i + 1].trust) * second + all_lanes(common_trust) * change);
      ++i;
    }
  });
}

// Scales the weight of flicker by the ratio of squared errors to squared changes at the start.
void ViewSystem::scale_steadiness(double steadiness, const Run& run) {
  if (!(steadiness > 0.0)) return;
  std::vector<std::array<double, 2>> sums(seen_.size());
  parallel_for(static_cast<std::int64_t>(seen_.size()), run, [&](std::int64_t k) {
    const auto at = static_cast<std::size_t>(k);
    const auto add = [&](std::size_t which, Lanes value, float share) {
      for (int c = 0; c < kMaxChannels; ++c) {
        sums[at][which] += seen_[at].weight * share * static_cast<double>(value[c]) * value[c];
      }
    };
    const std::vector<ViewPixel>& pixels = seen_[at].pixels;
    for_lookup_kinds([&](bool is_anisotropic, float share) {
      Lanes before{};
      float trust = 1.0F;
      for (const ViewPixel& pixel : pixels) {
        const Lanes error = residual_of(pixel, is_anisotropic);
        add(0, error, share * pixel.trust);
        if (pixel.is_second) add(1, error - before, share * std::min(pixel.trust, trust));
        before = error;
        trust = pixel.trust;
      }
    });
  });
  double error = 0.0;
  double change = 0.0;
  for (const auto& [of_view, of_change] : sums) {
    error += of_view;
    change += of_change;
  }
  // If changes are much smaller than errors nobody sees them.
  constexpr double kMaxScale = 10.0;
  steadiness_ = static_cast<float>(steadiness * (error < kMaxScale * change
                                                     ? error / change
                                                     : (change > 0.0 ? kMaxScale : 0.0)));
}

void ViewSystem::compute_diagonal(const std::vector<double>& start_weights, const Run& run) {
  const Texels squares = sum_slices(run, [&](const ViewPixels& of_view, Texels* sums) {
    for_lookup_kinds([&](bool is_anisotropic, float share) {
      const float weight = share * static_cast<float>(of_view.weight) * (1.0F + steadiness_);
      for (const ViewPixel& pixel : of_view.pixels) {
        for_texels(pixel, is_anisotropic, [&](std::size_t level, std::size_t texel, float part) {
          if (level > 0) {
            (*sums)[begins_[level] + texel].v[0] += pixel.trust * weight * part * part;
          }
        });
      }
    });
  });
  diagonal_.resize(squares.size());
  start_weights_.resize(squares.size());
  for (std::size_t level = 1; level < levels_.size(); ++level) {
    double sum = 0.0;
    std::size_t count = 0;
    for (std::size_t j = begins_[level]; j < begins_[level + 1]; ++j) {
      diagonal_[j] = squares[j].v[0];
      sum += squares[j].v[0];
      count += squares[j].v[0] > 0.0F ? 1 : 0;
    }
    const double start_weight =
        count > 0 ? start_weights[level] * sum / static_cast<double>(count) : 1.0;
    for (std::size_t j = begins_[level]; j < begins_[level + 1]; ++j) {
      start_weights_[j] = static_cast<float>(start_weight);
      diagonal_[j] += static_cast<float>(start_weight);
    }
  }
}

auto ViewSystem::dot(const Texels& a, const Texels& b) const -> Sums {
  const auto count = static_cast<std::int64_t>(a.size());
  std::vector<Sums> sums(static_cast<std::size_t>(range_count(count, kTexelsPerTask)));
  parallel_ranges(count, kTexelsPerTask, Run(threads_), [&](std::int64_t begin, std::int64_t end) {
    Sums& sum = sums[static_cast<std::size_t>(begin / kTexelsPerTask)];
    for (std::int64_t j = begin; j < end; ++j) {
      const auto at = static_cast<std::size_t>(j);
      for (std::size_t c = 0; c < kMaxChannels; ++c) {
        sum[c] += static_cast<double>(a[at].v[c]) * b[at].v[c];
      }
    }
  });
  Sums total{};
  for (const Sums& sum : sums) {
    for (std::size_t c = 0; c < kMaxChannels; ++c) total[c] += sum[c];
  }
  return total;
}

void ViewSystem::iterate(int steps, Texels* texels, const Run& run) const {
  const std::size_t count = start_.size();
  const auto product = [&](const Texels& of, const Run& part) {
    Texels sums = sum_slices(part, [&](const ViewPixels& of_view, Texels* slice) {
      scatter(
          of_view,
          [&](const ViewPixel& p, bool is_anisotropic) {
            return lookup(p, is_anisotropic, of, false);
          },
          slice);
    });
    for (std::size_t j = 0; j < count; ++j) {
      sums[j].v = is_free_[j].v * (sums[j].v + all_lanes(start_weights_[j]) * of[j].v);
    }
    return sums;
  };
  Texels residual = product(*texels, run.part(0.0, 1.0 / (steps + 1)));
  Texels scaled(count);
  const auto scale = [&] {
    for (std::size_t j = 0; j < count; ++j) {
      scaled[j].v = residual[j].v * all_lanes(1.0F / std::max(diagonal_[j], 1e-30F));
    }
  };
  for (std::size_t j = 0; j < count; ++j) {
    residual[j].v = is_free_[j].v * right_side_[j].v - residual[j].v;
  }
  scale();
  Texels direction = scaled;
  Sums size = dot(residual, scaled);
  for (int step = 0; step < steps; ++step) {
    const Texels image =
        product(direction, run.part((step + 1.0) / (steps + 1), (step + 2.0) / (steps + 1)));
    const Sums across = dot(direction, image);
    Lanes length{};
    for (std::size_t c = 0; c < kMaxChannels; ++c) {
      length[c] = across[c] > 0.0 ? static_cast<float>(size[c] / across[c]) : 0.0F;
    }
    for (std::size_t j = 0; j < count; ++j) {
      (*texels)[j].v += length * direction[j].v;
      residual[j].v -= length * image[j].v;
    }
    scale();
    const Sums next = dot(residual, scaled);
    Lanes ratio{};
    for (std::size_t c = 0; c < kMaxChannels; ++c) {
      ratio[c] = size[c] > 0.0 ? static_cast<float>(next[c] / size[c]) : 0.0F;
    }
    for (std::size_t j = 0; j < count; ++j) {
      direction[j].v = scaled[j].v + ratio * direction[j].v;
    }
    size = next;
  }
}

std::vector<Image> ViewSystem::solve(const SolveOptions& options, const Run& run) {
  Texels change_from_start(start_.size());
  Lanes low{};
  Lanes high{};
  for (std::size_t c = 0; c < kMaxChannels; ++c) {
    // Unlimited ranges end at the largest float, not at infinity, which times an alpha of 0 would
    // be NaN.
    low[c] = std::max(options.ranges[c].low, -std::numeric_limits<float>::max());
    high[c] = std::min(options.ranges[c].high, std::numeric_limits<float>::max());
  }
  const auto clip = [&] {
    for (std::size_t j = 0; j < start_.size(); ++j) {
      const Lanes texel = start_[j].v + change_from_start[j].v;
      Lanes scale = all_lanes(1.0F);
      if (options.ranges_times_alpha) {
        scale = all_lanes(std::clamp(texel[3], low[3], high[3]));
        scale[3] = 1.0F;
      }
      const Lanes within = lane_min(lane_max(texel, low * scale), high * scale);
      for (std::size_t c = 0; c < kMaxChannels; ++c) {
        is_free_[j].v[c] = texel[c] == within[c] ? 1.0F : 0.0F;
      }
      change_from_start[j].v = within - start_[j].v;
    }
  };
  const Stages stages(run, {7, 3});
  iterate(kFirstIterations, &change_from_start, stages[0]);
  clip();
  iterate(kBoundedIterations, &change_from_start, stages[1]);
  clip();
  std::vector<Image> levels;
  for (std::size_t level = 1; level < levels_.size(); ++level) {
    const ImageView& from = levels_[level];
    Image image(from.width, from.height, from.channels);
    for (std::size_t i = 0; i < from.texel_count(); ++i) {
      const Lanes value = start_[begins_[level] + i].v + change_from_start[begins_[level] + i].v;
      for (int c = 0; c < from.channels; ++c) {
        image.data[i * static_cast<std::size_t>(from.channels) + static_cast<std::size_t>(c)] =
            value[c];
      }
    }
    levels.push_back(std::move(image));
  }
  return levels;
}

}  // namespace prefilter
