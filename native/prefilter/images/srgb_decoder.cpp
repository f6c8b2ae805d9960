// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/images/srgb_decoder.h"

#include "prefilter/base/elementary.h"
#include "prefilter/images/transfer.h"

namespace prefilter {

SrgbDecoder::SrgbDecoder() {
  for (int i = 0; i <= kSteps; ++i) {
    table_.push_back(srgb_to_linear(static_cast<float>(i) / kSteps));
  }
}

const SrgbDecoder& SrgbDecoder::instance() {
  static const SrgbDecoder decoder;
  return decoder;
}

SrgbDecoder::Result SrgbDecoder::outside(float encoded) {
  const float magnitude = std::abs(encoded);
  const float slope = magnitude <= 0.04045F
                          ? 1.0F / 12.92F
                          : 2.4F / 1.055F * elementary::pow((magnitude + 0.055F) / 1.055F, 1.4F);
  return {srgb_to_linear(encoded), slope};
}

}  // namespace prefilter
