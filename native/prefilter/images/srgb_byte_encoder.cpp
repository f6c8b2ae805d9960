// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/images/srgb_byte_encoder.h"

#include <bit>
#include <limits>

#include "prefilter/images/transfer.h"

namespace prefilter {
namespace {

int nearest_byte(float linear) { return static_cast<int>(linear_to_srgb(linear) * 255.0F + 0.5F); }

// The smallest value in [0, 1] with this byte, by bisection over the bit patterns of positive
// floats, which are ordered like their values.
float least_value_of(int byte) {
  std::uint32_t below = 0;
  auto at = std::bit_cast<std::uint32_t>(1.0F);
  while (at - below > 1) {
    const std::uint32_t middle = below + (at - below) / 2;
    (nearest_byte(std::bit_cast<float>(middle)) >= byte ? at : below) = middle;
  }
  return std::bit_cast<float>(at);
}

}  // namespace

SrgbByteEncoder::SrgbByteEncoder() {
  for (int byte = 1; byte <= kLast; ++byte) begin_[byte] = least_value_of(byte);
  begin_[kLast + 1] = std::numeric_limits<float>::infinity();
  int byte = 0;
  for (int step = 0; step < kSteps; ++step) {
    while (static_cast<float>(step) / kSteps >= begin_[byte + 1]) ++byte;
    first_[step] = static_cast<std::uint8_t>(byte);
  }
}

const SrgbByteEncoder& SrgbByteEncoder::instance() {
  static const SrgbByteEncoder encoder;
  return encoder;
}

}  // namespace prefilter
