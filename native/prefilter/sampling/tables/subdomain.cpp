// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/sampling/tables/subdomain.h"

#include <algorithm>
#include <cmath>

#include "prefilter/base/gauss_rule.h"

namespace prefilter {
namespace {

constexpr int kNodesPerPanel = 8;  // per panel

struct LineNode {
  double x;
  double weight;
};

std::vector<LineNode> line_quadrature(double low, double high, int panels) {
  const auto& rule = gauss_rule<kNodesPerPanel>();
  const double width = (high - low) / panels;
  std::vector<LineNode> nodes;
  for (int panel = 0; panel < panels; ++panel) {
    for (int k = 0; k < kNodesPerPanel; ++k) {
      nodes.push_back({low + (panel + rule.nodes[k]) * width, rule.weights[k] * width});
    }
  }
  return nodes;
}

}  // namespace

Terms terms_at(double x, double y, double f) {
  return {1.0, x, y, f, x * x, y * y, f * f, x * y, x * f, y * f};
}

Subdomain::Subdomain(const TableShape& shape, const TableSection& section, int index) {
  const int slice = index / shape.subdomains_of_slice();
  int j = index % shape.subdomains_of_slice();
  int i = 0;
  while (j > i) j -= ++i;
  is_triangle_ = i == j;
  const double step = 1.0 / shape.grid;
  x_low_ = i * step;
  x_high_ = std::min(x_low_ + step, 0.5);
  y_low_ = j * step;
  y_high_ = std::min(y_low_ + step, 0.5);
  f_low_ = static_cast<double>(slice) / section.slices;
  f_high_ = static_cast<double>(slice + 1) / section.slices;
  has_f_ = section.levels > 1;
}

double Subdomain::volume() const {
  const double area = (x_high_ - x_low_) * (y_high_ - y_low_) * (is_triangle_ ? 0.5 : 1.0);
  return has_f_ ? area * (f_high_ - f_low_) : area;
}

std::vector<Subdomain::Node> Subdomain::quadrature(int panels) const {
  std::vector<Node> nodes;
  const std::vector<LineNode> along_f =
      has_f_ ? line_quadrature(f_low_, f_high_, panels) : std::vector<LineNode>{{0.0, 1.0}};
  const std::vector<LineNode> along_x = line_quadrature(x_low_, x_high_, panels);
  const std::vector<LineNode> along_y = line_quadrature(y_low_, y_high_, panels);
  const double panel_width = (y_high_ - y_low_) / panels;
  for (std::size_t i = 0; i < along_x.size(); ++i) {
    const LineNode& x = along_x[i];
    std::vector<LineNode> below = along_y;
    if (is_triangle_) {  // the panels below the diagonal, and the lower part of the one on it
      const std::size_t panel = i / kNodesPerPanel;
      below.resize(panel * kNodesPerPanel);
      const double begin = y_low_ + static_cast<double>(panel) * panel_width;
      const std::vector<LineNode> last = line_quadrature(begin, x.x, 1);
      below.insert(below.end(), last.begin(), last.end());
    }
    for (const LineNode& y : below) {
      for (const LineNode& f : along_f) {
        nodes.push_back({x.x, y.x, has_f_ ? f.x : x.x * y.x, x.weight * y.weight * f.weight});
      }
    }
  }
  return nodes;
}

OrthonormalBasis orthonormal_basis(const Subdomain& subdomain, int degree) {
  // Powers about the center, so that Gram-Schmidt does not lose precision.
  const std::array<double, 3> middle = {
      (subdomain.x_low() + subdomain.x_high()) / 2.0,
      (subdomain.y_low() + subdomain.y_high()) / 2.0,
      subdomain.has_f() ? (subdomain.f_low() + subdomain.f_high()) / 2.0 : 0.0};
  const auto [a, b, c] = middle;
  // Row p: the p-th power about the center as a combination of the powers about 0.
  const std::array<Terms, kMaxTerms> centered = {{
      {1.0},
      {-a, 1.0},
      {-b, 0.0, 1.0},
      {-c, 0.0, 0.0, 1.0},
      {a * a, -2.0 * a, 0.0, 0.0, 1.0},
      {b * b, 0.0, -2.0 * b, 0.0, 0.0, 1.0},
      {c * c, 0.0, 0.0, -2.0 * c, 0.0, 0.0, 1.0},
      {a * b, -b, -a, 0.0, 0.0, 0.0, 0.0, 1.0},
      {a * c, -c, 0.0, -a, 0.0, 0.0, 0.0, 0.0, 1.0},
      {b * c, 0.0, -c, -b, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0},
  }};
  const std::vector<Subdomain::Node> nodes = subdomain.quadrature(1);
  OrthonormalBasis basis;
  std::vector<std::vector<double>> values;  // of the polynomials so far, at the nodes
  for (int power = 0; power < (degree == 1 ? 4 : kMaxTerms); ++power) {
    constexpr int kXy = 7;
    if (power == kXy && !subdomain.has_f()) continue;  // f stands for xy
    Terms row = centered[power];
    std::vector<double> at_nodes;
    const auto value = [&](const Subdomain::Node& node) {
      const Terms terms = terms_at(node.x, node.y, node.f);
      double sum = 0.0;
      for (int q = 0; q < kMaxTerms; ++q) sum += row[q] * terms[q];
      return sum;
    };
    for (const Subdomain::Node& node : nodes) at_nodes.push_back(value(node));
    const auto subtract = [&](int p, double factor) {
      for (int q = 0; q < kMaxTerms; ++q) row[q] -= factor * basis.coefficients[p][q];
      for (std::size_t k = 0; k < nodes.size(); ++k) at_nodes[k] -= factor * values[p][k];
    };
    const auto product = [&](const std::vector<double>& with) {
      double sum = 0.0;
      for (std::size_t k = 0; k < nodes.size(); ++k) {
        sum += nodes[k].weight * at_nodes[k] * with[k];
      }
      return sum;
    };
    for (int pass = 0; pass < 2; ++pass) {
      for (int p = 0; p < basis.count; ++p) subtract(p, product(values[p]));
    }
    const double scale = 1.0 / std::sqrt(product(at_nodes));
    for (double& coefficient : row) coefficient *= scale;
    for (double& at_node : at_nodes) at_node *= scale;
    basis.coefficients[basis.count++] = row;
    values.push_back(std::move(at_nodes));
  }
  return basis;
}

}  // namespace prefilter
