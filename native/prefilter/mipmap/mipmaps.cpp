// Chapter 7. Equation 7.1 with a box is kPamBox, where the texels of the image are boxes too, so
// that an even parameterization gives the plain box filter; section 7.3 level by level is
// kPamBilinear.
#include "prefilter/mipmap/mipmaps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>

#include "prefilter/base/error.h"
#include "prefilter/base/filterable.h"
#include "prefilter/base/parallel.h"
#include "prefilter/base/text.h"
#include "prefilter/color/transfer.h"
#include "prefilter/filters/push_pull.h"
#include "prefilter/mipmap/bilinear_system.h"
#include "prefilter/mipmap/coverage.h"
#include "prefilter/mipmap/encoded_fit.h"
#include "prefilter/mipmap/level_grid.h"
#include "prefilter/mipmap/levels.h"
#include "prefilter/mipmap/moment_sweep.h"
#include "prefilter/mipmap/seams.h"
#include "prefilter/mipmap/texel_triangles.h"
#include "prefilter/mipmap/texture_space.h"
#include "prefilter/mipmap/trilinear_system.h"

namespace prefilter {
namespace {

struct NamedFilter {
  const char* name;
  MipmapFilter filter;
};

constexpr NamedFilter kFilters[] = {
    {"box", MipmapFilter::kBox},
    {"tent", MipmapFilter::kTent},
    {"lanczos3", MipmapFilter::kLanczos3},
    {"box-covered", MipmapFilter::kBoxCovered},
    {"tent-covered", MipmapFilter::kTentCovered},
    {"lanczos3-covered", MipmapFilter::kLanczos3Covered},
    {"pam-box", MipmapFilter::kPamBox},
    {"pam-bilinear", MipmapFilter::kPamBilinear},
    {"pam-trilinear", MipmapFilter::kPamTrilinear},
};

// Which texels of the image a filter reads.
enum class Reads { kAll, kTouched, kWeighted, kLookedUp };

Reads reads_of(MipmapFilter filter) {
  switch (filter) {
    case MipmapFilter::kBox:
    case MipmapFilter::kTent:
    case MipmapFilter::kLanczos3:
      return Reads::kAll;
    case MipmapFilter::kBoxCovered:
    case MipmapFilter::kTentCovered:
    case MipmapFilter::kLanczos3Covered:
      return Reads::kTouched;
    case MipmapFilter::kPamBox:
      return Reads::kWeighted;
    case MipmapFilter::kPamBilinear:
    case MipmapFilter::kPamTrilinear:
      return Reads::kLookedUp;
  }
  return Reads::kAll;
}

Kernel kernel_of(MipmapFilter filter) {
  switch (filter) {
    case MipmapFilter::kTent:
    case MipmapFilter::kTentCovered:
      return Kernel::kTent;
    case MipmapFilter::kLanczos3:
    case MipmapFilter::kLanczos3Covered:
      return Kernel::kLanczos3;
    default:
      return Kernel::kBox;
  }
}

class Builder {
 public:
  Builder(const TexelSource& source, const std::vector<const Surface*>& surfaces,
          const MipmapOptions& options)
      : source_(source), surfaces_(surfaces), options_(options), image_(source.floats()) {
    level_count_ =
        options.levels > 0 ? options.levels : full_level_count(source.width, source.height);
    if (!source.has_bytes()) return;
    if (reads_bytes()) {
      image_ = {nullptr, source.width, source.height, source.channels};
      return;
    }
    copy_ = Image(source.width, source.height, source.channels);
    image_ = copy_.view();
    for_each_texel(&copy_, Progress(), [&](std::size_t i, float* texel) {
      const auto width = static_cast<std::size_t>(source.width);
      const std::uint8_t* bytes =
          source.byte_texel(static_cast<int>(i % width), static_cast<int>(i / width));
      for (int c = 0; c < source.channels; ++c) texel[c] = source.value(bytes[c], c);
    });
  }

  std::vector<Image> run() {
    if (image_.data != nullptr) {
      check_texels();
      if (image_.channels == 4 && !options_.premultiplied) premultiply();
    }
    std::vector<Image> levels;
    switch (reads_of(options_.filter)) {
      case Reads::kAll:
      case Reads::kTouched:
        levels = texture_space_levels();
        break;
      case Reads::kWeighted:
        levels = pam_box_levels();
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
  // Whether the filter needs no more than to read the texels once, as they are.
  bool reads_bytes() const {
    if (reads_of(options_.filter) != Reads::kLookedUp || options_.reader != Reader::kLinear ||
        options_.seam_weight != 0.0) {
      return false;
    }
    if (source_.channels < 4 || options_.premultiplied) return true;
    constexpr std::uint8_t kOpaque = 255;
    for (int y = 0; y < source_.height; ++y) {
      const std::uint8_t* texel = source_.byte_texel(0, y);
      for (int x = 0; x < source_.width; ++x, texel += 4) {
        if (texel[3] != kOpaque) return false;
      }
    }
    return true;
  }

  // What the fits read: the bytes as they are, or the floats that were made of them.
  TexelSource texels() const { return image_.data == nullptr ? source_ : TexelSource(image_); }

  // Refuses a texel that counts and is not finite; one that does not count becomes 0.
  void check_texels() {
    if (reads_of(options_.filter) == Reads::kTouched) {
      covered_ = touched_texels(surfaces_, image_.width, image_.height, options_.wrap,
                                options_.progress.part(0.0, 0.1), options_.threads);
      if (std::find(covered_.begin(), covered_.end(), 1) == covered_.end()) throw_outside();
    }
    if (all_filterable(image_, options_.progress.part(0.1, 0.11), options_.threads)) return;
    const std::vector<unsigned char> read = read_texels();
    Image& copy = own_copy();
    for (std::size_t i = 0; i < read.size(); ++i) {
      float* texel = copy.data.data() + i * static_cast<std::size_t>(image_.channels);
      for (int c = 0; c < image_.channels; ++c) {
        if (is_filterable(texel[c])) continue;
        if (read[i] != 0) {
          const auto width = static_cast<std::size_t>(image_.width);
          throw_invalid("image: the texel in row " + std::to_string(i / width) + ", column " +
                        std::to_string(i % width) + " holds " + to_text(texel[c]) + " in channel " +
                        std::to_string(c) + "; texels that count must be finite, and at most 1e30");
        }
        texel[c] = 0.0F;
      }
    }
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
        return looked_up_texels(surfaces_, image_.width, image_.height, options_.wrap, progress,
                                options_.threads);
    }
    return std::vector<unsigned char>(image_.texel_count(), 1);
  }

  Image& own_copy() {
    if (copy_.data.empty()) {
      copy_ = Image(image_);
      image_ = copy_.view();
    }
    return copy_;
  }

  // Multiplies colours by alpha, and notes the range of the colours that are seen at all, unless
  // every texel that counts is opaque.
  void premultiply() {
    const auto opaque = [this](std::size_t i) { return image_.data[4 * i + 3] == 1.0F; };
    std::size_t i = 0;
    while (i < image_.texel_count() && opaque(i)) ++i;
    if (i == image_.texel_count()) return;
    const std::vector<unsigned char> read = read_texels();
    while (i < read.size() && (read[i] == 0 || opaque(i))) ++i;
    if (i == read.size()) return;

    straight_alpha_ = true;
    Image& copy = own_copy();
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    constexpr ValueRange kNothing = {kInfinity, -kInfinity};
    std::vector<std::array<ValueRange, 3>> rows(static_cast<std::size_t>(copy.height));
    for (std::array<ValueRange, 3>& row : rows) row.fill(kNothing);
    const auto width = static_cast<std::size_t>(copy.width);
    for_each_texel(&copy, options_.progress.part(0.15, 0.16), [&](std::size_t at, float* texel) {
      texel[3] = std::clamp(texel[3], 0.0F, 1.0F);
      for (int c = 0; c < 3; ++c) {
        ValueRange& seen = rows[at / width][c];
        if (texel[3] > 0.0F && read[at] != 0) seen = widened(seen, {texel[c], texel[c]});
        texel[c] *= texel[3];
      }
    });
    colours_.fill(kNothing);
    for (const std::array<ValueRange, 3>& row : rows) {
      for (int c = 0; c < 3; ++c) colours_[c] = widened(colours_[c], row[c]);
    }
    for (ValueRange& own : colours_) {
      if (!(own.low <= own.high)) own = {0.0F, 0.0F};
    }
  }

  static ValueRange widened(const ValueRange& a, const ValueRange& b) {
    return {std::min(a.low, b.low), std::max(a.high, b.high)};
  }

  TexelTriangles mapped(const Progress& progress) const {
    TexelTriangles triangles = map_to_texels(surfaces_, image_.width, image_.height, options_.wrap,
                                             MassOf::kArea, progress);
    check_mapped(triangles);
    return triangles;
  }

  int width(int level) const { return level_size(image_.width, level); }
  int height(int level) const { return level_size(image_.height, level); }

  std::vector<Image> texture_space_levels() const {
    const Progress progress = options_.progress.part(0.16, 0.97);
    const Kernel kernel = kernel_of(options_.filter);
    std::vector<Image> levels;
    for (int level = 1; level < level_count_; ++level) {
      const Progress part = progress.part(static_cast<double>(level - 1) / (level_count_ - 1),
                                          static_cast<double>(level) / (level_count_ - 1));
      levels.push_back(
          covered_.empty()
              ? filter_level(image_, level, kernel, options_.wrap, part, options_.threads)
              : filter_covered_level(image_, covered_, level, kernel, options_.wrap, part,
                                     options_.threads));
    }
    return levels;
  }

  std::vector<Image> pam_box_levels() const {
    const Progress& progress = options_.progress;
    const AxisTexels columns(image_.width, level_count_);
    const AxisTexels rows(image_.height, level_count_);
    MassSums sums{Image(columns.cell_count(0), rows.cell_count(0), image_.channels),
                  cell_masses(mapped(progress.part(0.16, 0.2)), columns.lines(0), rows.lines(0),
                              progress.part(0.2, 0.6), options_.threads)};
    parallel_for(sums.image.height, options_.threads, progress.part(0.6, 0.65),
                 [&](std::int64_t y) {
                   float* sum = sums.image.texel(0, static_cast<int>(y));
                   const float* mass = sums.masses.data() + y * sums.image.width;
                   for (const int x : columns.texels(0)) {
                     const float* colour = image_.texel(x, rows.texels(0)[y]);
                     for (int c = 0; c < image_.channels; ++c) *sum++ = *mass * colour[c];
                     ++mass;
                   }
                 });
    std::vector<Image> levels;
    double from = 0.65;
    for (int level = 1; level < level_count_; ++level) {
      const Progress part = progress.part(from, from + 0.75 * (0.97 - from));
      from += 0.75 * (0.97 - from);
      sums = gathered(sums, columns.parents(level - 1), columns.cell_count(level),
                      rows.parents(level - 1), rows.cell_count(level), part.part(0.0, 0.3));
      const bool nested =
          columns.cell_count(level) == width(level) && rows.cell_count(level) == height(level);
      MassSums texels = nested ? sums
                               : gathered(sums, columns.texels(level), width(level),
                                          rows.texels(level), height(level), part.part(0.3, 0.5));
      for_each_texel(&texels.image, part.part(0.5, 0.6), [&](std::size_t i, float* sum) {
        const float mass = texels.masses[i];
        for (int c = 0; c < image_.channels; ++c) sum[c] = mass > 0.0F ? sum[c] / mass : 0.0F;
      });
      fill_holes(texels.masses, options_.wrap, image_.channels, part.part(0.6, 1.0),
                 options_.threads, &texels.image);
      levels.push_back(std::move(texels.image));
    }
    return levels;
  }

  // Calls use(index, texel) for every texel, rows in parallel.
  template <typename Use>
  void for_each_texel(Image* image, const Progress& progress, const Use& use) const {
    parallel_for(image->height, options_.threads, progress, [&](std::int64_t y) {
      float* texel = image->texel(0, static_cast<int>(y));
      const std::size_t first = static_cast<std::size_t>(y) * image->width;
      for (int x = 0; x < image->width; ++x, texel += image->channels) use(first + x, texel);
    });
  }

  // Sums of mass times colour, and of mass, cell by cell.
  struct MassSums {
    Image image;
    std::vector<float> masses;
  };

  // The sums over blocks of cells: those of column x go to column `to_columns[x]` of `width`, and
  // the same for rows. Both rise.
  MassSums gathered(const MassSums& from, const std::vector<int>& to_columns, int width,
                    const std::vector<int>& to_rows, int height, const Progress& progress) const {
    const int channels = from.image.channels;
    MassSums to{Image(width, height, channels),
                std::vector<float>(static_cast<std::size_t>(width) * height)};
    parallel_for(height, options_.threads, progress, [&](std::int64_t row) {
      const auto [first, last] = std::equal_range(to_rows.begin(), to_rows.end(), row);
      float* row_masses = to.masses.data() + row * width;
      float* row_sums = to.image.texel(0, static_cast<int>(row));
      for (auto y = first - to_rows.begin(); y < last - to_rows.begin(); ++y) {
        const float* sum = from.image.texel(0, static_cast<int>(y));
        const float* mass = from.masses.data() + y * from.image.width;
        for (const int column : to_columns) {
          for (int c = 0; c < channels; ++c) row_sums[column * channels + c] += *sum++;
          row_masses[column] += *mass++;
        }
      }
    });
    return to;
  }

  std::vector<Image> fitted_levels() const {
    const auto fit = [this]<int C>() {
      return options_.filter == MipmapFilter::kPamTrilinear ? solve_together<C>()
                                                            : solve_levels<C>();
    };
    switch (image_.channels) {
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

  // All levels there are are solved for, also where fewer are asked for.
  template <int C>
  std::vector<Image> solve_together() const {
    if (level_count_ == 1) return {};
    TrilinearSystem<C> system(image_.width, image_.height, options_.wrap);
    sweep_moments<C>(mapped(options_.progress.part(0.16, 0.2)), texels(), options_.wrap,
                     {.first_level = 1,
                      .last_level = full_level_count(image_.width, image_.height) - 1,
                      .threads = options_.threads},
                     options_.progress.part(0.2, 0.5),
                     [&](const MomentBlock<C>& block) { system.add(block); });
    for_each_level_of_seams(image_, full_level_count(image_.width, image_.height) - 2,
                            [&](int level, const std::vector<SeamLink>& links, double weight) {
                              system.add_links(level, links, weight);
                            });
    auto solutions = system.solve(solve_options(), options_.progress.part(0.5, 0.95));
    std::vector<Image> levels;
    for (int level = 1; level < level_count_; ++level) {
      levels.push_back(filled(std::move(solutions[level - 1].image), solutions[level - 1].used,
                              options_.progress.part(0.95, 0.97)));
    }
    return levels;
  }

  // Calls use(level, links, weight) for every level; nothing where seams do not count.
  template <typename Use>
  void for_each_level_of_seams(const ImageView& image, int last_level, const Use& use) const {
    if (options_.seam_weight == 0.0) return;
    std::vector<SeamEdge> seams = find_seams(surfaces_);
    weigh_seams(image, surfaces_, options_.wrap, &seams);
    double area = 0.0;
    for (const Surface* surface : surfaces_) area += surface->total_area();
    // The fits count area in texels of the image.
    const double texels_by_area = static_cast<double>(image_.width) * image_.height / area;
    for (int level = 1; level <= last_level; ++level) {
      use(level, link_seams(seams, width(level), height(level), options_.wrap),
          options_.seam_weight * texels_by_area);
    }
  }

  SolveOptions solve_options() const {
    SolveOptions solve;
    for (int c = 0; c < image_.channels; ++c) solve.ranges[c] = solved_range(c);
    solve.ranges_times_alpha = straight_alpha_;
    solve.threads = options_.threads;
    return solve;
  }

  Image filled(Image level, const std::vector<unsigned char>& used,
               const Progress& progress) const {
    const std::vector<float> weights(used.begin(), used.end());
    fill_holes(weights, options_.wrap, image_.channels, progress, options_.threads, &level);
    return level;
  }

  template <int C>
  std::vector<Image> solve_levels() const {
    const bool encoded = options_.reader == Reader::kSrgbAfter;
    std::vector<std::unique_ptr<BilinearSystem<C>>> systems;
    std::vector<std::unique_ptr<EncodedFit<C>>> fits;
    for (int level = 1; level < level_count_; ++level) {
      systems.push_back(
          std::make_unique<BilinearSystem<C>>(width(level), height(level), options_.wrap));
      if (!encoded) continue;
      fits.push_back(std::make_unique<EncodedFit<C>>(width(level), height(level), image_.width,
                                                     image_.height, options_.wrap));
    }
    if (systems.empty()) return {};
    const Image encoded_image = encoded ? encode_srgb(image_, options_.threads) : Image();
    sweep_moments<C>(mapped(options_.progress.part(0.16, 0.2)),
                     encoded ? TexelSource(encoded_image.view()) : texels(), options_.wrap,
                     {.first_level = 1,
                      .last_level = level_count_ - 1,
                      .reader = options_.reader,
                      .threads = options_.threads},
                     options_.progress.part(0.2, encoded ? 0.3 : 0.5),
                     [&](const MomentBlock<C>& block) {
                       systems[block.level - 1]->add(block);
                       if (encoded) fits[block.level - 1]->add(block);
                     });

    for_each_level_of_seams(image_, level_count_ - 1,
                            [&](int level, const std::vector<SeamLink>& links, double weight) {
                              systems[level - 1]->add_links(links, weight);
                            });
    if (encoded) {
      for_each_level_of_seams(encoded_image.view(), level_count_ - 1,
                              [&](int level, const std::vector<SeamLink>& links, double weight) {
                                fits[level - 1]->add_links(links, weight);
                              });
    }
    const SolveOptions solve = solve_options();
    std::vector<Image> levels;
    double from = encoded ? 0.3 : 0.5;
    for (int level = 1; level < level_count_; ++level) {
      // A level has a quarter of the texels of the one before.
      const double to = from + 0.75 * (0.97 - from);
      const Progress part = options_.progress.part(from, to);
      auto solution = systems[level - 1]->solve(solve, part.part(0.0, encoded ? 0.2 : 0.8));
      systems[level - 1].reset();
      if (encoded) {
        fit_encoded(fits[level - 1].get(), solution.used, solve, part.part(0.2, 0.8),
                    &solution.image);
        fits[level - 1].reset();
      }
      from = to;
      levels.push_back(filled(std::move(solution.image), solution.used, part.part(0.8, 1.0)));
    }
    return levels;
  }

  template <int C>
  void fit_encoded(EncodedFit<C>* fit, const std::vector<unsigned char>& used, SolveOptions solve,
                   const Progress& progress, Image* level) const {
    for (int c = 0; c < encoded_channels(C); ++c) {
      solve.ranges[c] = {linear_to_srgb(solve.ranges[c].low), linear_to_srgb(solve.ranges[c].high)};
    }
    const Image start = encode_srgb(level->view(), options_.threads);
    *level = decode_srgb(fit->solve(start, used, solve, progress).view(), options_.threads);
  }

  ValueRange bounds() const {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    return {options_.bounds.low.value_or(-kInfinity), options_.bounds.high.value_or(kInfinity)};
  }

  // What a channel may be while it is solved for. With straight alpha, a colour that is seen lies
  // within the bounds and within the image's own range: it is the quotient of two solutions, and
  // where little is covered a small error of either would make it anything.
  ValueRange solved_range(int channel) const {
    if (!straight_alpha_) return bounds();
    if (channel == 3) return {0.0F, 1.0F};
    const ValueRange limits = bounds();
    const ValueRange& own = colours_[channel];
    return {std::clamp(own.low, limits.low, limits.high),
            std::clamp(own.high, limits.low, limits.high)};
  }

  void finish(Image* level) const {
    if (straight_alpha_) unpremultiply(level);
    const ValueRange range = bounds();
    for_each_texel(level, options_.progress.part(0.98, 0.99), [&](std::size_t, float* texel) {
      for (int c = 0; c < level->channels; ++c) {
        texel[c] = std::min(std::max(texel[c], range.low), range.high);
      }
    });
  }

  void unpremultiply(Image* level) const {
    // What is covered less than this cannot be seen, and its colour is mostly rounding.
    constexpr float kLeastAlpha = 1e-3F;
    std::vector<float> weights(level->view().texel_count());
    for_each_texel(level, options_.progress.part(0.97, 0.98), [&](std::size_t i, float* texel) {
      const float alpha = texel[3];
      weights[i] = alpha > kLeastAlpha ? alpha : 0.0F;
      for (int c = 0; c < 3; ++c) {
        const float colour = weights[i] > 0.0F ? texel[c] / alpha : 0.0F;
        texel[c] = std::min(std::max(colour, colours_[c].low), colours_[c].high);
      }
      texel[3] = std::clamp(alpha, 0.0F, 1.0F);
    });
    fill_holes(weights, options_.wrap, 3, options_.progress.part(0.97, 0.98), options_.threads,
               level);
  }

  const TexelSource& source_;
  const std::vector<const Surface*>& surfaces_;
  const MipmapOptions& options_;
  ImageView image_;  // what is filtered: the source, or a copy of it; no data where bytes are read
  Image copy_;
  std::vector<unsigned char> covered_;
  int level_count_ = 0;
  bool straight_alpha_ = false;
  std::array<ValueRange, 3> colours_{};  // of texels with alpha, before they are multiplied by it
};

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
  if (!(options.seam_weight >= 0.0) || !std::isfinite(options.seam_weight)) {
    throw_invalid("seam_weight: " + to_text(options.seam_weight) +
                  "; a finite number of at least 0 is needed");
  }
  if (options.threads < 0) {
    throw_invalid("threads: " + std::to_string(options.threads) +
                  "; a positive number is needed, or 0 for all processors");
  }
  if (options.filter == MipmapFilter::kPamTrilinear && options.reader != Reader::kLinear) {
    throw_invalid(
        "reader: 'srgb-after' goes with pam-bilinear: such readers do not interpolate between "
        "levels; use linear for pam-trilinear");
  }
  if (reads_of(options.filter) == Reads::kAll) return;
  if (surfaces.empty()) {
    throw_invalid(
        "surface: none was given, and this filter needs one; without a surface use box, tent "
        "or lanczos3");
  }
  check_surface_area(surfaces);
}

}  // namespace

MipmapFilter mipmap_filter(const std::string& name) {
  std::string names;
  for (const NamedFilter& filter : kFilters) {
    if (name == filter.name) return filter.filter;
    names += (names.empty() ? "" : ", ") + std::string(filter.name);
  }
  throw_invalid("filter: '" + name + "' is not one of " + names);
}

Reader reader_of(const std::string& name) {
  if (name == "linear") return Reader::kLinear;
  if (name == "srgb-after") return Reader::kSrgbAfter;
  throw_invalid("reader: '" + name + "' is not one of linear, srgb-after");
}

void check_mipmap_image(const ImageView& image) {
  if (image.channels < 1 || image.channels > kMaxChannels) {
    throw_invalid("image: " + std::to_string(image.channels) + " channels; 1 to 4 are allowed");
  }
}

void check_surface_area(const std::vector<const Surface*>& surfaces) {
  double area = 0.0;
  for (const Surface* surface : surfaces) area += surface->total_area();
  if (!(area > 0.0) || !std::isfinite(area)) {
    throw_invalid("surface: the triangles have an area of " + to_text(area) +
                  " in all; a positive, finite one is needed");
  }
}

void throw_outside() {
  throw_invalid(
      "surface: none of it lies inside of the image, and with the wrap mode border only what "
      "does counts; use clamp or repeat, or move the uvs");
}

void check_mapped(const TexelTriangles& triangles) {
  if (!(triangles.total_mass > 0.0)) throw_outside();
}

std::vector<Image> coarser_levels(const TexelSource& image,
                                  const std::vector<const Surface*>& surfaces,
                                  const MipmapOptions& options) {
  check_mipmap_image({nullptr, image.width, image.height, image.channels});
  check_options(image, surfaces, options);
  return Builder(image, surfaces, options).run();
}

std::vector<Image> mipmaps(const ImageView& image, const std::vector<const Surface*>& surfaces,
                           const MipmapOptions& options) {
  std::vector<Image> levels = coarser_levels(image, surfaces, options);
  levels.insert(levels.begin(), Image(image));
  return levels;
}

}  // namespace prefilter
