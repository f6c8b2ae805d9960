// SPDX-License-Identifier: GPL-3.0-or-later

// Images of shapes by Haar wavelets: chapter 3 in the plane.
#pragma once

#include "prefilter/base/image.h"
#include "prefilter/base/run.h"
#include "prefilter/shapes/raster/raster_layers.h"

namespace prefilter {

/// Number of times the smallest square that holds the image, with a power of two as side, can be
/// halved.
int wavelet_depth(int width, int height);

/// Sets an image to the background plus the sum of each layer's constant color times the winding
/// numbers of its outlines, as means over the cells of a depth (0 to wavelet_depth, at which cells
/// are pixels). Throws Error for an image wider or higher than 2^24 pixels.
void add_up_wavelets(const RasterLayers& job, int depth, const Run& run, Image* image);

}  // namespace prefilter
