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

/// Taps of target texel `target` where a target texel is as wide as `scale` source texels, 1 or
/// more: the kernel at the source texels' centres; for the box, what it covers of each.
Taps downsampling_taps(Kernel kernel, double scale, int target);

}  // namespace prefilter
