// SPDX-License-Identifier: GPL-3.0-or-later

// Tables that say which few texels of a mipmap make up a filter of any place and scale, and with
// which weights (section 6.2).
//
// A sample lies in a cell: a texel of the coarser one of the two levels around its mip value. x and
// y in [0, 1) say where in the cell it lies, f in [0, 1] how far the mip value is above the finer
// level, so that the filter is 2^(f - 1) cells wide. The square is symmetric: x and y are folded
// to 0 <= y <= x <= 1/2 (see FoldedPlace), and what is left is cut into subdomains. Each has a set
// of texels, of the cell's level and of finer ones, whose weights are polynomials in x, y and f.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "prefilter/base/names.h"

namespace prefilter {

inline constexpr int kFewestTexels = 2;
inline constexpr int kMostTexels = 16;
inline constexpr int kMostTerms = 10;
inline constexpr double kMostRampWeight = 1e6;
inline constexpr int kMostParts = 16;  // of a cell along an axis, and from level to level

/// A texel relative to a cell.
struct TexelOffset {
  int finer = 0;  // levels below the cell's: 0, 1 or 2
  int x = 0;      // texels of that level from the cell's low corner: inside it, 0 to 2^finer - 1
  int y = 0;

  bool operator==(const TexelOffset&) const = default;
};

/// What images are taken to be when a table is built: how much it counts what the texels leave of a
/// filter at each frequency.
enum class ImageSpectrum {
  kNatural,  // power falls with the square of the frequency, as of photographs: edges and ramps
  kWhite,    // noise, with as much power at all frequencies: equation 6.3 as it is printed
};
inline constexpr Named<ImageSpectrum> kImageSpectra[] = {{"natural", ImageSpectrum::kNatural},
                                                         {"white", ImageSpectrum::kWhite}};

/// How a table is divided, and what its error is.
struct TableShape {
  std::string filter = "lanczos2";  // of kernels(): that of the levels
  int texels = 8;                   // kFewestTexels to kMostTexels
  int grid = 4;                     // parts of a cell along x, and along y
  int slices = 2;                   // parts from one level to the next
  int degree = 1;                   // of the weights in x, y and f: 1, or 2
  // How much it counts, when a table is built, that the weighted center of a sample's texels is
  // where the sample is: its squared distance in cells, against equation 6.3. Ramps then come out
  // as they are, and do not step from subdomain to subdomain. 0 to kMostRampWeight.
  double ramp_weight = 5.0;
  ImageSpectrum spectrum = ImageSpectrum::kNatural;
  std::string target{};  // of kernels(): what samples are to be; empty: the filter of the levels

  const std::string& sample_filter() const { return target.empty() ? filter : target; }

  /// Of a polynomial: 1, x, y, f, and for degree 2 also xx, yy, ff, xy, xf, yf. Where only one
  /// level is there f has nothing to tell, and stands for xy: what bilinear weights need.
  int terms() const { return degree == 1 ? 4 : 10; }
  /// Of the folded square: (i, j) with j <= i < columns().
  int columns() const { return (grid + 1) / 2; }
  int subdomains_of_slice() const { return columns() * (columns() + 1) / 2; }
};

/// The sets of all subdomains where this many levels are there: the cell's and those below it.
/// Where there is only one the cell is a texel of level 0, the filter is as wide as that, there is
/// one slice, and f is the product of the folded x and y.
struct TableSection {
  int levels = 3;
  int slices = 2;
  // By subdomain, see subdomain_of:
  std::vector<TexelOffset> texels;   // [subdomain][texel]
  std::vector<double> coefficients;  // [subdomain][texel][term]; of a term they sum to 1 or to 0
  std::vector<double> errors;  // [subdomain]: equation 6.3 by the spectrum, integrated over it
  std::vector<double> trilinear_errors;  // of trilinear interpolation, likewise
  std::vector<double> gaps;  // [subdomain]: how much lower what is minimized may still be for
                             // another set, as a share of it; 0 where proven optimal; empty if not
                             // certified
};

/// A section for three, two and one available levels, in this order.
struct SamplingTable {
  TableShape shape;
  std::array<TableSection, 3> sections;

  const TableSection& section(int levels) const { return sections[3 - levels]; }
};

/// A place in a cell, folded into the triangle that the table covers.
struct FoldedPlace {
  double x;
  double y;
  bool mirror_x;  // x was above 1/2: in texels of a level, i stands for 2^finer - 1 - i
  bool mirror_y;
  bool swapped;  // after that y was above x: they have changed places
};
FoldedPlace fold_place(double x, double y);

/// The texel that an offset of the table stands for at a place that was folded.
TexelOffset unfold(const TexelOffset& offset, const FoldedPlace& place);

/// Which subdomain of a section a folded place lies in: slice by slice, (i, j) at i (i + 1) / 2 +
/// j.
int subdomain_of(const TableShape& shape, const TableSection& section, double x, double y,
                 double f);

/// The value of the polynomial with these coefficients, at a folded place. For a section of one
/// level f is xy.
double weight_at(const double* coefficients, int degree, double x, double y, double f);

/// Throws Error for a shape that is out of range.
void check_shape(const TableShape& shape);

/// Throws Error for a table that no sample can be taken with: sizes that disagree, offsets beyond a
/// reach of 64 texels, coefficients that are not finite or whose sums are off by more than 1e-6.
void check_table(const SamplingTable& table);

}  // namespace prefilter
