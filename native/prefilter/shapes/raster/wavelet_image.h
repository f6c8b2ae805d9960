// SPDX-License-Identifier: GPL-3.0-or-later

// The image of shapes by Haar wavelets: chapter 3, in the plane.
#pragma once

#include "prefilter/base/image.h"
#include "prefilter/base/progress.h"
#include "prefilter/shapes/raster/raster_layers.h"

namespace prefilter {

/// How often the square of the smallest power of two that holds an image can be halved.
int wavelet_depth(int width, int height);

/// Sets an image to the background plus each layer's color, a constant one, times the winding
/// numbers of its outlines, as means over those cells of a depth (0 to wavelet_depth: pixels) that
/// the pixels are in. Throws Error for an image wider or higher than 2^24 pixels.
void add_up_wavelets(const RasterLayers& job, int depth, int threads, const Progress& progress,
                     Image* image);

}  // namespace prefilter
