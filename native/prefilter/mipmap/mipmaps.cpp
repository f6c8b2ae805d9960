// SPDX-License-Identifier: GPL-3.0-or-later

// Chapter 7. SurfaceFilter::kBox is equation 7.1 with a box, where the texels of the image are
// boxes too, so that an even parameterization gives the plain box filter; section 7.3 level by
// level is SurfaceFilter::kBilinear.
#include "prefilter/mipmap/mipmaps.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>

#include "prefilter/base/error.h"
#include "prefilter/base/filterable.h"
#include "prefilter/base/parallel.h"
#include "prefilter/base/text.h"
#include "prefilter/color/transfer.h"
#include "prefilter/filters/filtered_image.h"
#include "prefilter/filters/push_pull.h"
#include "prefilter/filters/tent_means.h"
#include "prefilter/mipmap/argument_checks.h"
#include "prefilter/mipmap/bilinear_system.h"
#include "prefilter/mipmap/encoded_fit.h"
#include "prefilter/mipmap/image_squares.h"
#include "prefilter/mipmap/pam_box.h"
#include "prefilter/mipmap/seam_links.h"
#include "prefilter/mipmap/texture_space.h"
#include "prefilter/mipmap/trilinear_system.h"
#include "prefilter/texels/coverage.h"
#include "prefilter/texels/levels.h"
#include "prefilter/texels/moment_sweep.h"
#include "prefilter/texels/texel_triangles.h"

namespace prefilter {
namespace {

// Which texels of the image a filter reads.
enum class Reads { kAll, kTouched, kWeighted, kLookedUp };

Reads reads_of(const MipmapFilter& filter) {
  if (const auto* in_texture = std::get_if<TextureSpaceFilter>(&filter)) {
    return in_texture->weighting == Weighting::kAll ? Reads::kAll : Reads::kTouched;
  }
  return is_fit(filter) ? Reads::kLookedUp : Reads::kWeighted;
}

std::optional<int> alpha_channel(int channels, bool premultiplied) {
  return channels == 4 && !premultiplied ? std::optional(3) : std::nullopt;
}

class Builder {
 public:
  Builder(const TexelSource& source, const std::vector<const Surface*>& surfaces,
          const MipmapOptions& options)
      : surfaces_(surfaces),
        options_(options),
        width_(source.width),
        height_(source.height),
        channels_(source.channels),
        level_count_(options.levels > 0 ? options.levels
                                        : full_level_count(source.width, source.height)),
        seams_(find_counted_seams()),
        covered_(find_covered()),
        image_(source, [this] { return read_texels(); },
               {.alpha = alpha_channel(source.channels, options.premultiplied),
                .needs_floats = needs_floats(),
                .name = options.image_name,
                .threads = options.threads,
                .progress = options.progress.part(0.1, 0.16)}) {}

  std::vector<Image> run() {
    std::vector<Image> levels;
    switch (reads_of(options_.filter)) {
      case Reads::kAll:
      case Reads::kTouched:
        levels = texture_space_levels();
        break;
      case Reads::kWeighted:
        levels =
            pam_box_levels(image_.texels(), mapped(options_.progress.part(0.16, 0.2)), level_count_,
                           options_.wrap, options_.progress.part(0.2, 0.97), options_.threads);
        break;
      case Reads::kLookedUp:
        levels = fitted_levels();
        break;
    }
    for (Image& level : levels) finish(&level);
    options_.progress.report(1.0);
    return levels;
  }

 private:
  // Whether the filter does more than read the texels once, as they are.
  bool needs_floats() const {
    switch (reads_of(options_.filter)) {
      case Reads::kAll:
      case Reads::kTouched:
        return true;
      case Reads::kWeighted:
        return false;
      case Reads::kLookedUp:
        break;
    }
    return options_.reader != Reader::kLinear || options_.seam_budget != 0.0 ||
           options_.footprint != 0.0;
  }

  std::vector<SeamEdge> find_counted_seams() const {
    if (options_.seam_budget == 0.0 || !is_fit(options_.filter)) return {};
    return find_seams(surfaces_, options_.progress.part(0.0, 0.0));
  }

  std::vector<unsigned char> find_covered() const {
    if (reads_of(options_.filter) != Reads::kTouched) return {};
    std::vector<unsigned char> covered =
        touched_texels(surfaces_, width_, height_, options_.wrap, options_.progress.part(0.0, 0.1),
                       options_.threads);
    if (std::find(covered.begin(), covered.end(), 1) == covered.end()) throw_outside();
    return covered;
  }

  std::vector<unsigned char> read_texels() const {
    const Progress progress = options_.progress.part(0.11, 0.15);
    switch (reads_of(options_.filter)) {
      case Reads::kAll:
        break;
      case Reads::kTouched:
        return covered_;
      case Reads::kWeighted: {
        const std::vector<float> masses = texel_masses(mapped(progress.part(0.0, 0.3)),
                                                       progress.part(0.3, 1.0), options_.threads);
        std::vector<unsigned char> read(masses.size());
        for (std::size_t i = 0; i < masses.size(); ++i) read[i] = masses[i] > 0.0F ? 1 : 0;
        return read;
      }
      case Reads::kLookedUp:
        return looked_up_texels(surfaces_, width_, height_, options_.wrap, progress,
                                options_.threads);
    }
    return std::vector<unsigned char>(static_cast<std::size_t>(width_) * height_, 1);
  }

  TexelTriangles mapped(const Progress& progress) const {
    TexelTriangles triangles = map_to_texels(surfaces_, width_, height_, options_.wrap,
                                             MassOf::kArea, progress, options_.threads);
    check_mapped(triangles);
    return triangles;
  }

  int width(int level) const { return level_size(width_, level); }
  int height(int level) const { return level_size(height_, level); }

  std::vector<Image> texture_space_levels() const {
    const Progress progress = options_.progress.part(0.16, 0.97);
    const Kernel& kernel = *std::get<TextureSpaceFilter>(options_.filter).kernel;
    std::vector<Image> levels;
    for (int level = 1; level < level_count_; ++level) {
      const Progress part = progress.part(static_cast<double>(level - 1) / (level_count_ - 1),
                                          static_cast<double>(level) / (level_count_ - 1));
      levels.push_back(
          covered_.empty()
              ? filter_level(image_.floats(), level, kernel, options_.wrap, part, options_.threads)
              : filter_covered_level(image_.floats(), covered_, level, kernel, options_.wrap, part,
                                     options_.threads));
    }
    return levels;
  }

  std::vector<Image> fitted_levels() const {
    const auto fit = [this]<int C>() {
      return std::get<SurfaceFilter>(options_.filter) == SurfaceFilter::kTrilinear
                 ? solve_together<C>()
                 : solve_levels<C>();
    };
    switch (channels_) {
      case 1:
        return fit.operator()<1>();
      case 2:
        return fit.operator()<2>();
      case 3:
        return fit.operator()<3>();
      default:
        return fit.operator()<4>();
    }
  }

  // The means of every level's texels are what the next sees: a second sweep, for which the image
  // is its own means.
  template <int C, typename Add>
  void sweep_finer_means(const std::vector<Image>& means, const Progress& progress,
                         TargetSquares* squares, const Add& add) const {
    const std::vector<unsigned char> read =
        !needs_surface(options_.filter)
            ? std::vector<unsigned char>()
            : looked_up_texels(surfaces_, width_, height_, options_.wrap, progress.part(0.0, 0.1),
                               options_.threads);
    const Image image = tent_means(image_.floats(), read, options_.wrap, options_.threads);
    const TexelSource source(image.view());
    BlockSums of_means(width_, height_);
    BlockSums of_both(width_, height_);
    sweep_moments<C>(mapped(progress.part(0.1, 0.2)), source, options_.wrap,
                     {.first_level = first_swept_level(),
                      .last_level = static_cast<int>(means.size()),
                      .level_images = &means,
                      .threads = options_.threads},
                     progress.part(0.2, 1.0), [&](const MomentBlock<C>& block) {
                       if (block.level > 0) return add(block);
                       of_means.add(block.index, integral_with(block, image.view(), options_.wrap));
                       of_both.add(block.index,
                                   integral_with(block, image_.floats(), options_.wrap));
                     });
    squares->means = of_means.total();
    squares->image_means = of_both.total();
  }

  // Level 0 tells the integral of the image's square, which budgets of seams are shares of.
  int first_swept_level() const { return seams_.empty() ? 1 : 0; }

  // All levels there are are solved for, also where fewer are asked for.
  template <int C>
  std::vector<Image> solve_together() const {
    if (level_count_ == 1) return {};
    TrilinearSystem<C> system(width_, height_, options_.wrap);
    TargetSquares squares;
    BlockSums image_squares(width_, height_);
    sweep_moments<C>(mapped(options_.progress.part(0.16, 0.2)), image_.texels(), options_.wrap,
                     {.first_level = first_swept_level(),
                      .last_level = full_level_count(width_, height_) - 1,
                      .threads = options_.threads},
                     options_.progress.part(0.2, options_.footprint != 0.0 ? 0.35 : 0.5),
                     [&](const MomentBlock<C>& block) {
                       if (block.level > 0) return system.add(block);
                       image_squares.add(block.index,
                                         integral_with(block, image_.floats(), options_.wrap));
                     });
    squares.image = image_squares.total();
    if (options_.footprint != 0.0) {
      system.expect_finer_means();
      sweep_finer_means<C>(system.means(), options_.progress.part(0.35, 0.5), &squares,
                           [&](const MomentBlock<C>& block) { system.add_finer_means(block); });
    }
    system.set_squares(squares);
    for_each_level_of_seams(
        image_.floats(), full_level_count(width_, height_) - 2, options_.progress.part(0.5, 0.5),
        [&](int level, const std::vector<SeamLink>& links, double by_area) {
          system.add_links(level, links, by_area, options_.progress.part(0.5, 0.5));
        });
    auto solutions =
        system.solve(options_.footprint, solve_options(), {.share = options_.seam_budget},
                     options_.progress.part(0.5, 0.95));
    std::vector<Image> levels;
    for (int level = 1; level < level_count_; ++level) {
      levels.push_back(filled(std::move(solutions[level - 1].image), solutions[level - 1].used,
                              options_.progress.part(0.95, 0.97)));
    }
    return levels;
  }

  // Calls use(level, links, texels_by_area) for every level; nothing where seams do not count.
  template <typename Use>
  void for_each_level_of_seams(const ImageView& image, int last_level, const Progress& progress,
                               const Use& use) const {
    if (seams_.empty()) return;
    std::vector<SeamEdge> seams = seams_;
    weigh_seams(image, surfaces_, options_.wrap, progress, &seams);
    double area = 0.0;
    for (const Surface* surface : surfaces_) area += surface->total_area();
    // The fits count area in texels of the image.
    const double texels_by_area = static_cast<double>(width_) * height_ / area;
    for (int level = 1; level <= last_level; ++level) {
      use(level, link_seams(seams, width(level), height(level), options_.wrap, progress),
          texels_by_area);
    }
  }

  SolveOptions solve_options() const {
    SolveOptions solve;
    for (int c = 0; c < channels_; ++c) solve.ranges[c] = image_.solved_range(c, bounds());
    solve.ranges_times_alpha = image_.is_multiplied();
    solve.threads = options_.threads;
    return solve;
  }

  Image filled(Image level, const std::vector<unsigned char>& used,
               const Progress& progress) const {
    const std::vector<float> weights(used.begin(), used.end());
    fill_holes(weights, options_.wrap, channels_, progress, options_.threads, &level);
    return level;
  }

  template <int C>
  std::vector<Image> solve_levels() const {
    const bool encoded = options_.reader == Reader::kSrgbAfter;
    const bool has_footprint = options_.footprint != 0.0;
    std::vector<std::unique_ptr<BilinearSystem<C>>> systems;
    std::vector<std::unique_ptr<EncodedFit<C>>> fits;
    for (int level = 1; level < level_count_; ++level) {
      systems.push_back(
          std::make_unique<BilinearSystem<C>>(width(level), height(level), options_.wrap));
      if (!encoded) continue;
      fits.push_back(std::make_unique<EncodedFit<C>>(width(level), height(level), width_, height_,
                                                     options_.wrap));
    }
    if (systems.empty()) return {};
    BlockSums image_squares(width_, height_);
    const Image encoded_image = encoded ? encode_srgb(image_.floats(), options_.threads) : Image();
    sweep_moments<C>(mapped(options_.progress.part(0.16, 0.2)),
                     encoded ? TexelSource(encoded_image.view()) : image_.texels(), options_.wrap,
                     {.first_level = first_swept_level(),
                      .last_level = level_count_ - 1,
                      .reader = options_.reader,
                      .threads = options_.threads},
                     options_.progress.part(0.2, encoded         ? 0.3
                                                 : has_footprint ? 0.35
                                                                 : 0.5),
                     [&](const MomentBlock<C>& block) {
                       if (block.level == 0) {
                         image_squares.add(
                             block.index,
                             encoded ? integral_of_decoded_square(block)
                                     : integral_with(block, image_.floats(), options_.wrap));
                         return;
                       }
                       systems[block.level - 1]->add(block);
                       if (encoded) fits[block.level - 1]->add(block);
                     });
    TargetSquares squares{.image = image_squares.total()};

    if (has_footprint) {
      std::vector<Image> means(1);
      for (int level = 1; level + 1 < level_count_; ++level) {
        means.push_back(systems[level - 1]->means());
      }
      for (const auto& system : systems) system->expect_finer_means();
      sweep_finer_means<C>(
          means, options_.progress.part(0.35, 0.5), &squares,
          [&](const MomentBlock<C>& block) { systems[block.level - 1]->add_finer_means(block); });
    }

    double from = encoded ? 0.3 : 0.5;
    const Progress linking = options_.progress.part(from, from);
    // Of encoded levels only alpha is solved for here, the fourth channel.
    if (!encoded || C > encoded_channels(C)) {
      for_each_level_of_seams(image_.floats(), level_count_ - 1, linking,
                              [&](int level, const std::vector<SeamLink>& links, double by_area) {
                                systems[level - 1]->add_links(links, by_area, linking);
                              });
    }
    if (encoded) {
      for_each_level_of_seams(encoded_image.view(), level_count_ - 1, linking,
                              [&](int level, const std::vector<SeamLink>& links, double by_area) {
                                fits[level - 1]->add_links(links, by_area, squares.image);
                              });
    }
    SeamBudget budget{.share = options_.seam_budget,
                      .first_channel = encoded ? encoded_channels(C) : 0};
    SeamBudget encoded_budget{.share = options_.seam_budget};
    const SolveOptions solve = solve_options();
    std::vector<Image> levels;
    for (int level = 1; level < level_count_; ++level) {
      // A level has a quarter of the texels of the one before.
      const double to = from + 0.75 * (0.97 - from);
      const Progress part = options_.progress.part(from, to);
      systems[level - 1]->set_squares(squares);
      auto solution = systems[level - 1]->solve(target_shares(options_.footprint), solve, &budget,
                                                part.part(0.0, encoded ? 0.2 : 0.8));
      squares = systems[level - 1]->own_squares();
      systems[level - 1].reset();
      if (encoded) {
        fit_encoded(fits[level - 1].get(), solution.used, solve, &encoded_budget,
                    part.part(0.2, 0.8), &solution.image);
        fits[level - 1].reset();
      }
      from = to;
      levels.push_back(filled(std::move(solution.image), solution.used, part.part(0.8, 1.0)));
    }
    return levels;
  }

  template <int C>
  void fit_encoded(EncodedFit<C>* fit, const std::vector<unsigned char>& used, SolveOptions solve,
                   SeamBudget* budget, const Progress& progress, Image* level) const {
    for (int c = 0; c < encoded_channels(C); ++c) {
      solve.ranges[c] = {linear_to_srgb(solve.ranges[c].low), linear_to_srgb(solve.ranges[c].high)};
    }
    const Image start = encode_srgb(level->view(), options_.threads);
    *level = decode_srgb(fit->solve(start, used, solve, budget, progress).view(), options_.threads);
  }

  ValueRange bounds() const {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    return {options_.bounds.low.value_or(-kInfinity), options_.bounds.high.value_or(kInfinity)};
  }

  void finish(Image* level) const {
    image_.divide_by_alpha(options_.wrap, options_.progress.part(0.97, 0.98), options_.threads,
                           level);
    const ValueRange range = bounds();
    parallel_for(level->height, options_.threads, options_.progress.part(0.98, 0.99),
                 [&](std::int64_t y) {
                   float* row = level->texel(0, static_cast<int>(y));
                   for (int i = 0; i < level->width * level->channels; ++i) {
                     row[i] = std::min(std::max(row[i], range.low), range.high);
                   }
                 });
  }

  const std::vector<const Surface*>& surfaces_;
  const MipmapOptions& options_;
  int width_;
  int height_;
  int channels_;
  int level_count_;
  std::vector<SeamEdge> seams_;  // that count in the fits
  std::vector<unsigned char> covered_;
  FilteredImage image_;
};

std::string fit_names() {
  std::string names;
  for (const MipmapFilter& filter : mipmap_filters()) {
    if (is_fit(filter)) names += (names.empty() ? "" : ", ") + name_of(filter);
  }
  return names;
}

Surface unit_square() {
  Surface square;
  square.positions = {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {1.0, 1.0, 0.0}, {0.0, 1.0, 0.0}};
  square.triangles = {{0, 1, 2}, {0, 2, 3}};
  square.uvs = {{{{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}}}, {{{0.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}}}};
  square.areas = {0.5, 0.5};
  return square;
}

void check_options(const TexelSource& image, const std::vector<const Surface*>& surfaces,
                   const MipmapOptions& options) {
  const int full = full_level_count(image.width, image.height);
  if (options.levels < 0 || options.levels > full) {
    throw_invalid("levels: " + std::to_string(options.levels) + " asked for, but an image of " +
                  std::to_string(image.width) + " x " + std::to_string(image.height) +
                  " texels has 1 to " + std::to_string(full));
  }
  const Bounds& bounds = options.bounds;
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const float low = bounds.low.value_or(-kInfinity);
  const float high = bounds.high.value_or(kInfinity);
  if (!(low <= high) || low == kInfinity || high == -kInfinity) {
    throw_invalid("bounds: the low bound is " + (bounds.low ? to_text(*bounds.low) : "open") +
                  " and the high bound is " + (bounds.high ? to_text(*bounds.high) : "open") +
                  "; numbers are needed, and low must not be above high");
  }
  if (!(options.seam_budget >= 0.0) || !std::isfinite(options.seam_budget)) {
    throw_invalid("seam_budget: " + to_text(options.seam_budget) +
                  "; a finite number of at least 0 is needed");
  }
  if (!(options.footprint >= 0.0 && options.footprint <= kMostFootprint)) {
    throw_invalid("footprint: " + to_text(options.footprint) + "; 0 to " + to_text(kMostFootprint) +
                  " texels of a level are allowed");
  }
  if (options.footprint != 0.0 && (!is_fit(options.filter) || options.reader != Reader::kLinear)) {
    throw_invalid("footprint: " + to_text(options.footprint) +
                  "; others than 0 go with least squares (" + fit_names() +
                  ") for the linear reader");
  }
  if (options.threads < 0) {
    throw_invalid("threads: " + std::to_string(options.threads) +
                  "; a positive number is needed, or 0 for all processors");
  }
  if (options.filter == MipmapFilter(SurfaceFilter::kTrilinear) &&
      options.reader != Reader::kLinear) {
    throw_invalid(
        "reader: 'srgb-after' goes with pam-bilinear: such readers do not interpolate between "
        "levels; use linear for pam-trilinear");
  }
  if (!needs_surface(options.filter)) return;
  if (surfaces.empty()) {
    std::string others;
    for (const MipmapFilter& filter : mipmap_filters()) {
      if (!needs_surface(filter)) others += (others.empty() ? "" : ", ") + name_of(filter);
    }
    throw_invalid("surface: none was given, and " + name_of(options.filter) +
                  " needs one; without a surface use one of " + others);
  }
  check_surface_area(surfaces);
}

}  // namespace

std::vector<Image> coarser_levels(const TexelSource& image,
                                  const std::vector<const Surface*>& surfaces,
                                  const MipmapOptions& options) {
  check_channels({nullptr, image.width, image.height, image.channels}, options.image_name);
  check_options(image, surfaces, options);
  if (is_fit(options.filter) && !needs_surface(options.filter)) {
    const Surface square = unit_square();
    return Builder(image, {&square}, options).run();
  }
  return Builder(image, surfaces, options).run();
}

std::vector<Image> mipmaps(const ImageView& image, const std::vector<const Surface*>& surfaces,
                           const MipmapOptions& options) {
  std::vector<Image> levels = coarser_levels(image, surfaces, options);
  levels.insert(levels.begin(), Image(image));
  return levels;
}

}  // namespace prefilter
