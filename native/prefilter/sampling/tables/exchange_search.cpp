// SPDX-License-Identifier: GPL-3.0-or-later

// Minimizes equation 6.4 over sets of texels, by exchanging one texel at a time.
#include "prefilter/sampling/tables/exchange_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <random>
#include <utility>
#include <vector>

#include "prefilter/sampling/tables/bordered_rows.h"

namespace prefilter {
namespace {

constexpr int kRandomStarts = 99;
// Pool sizes of random sets, per texel, used in turns: some of the best sets consist of
// individually good texels only, others include texels from far down the list.
constexpr std::array<std::size_t, 3> kPoolSizesPerTexel = {3, 8, 24};
constexpr double kMinErrorGain = 1e-12;  // relative to the filter's square

// A set, and the effect of every possible exchange on its error.
//
// With a Lagrange multiplier for the sum of the weights, the equations have the matrix K of
// products of the set's texels, bordered by ones. Adding a texel adds a row and a column: the error
// falls by the sum over the polynomials of residual^2 / remainder. The residual is what remains of
// the candidate's right side after the set, the remainder what remains of its square. Removing
// texel i changes the inverse of K by its i-th row and column only. So one pass over the candidates
// evaluates all exchanges.
// exchanges are evaluated with one pass over the candidates.
class Exchanges {
 public:
  explicit Exchanges(const SubdomainSystem& system)
      : system_(system),
        candidates_(system.candidates()),
        polynomials_(system.polynomials()),
        sides_(candidates_ * polynomials_),
        squares_(candidates_),
        is_member_(candidates_),
        residuals_(candidates_ * polynomials_),
        remainders_(candidates_),
        gains_(candidates_) {
    for (std::size_t i = 0; i < candidates_; ++i) {
      squares_[i] = system.products_of(static_cast<int>(i))[i];
      for (std::size_t p = 0; p < polynomials_; ++p) {
        sides_[p * candidates_ + i] = system.right_side_of(static_cast<int>(i))[p];
      }
    }
  }

  const std::vector<int>& members() const { return members_; }
  double error() const { return error_; }

  // Returns whether the equations of the set could be solved.
  bool set_members(std::vector<int> members) {
    for (const int member : members_) is_member_[member] = 0;
    members_ = std::move(members);
    for (const int member : members_) is_member_[member] = 1;
    return invert() && evaluate();
  }

  // Adds the texel that lowers the error the most. Returns whether there is one.
  bool add() {
    std::fill(gains_.begin(), gains_.end(), 0.0);
    for (std::size_t p = 0; p < polynomials_; ++p) {
      const double* const residuals = residuals_.data() + p * candidates_;
      for (std::size_t j = 0; j < candidates_; ++j) gains_[j] += residuals[j] * residuals[j];
    }
    int best = -1;
    double best_gain = -1.0;
    for (std::size_t j = 0; j < candidates_; ++j) {
      if (is_member_[j] != 0 || remainders_[j] < kDependentTolerance * squares_[j]) continue;
      const double gain = gains_[j] / remainders_[j];
      if (gain > best_gain) {
        best_gain = gain;
        best = static_cast<int>(j);
      }
    }
    if (best < 0) return false;
    const std::vector<int> old_members = members_;
    std::vector<int> members = members_;
    members.push_back(best);
    if (set_members(std::move(members))) return true;
    set_members(old_members);
    return false;
  }

  // Makes the exchange that lowers the error the most. Returns whether there is one.
  bool exchange() {
    const std::size_t size = members_.size() + 1;
    double best_change = kMinErrorGain * system_.filter_square;
    int out = -1;
    int in = -1;
    for (std::size_t i = 0; i < members_.size(); ++i) {
      const double diagonal = inverse_[i * size + i];
      const double* const row = explained_.data() + i * candidates_;
      double loss = 0.0;
      std::fill(gains_.begin(), gains_.end(), 0.0);
      for (std::size_t p = 0; p < polynomials_; ++p) {
        const double weight = weights_[i * polynomials_ + p];
        loss += weight * weight / diagonal;
        const double* const residuals = residuals_.data() + p * candidates_;
        const double factor = weight / diagonal;
        for (std::size_t j = 0; j < candidates_; ++j) {
          const double residual = residuals[j] + factor * row[j];
          gains_[j] += residual * residual;
        }
      }
      const double scale = 1.0 / diagonal;
      for (std::size_t j = 0; j < candidates_; ++j) {
        const double remainder = remainders_[j] + scale * row[j] * row[j];
        const bool is_allowed = is_member_[j] == 0 && remainder > kDependentTolerance * squares_[j];
        if (is_allowed && gains_[j] > (loss + best_change) * remainder) {
          best_change = gains_[j] / remainder - loss;
          out = static_cast<int>(i);
          in = static_cast<int>(j);
        }
      }
    }
    if (out < 0) return false;
    const double before = error_;
    const std::vector<int> old_members = members_;
    std::vector<int> members = members_;
    members[out] = in;
    if (set_members(std::move(members)) && error_ < before) return true;
    set_members(old_members);  // the predicted gain was a rounding error
    return false;
  }

 private:
  bool invert() {
    const std::size_t size = members_.size() + 1;
    BorderedRows rows(system_, members_, size);
    for (std::size_t i = 0; i < size; ++i) rows.side(i, i) = 1.0;
    if (!rows.eliminate(kDependentTolerance)) return false;
    inverse_.resize(size * size);
    for (std::size_t i = 0; i < size; ++i) {
      for (std::size_t j = 0; j < size; ++j) inverse_[i * size + j] = rows.side(i, j);
    }
    return true;
  }

  // Computes weights and error of the set, and residuals and remainders of all candidates.
  bool evaluate() {
    const std::size_t count = members_.size();
    const std::size_t size = count + 1;
    weights_.assign(size * polynomials_, 0.0);
    error_ = system_.filter_square;
    for (std::size_t p = 0; p < polynomials_; ++p) {
      const auto side = [&](std::size_t i) {
        return i < count ? sides_[p * candidates_ + members_[i]]
                         : system_.weight_sum(static_cast<int>(p));
      };
      for (std::size_t i = 0; i < size; ++i) {
        double& weight = weights_[i * polynomials_ + p];
        for (std::size_t j = 0; j < size; ++j) weight += inverse_[i * size + j] * side(j);
        error_ -= weight * side(i);
      }
    }

    explained_.resize(size * candidates_);
    for (std::size_t i = 0; i < size; ++i) {
      double* const row = explained_.data() + i * candidates_;
      std::fill(row, row + candidates_, inverse_[i * size + count]);
      for (std::size_t s = 0; s < count; ++s) {
        const double factor = inverse_[i * size + s];
        const double* const products = system_.products_of(members_[s]);
        for (std::size_t j = 0; j < candidates_; ++j) row[j] += factor * products[j];
      }
    }
    std::copy(sides_.begin(), sides_.end(), residuals_.begin());
    std::copy(squares_.begin(), squares_.end(), remainders_.begin());
    for (std::size_t p = 0; p < polynomials_; ++p) {
      double* const residuals = residuals_.data() + p * candidates_;
      for (std::size_t s = 0; s < count; ++s) {
        const double weight = weights_[s * polynomials_ + p];
        const double* const products = system_.products_of(members_[s]);
        for (std::size_t j = 0; j < candidates_; ++j) residuals[j] -= weight * products[j];
      }
      const double multiplier = weights_[count * polynomials_ + p];
      for (std::size_t j = 0; j < candidates_; ++j) residuals[j] -= multiplier;
    }
    for (std::size_t s = 0; s < count; ++s) {
      const double* const row = explained_.data() + s * candidates_;
      const double* const products = system_.products_of(members_[s]);
      for (std::size_t j = 0; j < candidates_; ++j) remainders_[j] -= row[j] * products[j];
    }
    const double* const border = explained_.data() + count * candidates_;
    for (std::size_t j = 0; j < candidates_; ++j) remainders_[j] -= border[j];
    return std::isfinite(error_);
  }

  const SubdomainSystem& system_;
  std::size_t candidates_;
  std::size_t polynomials_;
  std::vector<double> sides_;    // [polynomial][candidate]
  std::vector<double> squares_;  // of candidates
  std::vector<int> members_;
  std::vector<unsigned char> is_member_;
  double error_ = std::numeric_limits<double>::infinity();
  std::vector<double> inverse_;    // of K
  std::vector<double> weights_;    // [member, and the multiplier][polynomial]
  std::vector<double> explained_;  // the inverse times each candidate's column: [row][candidate]
  std::vector<double> residuals_;  // [polynomial][candidate]
  std::vector<double> remainders_;
  std::vector<double> gains_;  // scratch
};

// Candidates by increasing error of their best single-texel fit.
std::vector<int> by_own_error(const SubdomainSystem& system) {
  std::vector<double> errors;
  for (int i = 0; i < system.candidates(); ++i) {
    const double unit = system.unit;
    errors.push_back(unit * unit * system.products_of(i)[i] -
                     2.0 * unit * system.right_side_of(i)[0]);
  }
  std::vector<int> order(system.candidates());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return errors[a] < errors[b]; });
  return order;
}

// Draws `count` elements of the pool at random.
std::vector<int> drawn(std::vector<int> pool, std::size_t count, std::mt19937& random) {
  for (std::size_t i = 0; i < count; ++i) {
    // Distributions of the standard library differ between implementations.
    const std::size_t pick = i + random() % (pool.size() - i);
    std::swap(pool[i], pool[pick]);
  }
  pool.resize(count);
  return pool;
}

}  // namespace

FittedSet find_set(const SubdomainSystem& system, int texels, const Run& run) {
  const auto count = static_cast<std::size_t>(texels);
  const std::vector<int> order = by_own_error(system);
  std::mt19937 random(1);
  Exchanges exchanges(system);
  std::vector<int> best;
  double best_error = std::numeric_limits<double>::infinity();
  for (int start = 0; start <= kRandomStarts; ++start) {
    run.report(static_cast<double>(start) / (kRandomStarts + 1));
    std::vector<int> pool = order;
    pool.resize(
        std::min(pool.size(), count * kPoolSizesPerTexel[start % kPoolSizesPerTexel.size()]));
    if (!exchanges.set_members(start == 0 ? std::vector<int>{order[0]}
                                          : drawn(std::move(pool), count, random))) {
      continue;
    }
    while (exchanges.members().size() < count && exchanges.add()) {
    }
    while (exchanges.exchange()) {
    }
    // Among mirrored sets, takes the first, regardless of rounding.
    if (exchanges.error() < best_error - kMinErrorGain * system.filter_square) {
      best_error = exchanges.error();
      best = exchanges.members();
    }
  }
  return fit_set(system, best);
}

}  // namespace prefilter
