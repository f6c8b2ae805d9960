// SPDX-License-Identifier: GPL-3.0-or-later

// Assembles equation 6.4 by Gauss quadrature over the subdomain.
#include "prefilter/sampling/tables/subdomain_system.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <utility>

#include "prefilter/images/kernel.h"
#include "prefilter/sampling/tables/bordered_rows.h"
#include "prefilter/sampling/tables/filter_products.h"

namespace prefilter {
namespace {

using Products = FilterProducts::Products;

// Product in the plane from the products along x and y.
double over_plane(const double* x, const double* y, int scales) {
  double sum = 0.0;
  for (int scale = 0; scale < scales; ++scale) sum += x[scale] * y[scale];
  return sum;
}
double over_plane(const Products& x, const Products& y) {
  return over_plane(x.data(), y.data(), FilterProducts::kMaxScales);
}

// Products along an axis of the relevant texels, level by level, with the filter of a sample.
class AxisProducts {
 public:
  AxisProducts(FilterProducts* filters, const Subdomain& subdomain) : filters_(filters) {
    const double width = filters->width(subdomain.f_high());
    for (int finer = 0; finer < filters->levels(); ++finer) {
      ranges_.push_back(filters->overlapping(finer, subdomain.y_low(), subdomain.x_high(), width));
    }
    for (int finer = 0; finer < filters->levels(); ++finer) {
      begins_.push_back(static_cast<int>(texels_.size()));
      for (int i = ranges_[finer].first; i <= ranges_[finer].last; ++i) {
        texels_.emplace_back(finer, i);
      }
    }
  }

  int count() const { return static_cast<int>(texels_.size()); }
  int scales() const { return filters_->scales(); }
  // Index of texel i of a level among the relevant ones.
  int number(int finer, int i) const { return begins_[finer] + i - ranges_[finer].first; }

  // [texel][texel]
  std::vector<Products> of_texels() const {
    std::vector<Products> products;
    for (const auto& [finer_i, i] : texels_) {
      for (const auto& [finer_j, j] : texels_) {
        products.push_back(filters_->of_texels(finer_i, i, finer_j, j));
      }
    }
    return products;
  }

  // [texel][scale]
  const std::vector<double>& with_sample(double x, double f) {
    std::vector<double>& products = with_samples_[{x, f}];
    if (products.empty()) {
      for (const auto& [finer, i] : texels_) {
        const Products of_scales = filters_->with_sample(finer, i, x, f);
        products.insert(products.end(), of_scales.begin(), of_scales.begin() + scales());
      }
    }
    return products;
  }

 private:
  FilterProducts* filters_;
  std::vector<FilterProducts::Texels> ranges_;
  std::vector<int> begins_;
  std::vector<std::pair<int, int>> texels_;  // level, index
  std::map<std::pair<double, double>, std::vector<double>> with_samples_;
};

// Interpolation weights of two texels of a level along an axis.
struct LinearWeights {
  int first;
  std::array<double, 2> weights;
};

LinearWeights linear_weights(int finer, double x) {
  const double position = std::ldexp(x, finer) - 0.5;
  const double first = std::floor(position);
  return {static_cast<int>(first), {first + 1.0 - position, position - first}};
}

void add(const Products& products, double factor, Products* sum) {
  for (int scale = 0; scale < FilterProducts::kMaxScales; ++scale) {
    (*sum)[scale] += factor * products[scale];
  }
}

// Products along an axis of linear interpolation in the cell's level and the next finer level.
class InterpolationProducts {
 public:
  explicit InterpolationProducts(FilterProducts* filters)
      : filters_(filters), levels_(std::min(filters->levels(), 2)) {}

  struct WithSample {
    Products of_sample{};
    std::array<Products, 2> of_levels{};
  };
  const WithSample& with_sample(double x, double f) {
    const auto [found, is_new] = with_samples_.try_emplace({x, f});
    WithSample& products = found->second;
    if (!is_new) return products;
    products.of_sample = filters_->of_sample(x, f);
    for (int finer = 0; finer < levels_; ++finer) {
      const LinearWeights linear = linear_weights(finer, x);
      for (int i = 0; i < 2; ++i) {
        add(filters_->with_sample(finer, linear.first + i, x, f), linear.weights[i],
            &products.of_levels[finer]);
      }
    }
    return products;
  }

  using OfLevels = std::array<std::array<Products, 2>, 2>;
  const OfLevels& of_levels(double x) {
    const auto [found, is_new] = of_levels_.try_emplace(x);
    OfLevels& products = found->second;
    for (int a = 0; is_new && a < levels_; ++a) {
      for (int b = 0; b < levels_; ++b) {
        const LinearWeights left = linear_weights(a, x);
        const LinearWeights right = linear_weights(b, x);
        for (int k = 0; k < 4; ++k) {
          const int i = k / 2;
          const int j = k % 2;
          add(filters_->of_texels(a, left.first + i, b, right.first + j),
              left.weights[i] * right.weights[j], &products[a][b]);
        }
      }
    }
    return products;
  }

 private:
  FilterProducts* filters_;
  int levels_;
  std::map<std::pair<double, double>, WithSample> with_samples_;
  std::map<double, OfLevels> of_levels_;
};

double trilinear_error(FilterProducts* filters, const Subdomain& subdomain, int panels) {
  InterpolationProducts axis(filters);
  double error = 0.0;
  for (const Subdomain::Node& node : subdomain.quadrature(panels)) {
    const auto& along_x = axis.with_sample(node.x, node.f);
    const auto& along_y = axis.with_sample(node.y, node.f);
    const auto& of_levels_x = axis.of_levels(node.x);
    const auto& of_levels_y = axis.of_levels(node.y);
    const bool has_finer = filters->levels() > 1;
    const std::array<double, 2> shares = {has_finer ? node.f : 1.0, has_finer ? 1.0 - node.f : 0.0};
    double value = over_plane(along_x.of_sample, along_y.of_sample);
    for (int a = 0; a < 2; ++a) {
      value -= 2.0 * shares[a] * over_plane(along_x.of_levels[a], along_y.of_levels[a]);
      for (int b = 0; b < 2; ++b) {
        value += shares[a] * shares[b] * over_plane(of_levels_x[a][b], of_levels_y[a][b]);
      }
    }
    error += node.weight * value;
  }
  return error;
}

// A texel, and its indices among those along x and along y.
struct Candidate {
  TexelOffset texel;
  int along_x;
  int along_y;
};

// All texels whose support overlaps the filter's somewhere in the subdomain.
std::vector<Candidate> candidates_of(const FilterProducts& filters, const Subdomain& subdomain,
                                     const AxisProducts& axis) {
  std::vector<Candidate> candidates;
  const double width = filters.width(subdomain.f_high());
  for (int finer = 0; finer < filters.levels(); ++finer) {
    const auto along_x = filters.overlapping(finer, subdomain.x_low(), subdomain.x_high(), width);
    const auto along_y = filters.overlapping(finer, subdomain.y_low(), subdomain.y_high(), width);
    for (int y = along_y.first; y <= along_y.last; ++y) {
      for (int x = along_x.first; x <= along_x.last; ++x) {
        candidates.push_back({{finer, x, y}, axis.number(finer, x), axis.number(finer, y)});
      }
    }
  }
  return candidates;
}

// The polynomials of a basis at a node.
std::array<double, kMaxTerms> polynomials_at(const OrthonormalBasis& basis,
                                             const Subdomain::Node& node) {
  const Terms terms = terms_at(node.x, node.y, node.f);
  std::array<double, kMaxTerms> polynomials{};
  for (int p = 0; p < basis.count; ++p) {
    for (int q = 0; q < kMaxTerms; ++q) polynomials[p] += basis.coefficients[p][q] * terms[q];
  }
  return polynomials;
}

// [candidate][polynomial]: the product of a texel with the filter of a sample, times the
// polynomial, integrated over the subdomain.
std::vector<double> right_sides_of(const std::vector<Candidate>& candidates,
                                   const OrthonormalBasis& basis,
                                   const std::vector<Subdomain::Node>& nodes, AxisProducts* axis) {
  std::vector<double> sides(candidates.size() * basis.count);
  const int scales = axis->scales();
  for (const Subdomain::Node& node : nodes) {
    std::array<double, kMaxTerms> polynomials = polynomials_at(basis, node);
    for (int p = 0; p < basis.count; ++p) polynomials[p] *= node.weight;
    const double* const along_x = axis->with_sample(node.x, node.f).data();
    const double* const along_y = axis->with_sample(node.y, node.f).data();
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      const double product = over_plane(along_x + candidates[i].along_x * scales,
                                        along_y + candidates[i].along_y * scales, scales);
      for (int p = 0; p < basis.count; ++p) sides[i * basis.count + p] += product * polynomials[p];
    }
  }
  return sides;
}

// [i][j]: the products of two texels in the plane.
std::vector<double> products_between(const std::vector<Candidate>& candidates,
                                     const AxisProducts& axis) {
  const std::vector<Products> of_texels = axis.of_texels();
  const auto along_axis = [&](int i, int j) -> const Products& {
    return of_texels[static_cast<std::size_t>(i) * axis.count() + j];
  };
  std::vector<double> products;
  products.reserve(candidates.size() * candidates.size());
  for (const Candidate& a : candidates) {
    for (const Candidate& b : candidates) {
      products.push_back(
          over_plane(along_axis(a.along_x, b.along_x), along_axis(a.along_y, b.along_y)));
    }
  }
  return products;
}

// Gauss panels along an axis of a subdomain. Products of boxes have a kink where they meet, or a
// discontinuous second derivative for natural images. Sums have a kink where a texel of level 0
// enters a filter's support, and bilinear interpolation has one between texels.
int panels_of(const TableShape& shape, int levels, bool has_box) {
  if (has_box) return levels == 3 && shape.spectrum == ImageSpectrum::kNatural ? 2 : 4;
  return levels == 3 ? 1 : 3;
}

}  // namespace

SubdomainSystem::SubdomainSystem(const TableShape& shape, const TableSection& section, int index) {
  const Subdomain subdomain(shape, section, index);
  basis = orthonormal_basis(subdomain, shape.degree);
  unit = std::sqrt(subdomain.volume());
  const Kernel& kernel = *find_kernel(shape.filter);
  const Kernel& sample = *find_kernel(shape.sample_filter());
  FilterProducts filters(kernel, sample, section.levels, shape.spectrum);
  const int panels = panels_of(shape, section.levels, kernel.degree() == 0 || sample.degree() == 0);
  trilinear_error = prefilter::trilinear_error(&filters, subdomain, std::max(panels, 2));

  AxisProducts axis(&filters, subdomain);
  const std::vector<Candidate> candidates = candidates_of(filters, subdomain, axis);
  const auto nodes = subdomain.quadrature(panels);
  const std::vector<double> sides = right_sides_of(candidates, basis, nodes, &axis);
  std::map<std::pair<double, double>, Products> of_samples;
  const auto of_sample = [&](double x, double f) {
    const auto [found, is_new] = of_samples.try_emplace({x, f});
    if (is_new) found->second = filters.of_sample(x, f);
    return found->second;
  };
  for (const Subdomain::Node& node : nodes) {
    filter_square += node.weight * over_plane(of_sample(node.x, node.f), of_sample(node.y, node.f));
  }
  // Sums over texels of level 0 can be zero although supports overlap.
  std::vector<Candidate> kept;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const double* side = sides.data() + i * basis.count;
    if (std::all_of(side, side + basis.count, [](double value) { return value == 0.0; })) continue;
    kept.push_back(candidates[i]);
    texels.push_back(candidates[i].texel);
    right_sides.insert(right_sides.end(), side, side + basis.count);
  }
  products = products_between(kept, axis);
  // For white images, sums over texels of level 0 are integrals times the number of texels per
  // cell.
  const bool are_counts = section.levels < 3 && shape.spectrum == ImageSpectrum::kWhite;
  add_ramps(subdomain,
            are_counts ? shape.ramp_weight / (section.levels * section.levels) : shape.ramp_weight);
}

void SubdomainSystem::add_ramps(const Subdomain& subdomain, double weight) {
  ramp_weight_ = weight;
  const double middle_x = (subdomain.x_low() + subdomain.x_high()) / 2.0;
  const double middle_y = (subdomain.y_low() + subdomain.y_high()) / 2.0;
  for (const TexelOffset& texel : texels) {
    const double width = std::ldexp(1.0, -texel.finer);
    centers_.push_back({(texel.x + 0.5) * width - middle_x, (texel.y + 0.5) * width - middle_y});
  }
  for (const Subdomain::Node& node : subdomain.quadrature(1)) {
    const std::array<double, kMaxTerms> polynomials = polynomials_at(basis, node);
    for (int p = 0; p < basis.count; ++p) {
      ramps_[p].x += node.weight * polynomials[p] * (node.x - middle_x);
      ramps_[p].y += node.weight * polynomials[p] * (node.y - middle_y);
    }
  }
  const std::size_t count = centers_.size();
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = 0; j < count; ++j) {
      products[i * count + j] +=
          weight * (centers_[i].x * centers_[j].x + centers_[i].y * centers_[j].y);
    }
    for (int p = 0; p < basis.count; ++p) {
      right_sides[i * basis.count + p] +=
          weight * (centers_[i].x * ramps_[p].x + centers_[i].y * ramps_[p].y);
    }
  }
  // The position of a sample is a polynomial of degree 1, which the basis represents exactly.
  for (int p = 0; p < basis.count; ++p) {
    filter_square += weight * (ramps_[p].x * ramps_[p].x + ramps_[p].y * ramps_[p].y);
  }
}

double SubdomainSystem::filter_error(const FittedSet& set) const {
  double distance = 0.0;
  for (int p = 0; p < basis.count; ++p) {
    Point2 missing = ramps_[p];
    for (std::size_t i = 0; i < set.members.size(); ++i) {
      const double weight = set.weights[i * basis.count + p];
      missing.x -= weight * centers_[set.members[i]].x;
      missing.y -= weight * centers_[set.members[i]].y;
    }
    distance += missing.x * missing.x + missing.y * missing.y;
  }
  return set.error - ramp_weight_ * distance;
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

  // At the minimum, up to the multiplier: the remaining part of the square of the filter.
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
