// SPDX-License-Identifier: GPL-3.0-or-later

// Samples a second of tables and of trilinear interpolation, interleaved, on one thread.
//
// usage: sampling_bench [--rounds N] [--samples N]
//
// Prints a line for each sampler of each kind of texels and places, with tabs in between: texels,
// places, sampler, median, least and most of the rounds [Msamples/s], memory that its first round
// adds [MiB], and the root mean square difference from the samples of the first sampler.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <functional>
#include <memory>
#include <string_view>

#include "bench/peak_memory.h"
#include "bench/sampling/peers.h"
#include "bench/sampling/scenes.h"
#include "prefilter/sampling/build_table.h"
#include "prefilter/sampling/sample.h"

namespace prefilter::bench {
namespace {

struct Sampler {
  std::string name;
  std::function<void(const Samples&, float*)> sample;
  std::vector<double> rates{};
  double peak = 0.0;
  double difference = 0.0;
};

Sampler of_peer(const std::string& name, std::unique_ptr<Peer> peer) {
  return {name, [peer = std::shared_ptr<Peer>(std::move(peer))](
                    const Samples& samples, float* result) { peer->sample(samples, result); }};
}

Sampler ours(const std::string& name, const Pyramid& pyramid, const SamplingTable* table) {
  return {name, [pyramid, table](const Samples& samples, float* result) {
            SampleOptions options;
            options.wrap = {Wrap::kRepeat, Wrap::kRepeat};
            options.run = Run(1);
            sample(pyramid, table, samples.coordinates, samples.scales, options,
                   {result, samples.size() * kChannels});
          }};
}

std::vector<Sampler> samplers(const Texture& texture, bool bytes,
                              const std::vector<SamplingTable>& tables) {
  std::vector<Sampler> found;
  found.push_back(of_peer("trilinear, by hand", written_trilinear(texture, bytes)));
  for (const SamplingTable& table : tables) {
    found.push_back(
        ours(std::to_string(table.shape.texels) + " texels", texture.view(bytes), &table));
  }
  found.push_back(ours("trilinear", texture.view(bytes), nullptr));
#ifdef SAMPLING_OPENIMAGEIO
  found.push_back(of_peer("OpenImageIO", openimageio(texture, bytes)));
#endif
  return found;
}

double rate(const Sampler& sampler, const Samples& samples, std::vector<float>& result) {
  const auto began = std::chrono::steady_clock::now();
  sampler.sample(samples, result.data());
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - began;
  return 1e-6 * static_cast<double>(samples.size()) / took.count();
}

double root_mean_square(const std::vector<float>& a, const std::vector<float>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum / static_cast<double>(a.size()));
}

void measure(std::vector<Sampler>& compared, const Samples& samples, int rounds) {
  std::vector<float> result(samples.size() * kChannels);
  std::vector<float> reference;
  for (Sampler& sampler : compared) {
    const PeakMemory memory;
    rate(sampler, samples, result);
    sampler.peak = memory.added();
    if (reference.empty()) reference = result;
    sampler.difference = root_mean_square(result, reference);
    sampler.rates.clear();
  }
  for (int round = 0; round < rounds; ++round) {
    for (Sampler& sampler : compared) sampler.rates.push_back(rate(sampler, samples, result));
  }
}

int main(int count, char** words) {
  int rounds = 15;
  std::size_t sample_count = 1 << 18;
  for (int word = 1; word + 1 < count; word += 2) {
    const std::string_view option = words[word];
    const int value = std::max(1, std::atoi(words[word + 1]));
    if (option == "--rounds") rounds = value;
    if (option == "--samples") sample_count = static_cast<std::size_t>(std::max(value, 64));
  }
  std::vector<SamplingTable> tables;
  for (const int texels : {8, 6, 4}) {
    BuildTableOptions options;
    options.shape.texels = texels;
    tables.push_back(build_sampling_table(options));
  }
  const Texture texture;
  const std::vector<Samples> scenes = samples_of_scenes(sample_count);
  for (const bool bytes : {true, false}) {
    std::vector<Sampler> compared = samplers(texture, bytes, tables);
    for (const Samples& samples : scenes) {
      measure(compared, samples, rounds);
      for (Sampler& one : compared) {
        std::sort(one.rates.begin(), one.rates.end());
        std::printf("%s\t%s\t%s\t%.2f\t%.2f\t%.2f\t%.1f\t%.2e\n", bytes ? "bytes" : "floats",
                    samples.name.c_str(), one.name.c_str(), one.rates[one.rates.size() / 2],
                    one.rates.front(), one.rates.back(), one.peak, one.difference);
      }
      std::fflush(stdout);
    }
  }
  return 0;
}

}  // namespace
}  // namespace prefilter::bench

int main(int count, char** words) {
  try {
    return prefilter::bench::main(count, words);
  } catch (const std::exception& failed) {
    std::fprintf(stderr, "sampling_bench: %s\n", failed.what());
    return 1;
  }
}
