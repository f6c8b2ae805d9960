// SPDX-License-Identifier: GPL-3.0-or-later

// Time, memory and quality of mipmaps, by filter, image size and number of triangles.
//
// Items are texels of level 0. A benchmark without a quality figure is no benchmark, so each has
// the error over the surface (mipmap_error, RMSE) at levels 1, 3 and 6 beside it. All processors
// are used.
#include <benchmark/benchmark.h>

#include <string>
#include <vector>

#include "bench/peak_memory.h"
#include "bench/textures/scene.h"
#include "prefilter/textures/mipmap_error.h"
#include "prefilter/textures/mipmaps.h"

namespace prefilter::bench {
namespace {

void add_errors(benchmark::State& state, const std::vector<Image>& levels, const Image& image,
                const Surface& surface) {
  std::vector<ImageView> views;
  for (const Image& level : levels) views.push_back(level.view());
  const std::vector<double> errors =
      mipmap_error(views, image.view(), {&surface}, {1.0, 3.0, 6.0}, {}, Reader::kLinear, {}, 0);
  state.counters["error1"] = errors[0];
  state.counters["error3"] = errors[1];
  state.counters["error6"] = errors[2];
}

void mipmap_bench(benchmark::State& state, const std::string& filter) {
  const Image image = detailed_picture(static_cast<int>(state.range(0)));
  const Surface surface = charts(static_cast<int>(state.range(1)));
  MipmapOptions options;
  options.filter = mipmap_filter(filter);
  std::vector<Image> levels;
  const PeakMemory memory;
  for (auto _ : state) levels = mipmaps(image.view(), {&surface}, options);
  state.counters["MiB"] = memory.added();
  state.SetItemsProcessed(static_cast<std::int64_t>(image.view().texel_count()) *
                          state.iterations());
  add_errors(state, levels, image, surface);
}

void sizes_and_triangles(benchmark::internal::Benchmark* benchmark) {
  benchmark->ArgNames({"size", "triangles"});
  benchmark->ArgsProduct({{256, 512, 1024, 2048}, {10'000, 1'000'000}});
  benchmark->Unit(benchmark::kMillisecond)->UseRealTime();
}

// The plain filters do not look at the surface: its size matters to their errors alone.
BENCHMARK_CAPTURE(mipmap_bench, pam_bilinear, "pam-bilinear")->Apply(sizes_and_triangles);
BENCHMARK_CAPTURE(mipmap_bench, pam_box, "pam-box")->Apply(sizes_and_triangles);
BENCHMARK_CAPTURE(mipmap_bench, lanczos3, "lanczos3")->Apply(sizes_and_triangles);
BENCHMARK_CAPTURE(mipmap_bench, box, "box")->Apply(sizes_and_triangles);

}  // namespace
}  // namespace prefilter::bench
