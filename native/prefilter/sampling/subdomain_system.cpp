#include "prefilter/sampling/subdomain_system.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <utility>

#include "prefilter/sampling/bordered_rows.h"
#include "prefilter/sampling/filter_products.h"

namespace prefilter {
namespace {

// Products along an axis of the texels that matter, level by level, with the filter of a sample.
class AxisProducts {
 public:
  AxisProducts(const FilterProducts& filters, const Subdomain& subdomain) : filters_(filters) {
    const double width = filters.width(subdomain.f_high());
    for (int finer = 0; finer < filters.levels(); ++finer) {
      ranges_.push_back(filters.overlapping(finer, subdomain.y_low(), subdomain.x_high(), width));
    }
    for (int finer = 0; finer < filters.levels(); ++finer) {
      begins_.push_back(static_cast<int>(texels_.size()));
      for (int i = ranges_[finer].first; i <= ranges_[finer].last; ++i) {
        texels_.emplace_back(finer, i);
      }
    }
  }

  int count() const { return static_cast<int>(texels_.size()); }
  // The number of texel i of a level, of those that this object knows.
  int number(int finer, int i) const { return begins_[finer] + i - ranges_[finer].first; }

  std::vector<double> of_texels() const {
    std::vector<double> products;
    for (const auto& [finer_i, i] : texels_) {
      for (const auto& [finer_j, j] : texels_) {
        products.push_back(filters_.of_texels(finer_i, i, finer_j, j));
      }
    }
    return products;
  }

  const std::vector<double>& with_sample(double x, double f) {
    std::vector<double>& products = with_samples_[{x, f}];
    if (products.empty()) {
      for (const auto& [finer, i] : texels_) {
        products.push_back(filters_.with_sample(finer, i, x, f));
      }
    }
    return products;
  }

 private:
  const FilterProducts& filters_;
  std::vector<FilterProducts::Texels> ranges_;
  std::vector<int> begins_;
  std::vector<std::pair<int, int>> texels_;  // level, index
  std::map<std::pair<double, double>, std::vector<double>> with_samples_;
};

// Between two texels of a level along an axis.
struct LinearWeights {
  int first;
  std::array<double, 2> weights;
};

LinearWeights linear_weights(int finer, double x) {
  const double position = std::ldexp(x, finer) - 0.5;
  const double first = std::floor(position);
  return {static_cast<int>(first), {first + 1.0 - position, position - first}};
}

double trilinear_error(const FilterProducts& filters, const Subdomain& subdomain) {
  struct Texel {
    int finer;
    int x;
    int y;
    double weight;
  };
  double error = 0.0;
  for (const Subdomain::Node& node : subdomain.quadrature(2)) {
    std::vector<Texel> texels;
    for (int finer = 0; finer < std::min(filters.levels(), 2); ++finer) {
      const double share = filters.levels() == 1 ? 1.0 : (finer == 0 ? node.f : 1.0 - node.f);
      const LinearWeights along_x = linear_weights(finer, node.x);
      const LinearWeights along_y = linear_weights(finer, node.y);
      for (int i = 0; i < 4; ++i) {
        texels.push_back({finer, along_x.first + i % 2, along_y.first + i / 2,
                          share * along_x.weights[i % 2] * along_y.weights[i / 2]});
      }
    }
    double value = filters.of_sample(node.x, node.f) * filters.of_sample(node.y, node.f);
    for (const Texel& a : texels) {
      value -= 2.0 * a.weight * filters.with_sample(a.finer, a.x, node.x, node.f) *
               filters.with_sample(a.finer, a.y, node.y, node.f);
      for (const Texel& b : texels) {
        value += a.weight * b.weight * filters.of_texels(a.finer, a.x, b.finer, b.x) *
                 filters.of_texels(a.finer, a.y, b.finer, b.y);
      }
    }
    error += node.weight * value;
  }
  return error;
}

}  // namespace

SubdomainSystem::SubdomainSystem(const Kernel& kernel, const TableShape& shape,
                                 const TableSection& section, int index) {
  const Subdomain subdomain(shape, section, index);
  basis = orthonormal_basis(subdomain, shape.degree);
  unit = std::sqrt(subdomain.volume());
  const FilterProducts filters(kernel, section.levels);
  trilinear_error = prefilter::trilinear_error(filters, subdomain);

  AxisProducts axis(filters, subdomain);
  std::vector<std::pair<int, int>> numbers;  // of the candidates, along x and along y
  std::vector<TexelOffset> all;
  const double width = filters.width(subdomain.f_high());
  for (int finer = 0; finer < section.levels; ++finer) {
    const auto along_x = filters.overlapping(finer, subdomain.x_low(), subdomain.x_high(), width);
    const auto along_y = filters.overlapping(finer, subdomain.y_low(), subdomain.y_high(), width);
    for (int y = along_y.first; y <= along_y.last; ++y) {
      for (int x = along_x.first; x <= along_x.last; ++x) {
        all.push_back({finer, x, y});
        numbers.emplace_back(axis.number(finer, x), axis.number(finer, y));
      }
    }
  }

  const std::size_t count = all.size();
  std::vector<double> sides(count * basis.count);
  // Boxes meet at edges, where their product has a kink.
  const int panels = kernel.degree() == 0 ? 4 : 1;
  for (const Subdomain::Node& node : subdomain.quadrature(panels)) {
    const Terms terms = terms_at(node.x, node.y, node.f);
    std::array<double, kMostTerms> polynomials{};
    for (int p = 0; p < basis.count; ++p) {
      for (int q = 0; q < kMostTerms; ++q) polynomials[p] += basis.coefficients[p][q] * terms[q];
      polynomials[p] *= node.weight;
    }
    const std::vector<double>& along_x = axis.with_sample(node.x, node.f);
    const std::vector<double>& along_y = axis.with_sample(node.y, node.f);
    for (std::size_t i = 0; i < count; ++i) {
      const double product = along_x[numbers[i].first] * along_y[numbers[i].second];
      for (int p = 0; p < basis.count; ++p) sides[i * basis.count + p] += product * polynomials[p];
    }
    filter_square +=
        node.weight * filters.of_sample(node.x, node.f) * filters.of_sample(node.y, node.f);
  }

  // Sums over texels of level 0 can be zero where supports overlap.
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < count; ++i) {
    const double* side = sides.data() + i * basis.count;
    if (std::any_of(side, side + basis.count, [](double value) { return value != 0.0; })) {
      kept.push_back(i);
      texels.push_back(all[i]);
      right_sides.insert(right_sides.end(), side, side + basis.count);
    }
  }
  const std::vector<double> of_texels = axis.of_texels();
  const auto along_axis = [&](int i, int j) {
    return of_texels[static_cast<std::size_t>(i) * axis.count() + j];
  };
  products.reserve(kept.size() * kept.size());
  for (const std::size_t i : kept) {
    for (const std::size_t j : kept) {
      products.push_back(along_axis(numbers[i].first, numbers[j].first) *
                         along_axis(numbers[i].second, numbers[j].second));
    }
  }
}

FittedSet fit_set(const SubdomainSystem& system, std::span<const int> members) {
  FittedSet set;
  set.members.assign(members.begin(), members.end());
  std::sort(set.members.begin(), set.members.end());
  const std::size_t count = members.size();
  const auto sides = static_cast<std::size_t>(system.polynomials());
  BorderedRows rows(system, set.members, sides);
  const auto right_side = [&](std::size_t i, std::size_t p) {
    return i < count ? system.right_side_of(set.members[i])[p]
                     : system.weight_sum(static_cast<int>(p));
  };
  for (std::size_t i = 0; i <= count; ++i) {
    for (std::size_t p = 0; p < sides; ++p) rows.side(i, p) = right_side(i, p);
  }
  if (!rows.eliminate(0.0)) return set;

  // Where the gradient vanishes, up to the multiplier, what is left of the square of the filter.
  set.error = system.filter_square;
  set.weights.resize(count * sides);
  for (std::size_t i = 0; i <= count; ++i) {
    for (std::size_t p = 0; p < sides; ++p) {
      set.error -= rows.side(i, p) * right_side(i, p);
      if (i < count) set.weights[i * sides + p] = rows.side(i, p);
    }
  }
  return set;
}

}  // namespace prefilter
