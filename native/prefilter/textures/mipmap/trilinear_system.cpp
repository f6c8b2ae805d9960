// SPDX-License-Identifier: GPL-3.0-or-later

// Block Gauss-Seidel iteration over the levels. The off-diagonal blocks are at most half the
// diagonal, so a round reduces the error about fourfold; each block is solved by a few sweeps from
// its current texels.
#include "prefilter/textures/mipmap/trilinear_system.h"

#include <algorithm>
#include <cmath>

#include "prefilter/textures/texels/levels.h"

namespace prefilter {
namespace {

// 4^-16 is about 1e-9, below rounding.
constexpr int kMaxLevelRounds = 16;
constexpr int kSweepsPerLevelRound = 4;
// Root mean square footprint of the pixels that read a level, relative to pixels at the level's own
// mip value. A level is read between the mip values of its neighbors, with tent weights: the
// integrals over s from 0 to 1 of s 4^(s - 1) and (1 - s) 4^s add up to the square.
constexpr double kMeanFootprint = 1.0820;
// 1/6 divided by 2/3, the scale of the equations.
constexpr float kOffDiagonal = 0.25F;

}  // namespace

template <int C>
TrilinearSystem<C>::TrilinearSystem(int width, int height, WrapModes wrap)
    : last_level_(full_level_count(width, height) - 1) {
  for (int level = 1; level <= last_level_; ++level) {
    const int columns = level_size(width, level);
    const int rows = level_size(height, level);
    systems_.push_back(std::make_unique<BilinearSystem<C>>(columns, rows, wrap));
    if (level == last_level_) break;
    couplings_.emplace_back(columns, rows, level_size(width, level + 1),
                            level_size(height, level + 1), wrap);
  }
}

template <int C>
void TrilinearSystem<C>::add(const MomentBlock<C>& block) {
  systems_[block.level - 1]->add(block);
  if (block.level < last_level_) {
    couplings_[block.level - 1].add(block);
    return;
  }
  // The last level is a single block, as levels that tiles do not visit are.
  double mass = 0.0;
  for (int y = 0; y < block.height; ++y) {
    for (int x = 0; x < block.width; ++x) {
      const CellMoments<C>& cell = block.at(x, y);
      mass += cell.weight[0];
      for (int c = 0; c < C; ++c) mean_[c] += cell.image[c][0];
    }
  }
  for (double& mean : mean_) mean /= mass;
}

template <int C>
void TrilinearSystem<C>::expect_finer_means() {
  for (const std::unique_ptr<BilinearSystem<C>>& system : systems_) system->expect_finer_means();
}

template <int C>
void TrilinearSystem<C>::prepare(double footprint, const SolveOptions& options, const Run& run) {
  TargetSquares squares = squares_;
  for (int level = 1; level <= last_level_; ++level) {
    BilinearSystem<C>& system = *systems_[level - 1];
    system.set_squares(squares);
    // The equations of a level are divided by 2/3. For level 1 the term 1/6 A_1,0 times the image
    // is known: it is 1/6 of the image's right side.
    system.prepare(target_shares(std::min(kMeanFootprint * footprint, kMaxFootprint)),
                   {.times = 1.5, .known = level == 1 ? 1.0 / 6.0 : 0.0}, run);
    system.system().swap_right_side(&fixed_.emplace_back());
    squares = system.own_squares();
  }
  NinePointSystem<float>& last = systems_.back()->system();
  for (int c = 0; c < C; ++c) {
    last.texel(0).v[c] =
        std::clamp(static_cast<float>(mean_[c]), options.ranges[c].low, options.ranges[c].high);
  }
}

template <int C>
int TrilinearSystem<C>::solve_level(int level, const SolveOptions& options, const Run& run) {
  NinePointSystem<float>& system = systems_[level - 1]->system();
  right_ = fixed_[level - 1];
  couplings_[level - 1].subtract_coarse(system, systems_[level]->system(), kOffDiagonal,
                                        run.threads(), &right_);
  if (level > 1) {
    couplings_[level - 2].subtract_fine(systems_[level - 2]->system(), system, kOffDiagonal,
                                        run.threads(), &right_);
  }
  system.swap_right_side(&right_);
  const int sweeps = system.solve(options, run);
  system.swap_right_side(&right_);
  return sweeps;
}

template <int C>
void TrilinearSystem<C>::iterate_levels(const SolveOptions& options, const Run& run) {
  SolveOptions few = options;
  few.max_sweeps = kSweepsPerLevelRound;
  // Whether a level moved when it was last solved. A level is solved again only after a neighbor
  // moved. The last level is fixed.
  std::vector<bool> moves(last_level_ + 1, true);
  moves[0] = moves[last_level_] = false;
  const auto settled = [&moves] {
    return std::find(moves.begin(), moves.end(), true) == moves.end();
  };
  for (int round = 0; round < kMaxLevelRounds && !settled(); ++round) {
    for (int level = 1; level < last_level_; ++level) {
      const Run part = run.part((round + 1.0 - std::ldexp(1.0, 1 - level)) / kMaxLevelRounds,
                                (round + 1.0 - std::ldexp(1.0, -level)) / kMaxLevelRounds);
      part.report(0.0);
      if (!moves[level - 1] && !moves[level] && !moves[level + 1]) continue;
      moves[level] = solve_level(level, few, part) > 1;
    }
  }
}

template <int C>
void TrilinearSystem<C>::fit_links(const SolveOptions& options, const SeamBudget& budget,
                                   const Run& run) {
  const auto error = [&](int level) {
    return systems_[level - 1]->squared_error(budget.first_channel, run.threads());
  };
  std::vector<std::vector<LaneValues>> alone(last_level_);
  std::vector<double> least(last_level_);
  SeamBudget level_budget = budget;
  for (int level = 1; level < last_level_; ++level) {
    NinePointSystem<float>& system = systems_[level - 1]->system();
    for (std::size_t i = 0; i < system.size(); ++i) {
      alone[level - 1].push_back(system.texel(static_cast<std::ptrdiff_t>(i)));
    }
    least[level - 1] = error(level);
    if (!systems_[level - 1]->has_links()) continue;
    const Run part =
        run.part(0.7 * (1.0 - std::ldexp(1.0, 1 - level)), 0.7 * (1.0 - std::ldexp(1.0, -level)));
    SolveOptions linked = options;
    linked.max_sweeps = systems_[level - 1]->linked_sweeps();
    const LinkedFit fit{[&](double weight, const Run& fitting) {
                          systems_[level - 1]->weigh_links(weight);
                          solve_level(level, linked, fitting);
                        },
                        [&] { return error(level); }};
    fit_within(systems_[level - 1]->target_square(budget.first_channel), fit, part, &system,
               &level_budget);
    systems_[level - 1]->weigh_links(level_budget.weight);
  }
  // Levels that moved affect their neighbors.
  iterate_levels(options, run.part(0.7, 1.0));
  for (int level = 1; level < last_level_; ++level) {
    const double square = systems_[level - 1]->target_square(budget.first_channel);
    const double rise = allowed_rise(budget, least[level - 1], square);
    const auto spent = [&] {
      const double more = error(level) - least[level - 1];
      return rise > 0.0 ? more / rise : (more > 0.0 ? HUGE_VAL : 0.0);
    };
    if (spent() > 1.0) step_back_within(alone[level - 1], spent, &systems_[level - 1]->system());
  }
}

template <int C>
auto TrilinearSystem<C>::solve(double footprint, const SolveOptions& options, SeamBudget budget,
                               const Run& run)
    -> std::vector<typename BilinearSystem<C>::Solution> {
  prepare(footprint, options, run);
  const bool has_links = std::any_of(systems_.begin(), systems_.end(),
                                     [](const auto& system) { return system->has_links(); });
  const Stages stages(run, {3, 7});
  iterate_levels(options, has_links ? stages[0] : run);
  if (has_links) fit_links(options, budget, stages[1]);
  std::vector<typename BilinearSystem<C>::Solution> levels;
  for (const std::unique_ptr<BilinearSystem<C>>& system : systems_) {
    levels.push_back(system->take_solution());
  }
  return levels;
}

template class TrilinearSystem<1>;
template class TrilinearSystem<2>;
template class TrilinearSystem<3>;
template class TrilinearSystem<4>;

}  // namespace prefilter
