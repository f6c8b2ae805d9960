// SPDX-License-Identifier: GPL-3.0-or-later

// Section 7.3: SurfaceFilter::kBilinear fits level by level, SurfaceFilter::kTrilinear all levels
// together.
#include "prefilter/textures/mipmap/fitted_levels.h"

#include <array>
#include <utility>

#include "prefilter/geometry/texels/coverage.h"
#include "prefilter/geometry/texels/texel_triangles.h"
#include "prefilter/images/filters/push_pull.h"
#include "prefilter/images/filters/tent_means.h"
#include "prefilter/images/transfer.h"
#include "prefilter/textures/mipmap/argument_checks.h"
#include "prefilter/textures/mipmap/level_sums.h"
#include "prefilter/textures/mipmap/trilinear_system.h"
#include "prefilter/textures/texels/levels.h"

namespace prefilter {
namespace {

TexelTriangles mapped(const std::vector<const Surface*>& surfaces, const TexelSource& image,
                      WrapModes wrap, const Run& run) {
  TexelTriangles triangles =
      map_to_texels(surfaces, image.width, image.height, wrap, MassOf::kArea, run);
  check_mapped(triangles);
  return triangles;
}

// Assembles the systems of all levels and the squares for their errors. `swept` is the image as its
// reader looks it up.
template <int C, typename Systems>
TargetSquares sum_up(const FilteredImage& image, const TexelSource& swept,
                     const std::vector<const Surface*>& surfaces, bool has_squares, int last_level,
                     const MipmapOptions& options, const Run& run, Systems* systems) {
  const WrapModes wrap = options.wrap;
  const int threads = options.run.threads();
  const bool has_footprint = options.footprint != 0.0;
  Image means;
  if (has_footprint) {
    systems->expect_finer_means();
    const std::vector<unsigned char> read =
        needs_surface(options.filter)
            ? looked_up_texels(surfaces, swept.width, swept.height, wrap, run.part(0.0, 0.1))
            : std::vector<unsigned char>();
    means = tent_means(image.floats(), read, wrap, threads);
  }
  const TexelTriangles triangles = mapped(surfaces, swept, wrap, run.part(0.1, 0.2));
  const TargetSquares squares = sum_image<C>(
      triangles, {swept, image.floats(), has_footprint ? &means : nullptr}, wrap, options.reader,
      has_squares, last_level, run.part(0.2, 1.0), [&](const MomentBlock<C>& block) {
        systems->add(block);
        if (block.means != nullptr) systems->add_finer_means(block);
      });
  if (has_footprint) systems->add_coupled_means(run.part(1.0, 1.0));
  return squares;
}

// Calls add(level, links, texels_by_area) for levels 1 to last_level if there are seams. The links
// are between texels of `image`.
template <typename Add>
void link_levels(std::vector<SeamEdge> seams, const ImageView& image,
                 const std::vector<const Surface*>& surfaces, WrapModes wrap, int last_level,
                 const Run& run, const Add& add) {
  if (seams.empty()) return;
  weigh_seams(image, surfaces, wrap, run, &seams);
  double area = 0.0;
  for (const Surface* surface : surfaces) area += surface->total_area();
  // The fits measure area in texels of the image.
  const double texels_by_area = static_cast<double>(image.width) * image.height / area;
  for (int level = 1; level <= last_level; ++level) {
    add(level,
        link_seams(seams, level_size(image.width, level), level_size(image.height, level), wrap,
                   run),
        texels_by_area);
  }
}

Image filled(Image level, const std::vector<unsigned char>& used, WrapModes wrap, const Run& run) {
  const std::vector<float> weights(used.begin(), used.end());
  fill_holes(weights, wrap, level.channels, run, &level);
  return level;
}

// Solves for all levels down to 1 x 1, even if fewer are requested.
template <int C>
std::vector<Image> solve_together(const FilteredImage& image,
                                  const std::vector<const Surface*>& surfaces,
                                  const std::vector<SeamEdge>& seams, const SolveOptions& solve,
                                  const MipmapOptions& options, int level_count, const Run& run) {
  const TexelSource texels = image.texels();
  const int last_level = full_level_count(texels.width, texels.height) - 1;
  TrilinearSystem<C> system(texels.width, texels.height, options.wrap);
  system.set_squares(sum_up<C>(image, texels, surfaces, !seams.empty(), last_level, options,
                               run.part(0.0, 0.4), &system));
  const Run linking = run.part(0.4, 0.4);
  link_levels(seams, image.floats(), surfaces, options.wrap, last_level - 1, linking,
              [&](int level, const std::vector<SeamLink>& links, double by_area) {
                system.add_links(level, links, by_area, linking);
              });
  auto solutions =
      system.solve(options.footprint, solve, {.share = options.seam_budget}, run.part(0.4, 0.97));
  std::vector<Image> levels;
  for (int level = 1; level < level_count; ++level) {
    auto& [own, used, sweeps] = solutions[level - 1];
    levels.push_back(filled(std::move(own), used, options.wrap, run.part(0.97, 1.0)));
  }
  return levels;
}

// Fits the colors of a level to a decoding reader, starting from a fit to a linear one.
template <int C>
Image fit_encoded(EncodedFit<C>* fit, const Image& level, const std::vector<unsigned char>& used,
                  SolveOptions solve, SeamBudget* budget, const Run& run) {
  for (int c = 0; c < encoded_channels(C); ++c) {
    solve.ranges[c] = {linear_to_srgb(solve.ranges[c].low), linear_to_srgb(solve.ranges[c].high)};
  }
  const Image start = encode_srgb(level.view(), run.threads());
  return decode_srgb(fit->solve(start, used, solve, budget, run).view(), run.threads());
}

// Solves level after level, and frees each system afterwards.
template <int C>
std::vector<Image> solve_in_turn(LevelSystems<C> systems, TargetSquares squares,
                                 const SolveOptions& solve, const MipmapOptions& options,
                                 const Run& run) {
  const bool is_encoded = !systems.encoded.empty();
  // The linear systems of encoded levels only determine alpha, the fourth channel.
  SeamBudget budget{.share = options.seam_budget,
                    .first_channel = is_encoded ? encoded_channels(C) : 0};
  SeamBudget encoded_budget{.share = options.seam_budget};
  std::vector<Image> levels;
  double from = 0.0;
  for (std::size_t k = 0; k < systems.linear.size(); ++k) {
    // Each level has a quarter of the texels of the one before.
    const double to = from + 0.75 * (1.0 - from);
    const Run part = run.part(from, std::exchange(from, to));
    const auto system = std::move(systems.linear[k]);
    system->set_squares(squares);
    auto solution = system->solve(target_shares(options.footprint), solve, &budget,
                                  part.part(0.0, is_encoded ? 0.2 : 0.8));
    squares = system->own_squares();
    if (is_encoded) {
      const auto fit = std::move(systems.encoded[k]);
      solution.image = fit_encoded(fit.get(), solution.image, solution.used, solve, &encoded_budget,
                                   part.part(0.2, 0.8));
    }
    levels.push_back(
        filled(std::move(solution.image), solution.used, options.wrap, part.part(0.8, 1.0)));
  }
  return levels;
}

template <int C>
std::vector<Image> solve_by_level(const FilteredImage& image,
                                  const std::vector<const Surface*>& surfaces,
                                  const std::vector<SeamEdge>& seams, const SolveOptions& solve,
                                  const MipmapOptions& options, int level_count, const Run& run) {
  const TexelSource texels = image.texels();
  const bool is_encoded = options.reader == Reader::kSrgbAfter;
  const Image encoded = is_encoded ? encode_srgb(image.floats(), options.run.threads()) : Image();
  LevelSystems<C> systems(texels.width, texels.height, level_count, options.wrap, options.reader);
  const double summed = is_encoded ? 0.2 : 0.4;
  const TargetSquares squares =
      sum_up<C>(image, is_encoded ? TexelSource(encoded.view()) : texels, surfaces, !seams.empty(),
                level_count - 1, options, run.part(0.0, summed), &systems);
  const Run linking = run.part(summed, summed);
  if (!is_encoded || C > encoded_channels(C)) {
    link_levels(seams, image.floats(), surfaces, options.wrap, level_count - 1, linking,
                [&](int level, const std::vector<SeamLink>& links, double by_area) {
                  systems.linear[level - 1]->add_links(links, by_area, linking);
                });
  }
  if (is_encoded) {
    link_levels(seams, encoded.view(), surfaces, options.wrap, level_count - 1, linking,
                [&](int level, const std::vector<SeamLink>& links, double by_area) {
                  systems.encoded[level - 1]->add_links(links, by_area, squares.image);
                });
  }
  return solve_in_turn(std::move(systems), squares, solve, options, run.part(summed, 1.0));
}

}  // namespace

std::vector<Image> fitted_levels(const FilteredImage& image,
                                 const std::vector<const Surface*>& surfaces,
                                 const std::vector<SeamEdge>& seams, const SolveOptions& solve,
                                 const MipmapOptions& options, int level_count, const Run& run) {
  if (level_count == 1) return {};
  const auto fit = [&]<int C>() {
    return std::get<SurfaceFilter>(options.filter) == SurfaceFilter::kTrilinear
               ? solve_together<C>(image, surfaces, seams, solve, options, level_count, run)
               : solve_by_level<C>(image, surfaces, seams, solve, options, level_count, run);
  };
  switch (image.texels().channels) {
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

}  // namespace prefilter
