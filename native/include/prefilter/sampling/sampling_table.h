// SPDX-License-Identifier: GPL-3.0-or-later

// Tables of a few mipmap texels and their weights which approximate a filter at any position and
// scale (section 6.2).
//
// A sample lies in a cell: a texel of the coarser of the two levels around its mip value. Its
// position in the cell is x and y in [0, 1); f in [0, 1] is the distance of the mip value from the
// finer level, so that the filter is 2^(f - 1) cells wide. The symmetries of the square fold x and
// y to 0 <= y <= x <= 1/2 (see FoldedPlace). This triangle is divided into subdomains. Each has a
// set of texels, of the cell's level and finer ones, whose weights are polynomials in x, y and f.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "prefilter/base/names.h"

namespace prefilter {

inline constexpr int kMinTexels = 2;
inline constexpr int kMaxTexels = 16;
inline constexpr int kMaxTerms = 10;
inline constexpr double kMaxRampWeight = 1e6;
inline constexpr int kMaxParts = 16;  // of a cell along an axis, and from level to level

/// A texel relative to a cell.
struct TexelOffset {
  int finer = 0;  // level relative to the cell's, toward the finest: 0, 1 or 2
  int x = 0;      // in texels of its level from the cell's low corner; 0 to 2^finer - 1 in the cell
  int y = 0;

  bool operator==(const TexelOffset&) const = default;
};

/// The image statistics assumed when a table is built. They weight the error at each frequency.
enum class ImageSpectrum {
  kNatural,  // power falls with the square of the frequency, as in photographs: edges and ramps
  kWhite,    // white noise, equal power at all frequencies: equation 6.3 as printed
};
inline constexpr Named<ImageSpectrum> kImageSpectra[] = {{"natural", ImageSpectrum::kNatural},
                                                         {"white", ImageSpectrum::kWhite}};

/// Subdivision and polynomials of a table, and its error measure.
struct TableShape {
  std::string filter = "lanczos2";  // name of the kernel of the levels
  int texels = 8;                   // kMinTexels to kMaxTexels
  int grid = 4;                     // parts of a cell along x, and along y
  int slices = 2;                   // parts from one level to the next
  int degree = 1;                   // of the weights in x, y and f: 1, or 2
  // Weight, relative to equation 6.3, of the squared distance in cells between the weighted center
  // of a sample's texels and the sample. It reproduces linear ramps, without steps between
  // subdomains. 0 to kMaxRampWeight.
  double ramp_weight = 5.0;
  ImageSpectrum spectrum = ImageSpectrum::kNatural;
  std::string target{};  // name of the kernel to approximate; empty: the filter of the levels

  const std::string& sample_filter() const { return target.empty() ? filter : target; }

  /// Number of terms of the polynomials: 1, x, y, f, and for degree 2 also xx, yy, ff, xy, xf, yf.
  /// If there is a single level, f has no meaning and stands for xy, which bilinear weights need.
  int terms() const { return degree == 1 ? 4 : 10; }
  /// Size of the folded square, whose subdomains are (i, j) with j <= i < columns().
  int columns() const { return (grid + 1) / 2; }
  int subdomains_of_slice() const { return columns() * (columns() + 1) / 2; }
};

/// The sets of all subdomains for a number of available levels: the cell's and those below it. If
/// there is a single level, the cell is a texel of level 0, the filter has its width, there is one
/// slice, and f is the product of the folded x and y.
struct TableSection {
  int levels = 3;
  int slices = 2;
  // Indexed by subdomain, see subdomain_of:
  std::vector<TexelOffset> texels;   // [subdomain][texel]
  std::vector<double> coefficients;  // [subdomain][texel][term]; those of a term sum to 1 or to 0
  std::vector<double> errors;  // [subdomain]: integral of equation 6.3, weighted by the spectrum
  std::vector<double> trilinear_errors;  // the same for trilinear interpolation
  std::vector<double> gaps;  // [subdomain]: bound on the relative improvement of the objective by
                             // any other set; 0 if proven optimal; empty if not certified
};

/// A section for three, two and one available levels, in this order.
struct SamplingTable {
  TableShape shape;
  std::array<TableSection, 3> sections;

  const TableSection& section(int levels) const { return sections[3 - levels]; }
};

/// A position in a cell, folded into the triangle that the table covers.
struct FoldedPlace {
  double x;
  double y;
  bool mirror_x;  // x was above 1/2: texel i of a level stands for 2^finer - 1 - i
  bool mirror_y;
  bool swapped;  // then y was above x, and they were swapped
};
FoldedPlace fold_place(double x, double y);

/// The texel that an offset in the table stands for, at a folded position.
TexelOffset unfold(const TexelOffset& offset, const FoldedPlace& place);

/// The subdomain of a section at a folded position. They are ordered slice by slice, with (i, j) at
/// i (i + 1) / 2 + j.
int subdomain_of(const TableShape& shape, const TableSection& section, double x, double y,
                 double f);

/// The value of the polynomial with these coefficients at a folded position. For a section with one
/// level f is xy.
double weight_at(const double* coefficients, int degree, double x, double y, double f);

/// Throws Error if a shape is out of range.
void check_shape(const TableShape& shape);

/// Throws Error if a table cannot be sampled: for sizes that do not match, offsets beyond 64
/// texels, coefficients that are not finite, or sums of coefficients off by more than 1e-6.
void check_table(const SamplingTable& table);

}  // namespace prefilter
