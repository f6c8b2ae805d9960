// SPDX-License-Identifier: GPL-3.0-or-later

// Leaps and bounds (Furnival and Wilson, "Regressions by Leaps and Bounds", 1974): sets that
// exclude some texels have at least the error of all other texels together.
//
// Let c be the weights with all candidates in the set, and A the inverse of their products,
// bordered for the weights' sum. Excluding the texels X raises the error by c_X A_XX^-1 c_X. So a
// bound only requires eliminating a few texels, however many candidates there are. Branches on the
// undecided texel whose exclusion raises the bound the most: first included, then excluded.
#include "prefilter/sampling/tables/certify.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <set>
#include <utility>
#include <vector>

#include "prefilter/base/parallel.h"
#include "prefilter/sampling/tables/bordered_rows.h"

namespace prefilter {
namespace {

constexpr double kEqualErrors = 1e-9;  // relative
constexpr double kNoError = 1e-12;     // relative to the filter's square
// Linearly dependent candidates have no inverse. So this share of the mean squared texel is added
// to each square. It raises an error by at most this share times the sum of the squared weights.
constexpr double kRidge = 1e-10;
constexpr double kMaxRmsWeight = 10.0;
constexpr std::int64_t kNodesPerTask = 256;  // visited depth first
constexpr std::int64_t kTasksPerRound = 64;  // processed in parallel

// Result of eliminating some texels from equations with one matrix and several right sides: the
// reduced equations of all other texels.
struct Elimination {
  std::size_t count = 0;
  std::vector<double> sides;    // [polynomial][texel]
  std::vector<double> squares;  // the diagonal
  double error = 0.0;           // remaining error

  double side_square(int texel) const {
    double sum = 0.0;
    for (std::size_t i = texel; i < sides.size(); i += count) sum += sides[i] * sides[i];
    return sum;
  }
};

// Eliminated rows, each divided by the square root of its pivot.
class Rows {
 public:
  std::size_t size() const { return rows_.size(); }
  void resize(std::size_t size) { rows_.resize(size); }

  // Reduces the row of a texel by all eliminated rows.
  void reduce(int texel, std::vector<double>* row) const {
    for (const std::vector<double>& above : rows_) {
      const double factor = above[texel];
      for (std::size_t i = 0; i < row->size(); ++i) (*row)[i] -= factor * above[i];
    }
  }

  // Reduces a single element of a texel's row.
  double reduced(int texel, int column, double value) const {
    for (const std::vector<double>& above : rows_) value -= above[texel] * above[column];
    return value;
  }

  // Eliminates a texel. `sign` is the sign of its contribution to the error.
  void eliminate(int texel, std::vector<double> row, double sign, Elimination* left) {
    reduce(texel, &row);
    const double scale = 1.0 / std::sqrt(left->squares[texel]);
    for (double& value : row) value *= scale;
    for (std::size_t i = 0; i < row.size(); ++i) left->squares[i] -= row[i] * row[i];
    left->error += sign * left->side_square(texel) * scale * scale;
    for (std::size_t first = 0; first < left->sides.size(); first += left->count) {
      double* const side = left->sides.data() + first;
      const double factor = side[texel] * scale;
      for (std::size_t i = 0; i < row.size(); ++i) side[i] -= factor * row[i];
    }
    rows_.push_back(std::move(row));
  }

 private:
  std::vector<std::vector<double>> rows_;
};

// Cholesky factor of the candidates' products plus `ridge` on the diagonal: the lower triangle, by
// rows.
std::vector<double> cholesky_factor(const SubdomainSystem& system, double ridge, const Run& run) {
  const auto count = static_cast<std::size_t>(system.candidates());
  std::vector<double> factor(count * count);
  for (std::size_t i = 0; i < count; ++i) {
    std::copy_n(system.products_of(static_cast<int>(i)), i + 1, factor.data() + i * count);
    factor[i * count + i] += ridge;
  }
  std::vector<double> column(count);
  for (std::size_t k = 0; k < count; ++k) {
    run.report(0.0);
    const double pivot = std::sqrt(factor[k * count + k]);
    factor[k * count + k] = pivot;
    for (std::size_t i = k + 1; i < count; ++i) {
      factor[i * count + k] /= pivot;
      column[i] = factor[i * count + k];
    }
    for (std::size_t i = k + 1; i < count; ++i) {
      double* const row = factor.data() + i * count;
      const double at_k = column[i];
      if (at_k == 0.0) continue;
      for (std::size_t j = k + 1; j <= i; ++j) row[j] -= at_k * column[j];
    }
  }
  return factor;
}

// Inverts a matrix from its Cholesky factor: inverts the factor, then multiplies its columns.
std::vector<double> inverse_of_factor(const std::vector<double>& factor, std::size_t count,
                                      const Run& run) {
  std::vector<double> factor_inverse(count * count);
  std::vector<double> inverse(count * count);
  for (std::size_t i = 0; i < count; ++i) {
    run.report(0.0);
    double* const row = factor_inverse.data() + i * count;
    row[i] = 1.0;
    for (std::size_t k = 0; k < i; ++k) {
      const double at_k = factor[i * count + k];
      if (at_k == 0.0) continue;
      const double* const above = factor_inverse.data() + k * count;
      for (std::size_t j = 0; j <= k; ++j) row[j] -= at_k * above[j];
    }
    const double scale = 1.0 / factor[i * count + i];
    for (std::size_t j = 0; j <= i; ++j) row[j] *= scale;
    for (std::size_t k = 0; k <= i; ++k) {
      double* const sum = inverse.data() + k * count;
      for (std::size_t j = 0; j <= k; ++j) sum[j] += row[k] * row[j];
    }
  }
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = 0; j < i; ++j) inverse[j * count + i] = inverse[i * count + j];
  }
  return inverse;
}

// Inverse of all candidates' products, with the sum of the weights fixed, and the weights of all
// candidates.
struct AllTexels {
  AllTexels(const SubdomainSystem& system, const Run& run);

  const double* inverse_of(int i) const { return inverse.data() + i * weights.count; }

  std::vector<double> inverse;
  Elimination weights;
  double slack = 0.0;  // per texel of a set: bound on the error added by the ridge

 private:
  // Adds the weights for one polynomial, from the inverse without the constraint on their sum.
  // `of_ones` are its row sums, and `sum_of_ones` their total.
  void add_weights(const SubdomainSystem& system, std::size_t polynomial,
                   const std::vector<double>& of_ones, double sum_of_ones);
};

AllTexels::AllTexels(const SubdomainSystem& system, const Run& run) {
  const auto count = static_cast<std::size_t>(system.candidates());
  const auto polynomials = static_cast<std::size_t>(system.polynomials());
  double trace = 0.0;
  for (std::size_t i = 0; i < count; ++i) trace += system.products_of(static_cast<int>(i))[i];
  const double ridge = kRidge * trace / static_cast<double>(count);
  slack = ridge * system.unit * system.unit * kMaxRmsWeight * kMaxRmsWeight;
  inverse = inverse_of_factor(cholesky_factor(system, ridge, run), count, run);

  std::vector<double> of_ones(count);
  double sum_of_ones = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = 0; j < count; ++j) of_ones[i] += inverse[i * count + j];
    sum_of_ones += of_ones[i];
  }
  weights.count = count;
  weights.error = system.filter_square;
  weights.sides.assign(polynomials * count, 0.0);
  for (std::size_t p = 0; p < polynomials; ++p) add_weights(system, p, of_ones, sum_of_ones);
  for (std::size_t i = 0; i < count; ++i) {
    const double share = of_ones[i] / sum_of_ones;
    double* const row = inverse.data() + i * count;
    for (std::size_t j = 0; j < count; ++j) row[j] -= share * of_ones[j];
    weights.squares.push_back(row[i]);
  }
}

void AllTexels::add_weights(const SubdomainSystem& system, std::size_t polynomial,
                            const std::vector<double>& of_ones, double sum_of_ones) {
  const std::size_t count = weights.count;
  double* const of_polynomial = weights.sides.data() + polynomial * count;
  double sum = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = 0; j < count; ++j) {
      of_polynomial[i] +=
          inverse[i * count + j] * system.right_side_of(static_cast<int>(j))[polynomial];
    }
    sum += of_polynomial[i];
    weights.error -= of_polynomial[i] * system.right_side_of(static_cast<int>(i))[polynomial];
  }
  const double missing = system.weight_sum(static_cast<int>(polynomial)) - sum;
  weights.error += missing * missing / sum_of_ones;
  for (std::size_t i = 0; i < count; ++i) of_polynomial[i] += missing / sum_of_ones * of_ones[i];
}

// The sets that contain the chosen texels and none of the excluded ones.
struct Task {
  std::vector<int> chosen;
  std::vector<int> excluded;
  double bound = 0.0;
};

struct Outcome {
  std::vector<int> best;  // empty if no better set was found
  double best_error = 0.0;
  std::vector<Task> open;  // unfinished when the nodes ran out
  std::int64_t nodes = 0;
};

// Processes a task, depth first.
class Search {
 public:
  Search(const SubdomainSystem& system, const AllTexels& all, std::size_t size, double best_error)
      : system_(system), all_(all), size_(size), is_free_(all.weights.count, 1) {
    outcome_.best_error = best_error;
  }

  Outcome run(const Task& task) {
    Elimination without = all_.weights;
    for (const int texel : task.excluded) exclude(texel, &without);
    Elimination with;
    for (const int texel : task.chosen) choose(texel, &with);
    visit(std::move(without), with);
    return std::move(outcome_);
  }

 private:
  // Error that a better set must stay below.
  double needed() const {
    const double error = outcome_.best_error;
    return error - std::max(kEqualErrors * error, kNoError * system_.filter_square);
  }
  bool is_hopeless(double bound) const {
    return bound - all_.slack * static_cast<double>(size_) >= needed();
  }
  std::size_t missing() const { return size_ - chosen_.size(); }

  double product(int i, int j) const {
    const double* const base = system_.products_of(chosen_[0]);
    return system_.products_of(i)[j] - base[i] - base[j] + base[chosen_[0]];
  }
  bool can_join(int texel, double square) const {
    return square > kDependentTolerance * system_.products_of(texel)[texel];
  }

  void exclude(int texel, Elimination* without) {
    const double* const row = all_.inverse_of(texel);
    excluded_rows_.eliminate(texel, {row, row + without->count}, 1.0, without);
    excluded_.push_back(texel);
    is_free_[texel] = 0;
  }

  // The first chosen texel enforces the sum of the weights: all others count by their difference
  // from it.
  void choose(int texel, Elimination* with) {
    const std::size_t count = all_.weights.count;
    is_free_[texel] = 0;
    chosen_.push_back(texel);
    if (chosen_.size() > 1) {
      std::vector<double> row(count);
      for (std::size_t i = 0; i < count; ++i) row[i] = product(texel, static_cast<int>(i));
      chosen_rows_.eliminate(texel, std::move(row), -1.0, with);
      return;
    }
    const double* const base = system_.products_of(texel);
    const auto polynomials = static_cast<std::size_t>(system_.polynomials());
    with->count = count;
    with->error = system_.filter_square;
    with->sides.resize(polynomials * count);
    for (std::size_t p = 0; p < polynomials; ++p) {
      const double sum = system_.weight_sum(static_cast<int>(p));
      const double side = system_.right_side_of(texel)[p];
      with->error += sum * sum * base[texel] - 2.0 * sum * side;
      for (std::size_t i = 0; i < count; ++i) {
        with->sides[p * count + i] =
            system_.right_side_of(static_cast<int>(i))[p] - side - sum * (base[i] - base[texel]);
      }
    }
    with->squares.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
      with->squares[i] = product(static_cast<int>(i), static_cast<int>(i));
    }
  }

  void undo_choice() {
    is_free_[chosen_.back()] = 1;
    chosen_.pop_back();
    chosen_rows_.resize(chosen_.empty() ? 0 : chosen_.size() - 1);
  }

  void offer(double error, int last) {
    if (error >= needed()) return;
    outcome_.best_error = error;
    outcome_.best = chosen_;
    outcome_.best.push_back(last);
  }

  // Tries all sets with one more texel.
  void try_last(const Elimination& with) {
    gains_.assign(with.count, 0.0);
    for (std::size_t first = 0; first < with.sides.size(); first += with.count) {
      const double* const side = with.sides.data() + first;
      for (std::size_t i = 0; i < with.count; ++i) gains_[i] += side[i] * side[i];
    }
    const double gain = with.error - needed();
    for (std::size_t i = 0; i < with.count; ++i) {
      const auto texel = static_cast<int>(i);
      if (gains_[i] > gain * with.squares[i] && can_join(texel, with.squares[i])) {
        offer(with.error - gains_[i] / with.squares[i], texel);
      }
    }
  }

  // Tries a set with two more texels.
  void try_pair(const Elimination& with, int i, int j) {
    if (!can_join(i, with.squares[i])) return;
    const double share = chosen_rows_.reduced(i, j, product(i, j)) / with.squares[i];
    const double square = with.squares[j] - share * share * with.squares[i];
    if (!can_join(j, square)) return;
    double gain = 0.0;
    for (std::size_t first = 0; first < with.sides.size(); first += with.count) {
      const double side = with.sides[first + j] - share * with.sides[first + i];
      gain += side * side;
    }
    chosen_.push_back(i);
    offer(with.error - with.side_square(i) / with.squares[i] - gain / square, j);
    chosen_.pop_back();
  }

  // Finds the `count` free texels whose exclusion raises the bound the most, in this order, for
  // next_; the increases go to rises_.
  void rank(const Elimination& without, std::size_t count) {
    rises_.assign(without.count, 0.0);
    for (std::size_t first = 0; first < without.sides.size(); first += without.count) {
      const double* const side = without.sides.data() + first;
      for (std::size_t i = 0; i < without.count; ++i) rises_[i] += side[i] * side[i];
    }
    next_.clear();
    for (std::size_t i = 0; i < without.count; ++i) {
      if (is_free_[i] == 0) continue;
      rises_[i] /= without.squares[i];
      next_.push_back(static_cast<int>(i));
    }
    const auto end = next_.begin() + static_cast<std::ptrdiff_t>(std::min(count, next_.size()));
    std::partial_sort(next_.begin(), end, next_.end(), [&](int a, int b) {
      return rises_[a] != rises_[b] ? rises_[a] > rises_[b] : a < b;
    });
  }

  void visit(Elimination without, const Elimination& with) {
    const std::size_t excluded_before = excluded_.size();
    while (true) {
      // Pigeonhole: among this many texels at least one is not selected.
      rank(without, missing() + 1);
      if (next_.size() < missing()) break;
      const double bound =
          without.error + (next_.size() > missing() ? rises_[next_[missing()]] : 0.0);
      if (is_hopeless(bound)) break;
      if (outcome_.nodes++ >= kNodesPerTask) {
        outcome_.open.push_back({chosen_, excluded_, bound});
        break;
      }
      const int texel = next_[0];
      const double bound_without = without.error + rises_[texel];
      if (missing() == 2 && !chosen_.empty() && is_hopeless(without.error + rises_[next_[1]])) {
        try_pair(with, texel, next_[1]);
      } else if (chosen_.empty() || can_join(texel, with.squares[texel])) {
        Elimination next = with;
        choose(texel, &next);
        if (missing() == 1) {
          try_last(next);
        } else {
          visit(without, next);
        }
        undo_choice();
      }
      if (is_hopeless(bound_without)) break;
      exclude(texel, &without);
    }
    for (std::size_t i = excluded_before; i < excluded_.size(); ++i) is_free_[excluded_[i]] = 1;
    excluded_.resize(excluded_before);
    excluded_rows_.resize(excluded_before);
  }

  const SubdomainSystem& system_;
  const AllTexels& all_;
  std::size_t size_;
  std::vector<unsigned char> is_free_;
  std::vector<int> chosen_;
  std::vector<int> excluded_;
  Rows chosen_rows_;  // of all but the first
  Rows excluded_rows_;
  Outcome outcome_;
  std::vector<double> rises_;  // scratch, like next_
  std::vector<int> next_;
  std::vector<double> gains_;
};

}  // namespace

CertifiedSet certify_set(const SubdomainSystem& system, const FittedSet& start,
                         const CertifyOptions& options) {
  const std::size_t size = start.members.size();
  CertifiedSet result{start, 0.0};
  const double no_error = kNoError * system.filter_square;
  if (static_cast<int>(size) == system.candidates() || start.error <= no_error) return result;

  const AllTexels all(system, options.run);
  std::vector<int> best = start.members;
  double best_error = start.error;
  const auto order = [](const Task& a, const Task& b) { return a.bound < b.bound; };
  std::multiset<Task, decltype(order)> open(order);  // equal bounds keep the order of insertion
  open.insert({{}, {}, all.weights.error});
  std::int64_t nodes = 0;
  while (!open.empty() && nodes < options.nodes) {
    // The tasks of a round, and the best error they start with, do not depend on the number of
    // threads.
    std::vector<Task> tasks;
    while (!open.empty() && tasks.size() < kTasksPerRound) {
      tasks.push_back(std::move(open.extract(open.begin()).value()));
    }
    std::vector<Outcome> outcomes(tasks.size());
    const double done = static_cast<double>(nodes) / static_cast<double>(options.nodes);
    parallel_for(
        static_cast<std::int64_t>(tasks.size()), options.run.part(done, done),
        [&](std::int64_t i) { outcomes[i] = Search(system, all, size, best_error).run(tasks[i]); });
    for (Outcome& outcome : outcomes) {
      if (!outcome.best.empty() && outcome.best_error < best_error) {
        best_error = outcome.best_error;
        best = std::move(outcome.best);
      }
      nodes += outcome.nodes;
      for (Task& task : outcome.open) open.insert(std::move(task));
    }
  }
  if (best_error < start.error) result.set = fit_set(system, best);
  if (!open.empty() && best_error > no_error) {
    const double bound = open.begin()->bound - all.slack * static_cast<double>(size);
    result.gap = std::clamp(1.0 - bound / best_error, 0.0, 1.0);
  }
  options.run.report(1.0);
  return result;
}

}  // namespace prefilter
