// Filter kernels in one dimension, in units of the target's texels.
#pragma once

#include <vector>

namespace prefilter {

enum class Kernel {
  kBox,       // 1 on [-1/2, 1/2]
  kTent,      // 1 - |x| on [-1, 1]
  kLanczos3,  // sinc(x) sinc(x / 3) on [-3, 3]
};

/// Half the width of a kernel's support.
double kernel_radius(Kernel kernel);

/// The kernel at x; 0 outside of its support.
double kernel_value(Kernel kernel, double x);

/// The weights with which source texels first, first + 1, ... make up one target texel.
struct Taps {
  int first = 0;
  std::vector<double> weights;  // sum to 1
};

/// Taps of target texel 0 where every target texel is made of `factor` source texels: the kernel at
/// the source texels' centres. Those of texel j start at first + j * factor.
Taps downsampling_taps(Kernel kernel, int factor);

}  // namespace prefilter
