// SPDX-License-Identifier: GPL-3.0-or-later

// Times of rasterizers on the same patterns, interleaved, and how far they are from the truth.
//
// usage: shapes_bench [--rounds N] [--rasterizers NAME;...] [--filters | --seams] [PATTERN...]
//
// --filters compares Prefilter's own filters, and AGG, instead. --seams draws 64 abutting quads one
// after another, and prints each rasterizer and the lowest value of the image, of 255.
//
// Prints a line for each rasterizer and setting of each pattern, with tabs in between: pattern,
// rasterizer, fineness (what its own tolerance of curves is divided by), minimum and median time
// [us], minimum with its path built anew [us], memory that the first drawing adds [MiB], largest
// and root mean square error.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <sstream>
#include <string_view>

#include "bench/peak_memory.h"
#include "bench/shapes/rasterizers.h"
#include "bench/shapes/reference.h"

namespace prefilter::bench {

std::vector<float> from_bytes(const std::vector<std::uint8_t>& bytes) {
  std::vector<float> values(bytes.size());
  std::transform(bytes.begin(), bytes.end(), values.begin(),
                 [](std::uint8_t byte) { return static_cast<float>(byte) / 255.0F; });
  return values;
}

namespace {

constexpr double kByte = 1.0 / 255.0;
constexpr double kFinest = 4096;
constexpr double kSecondsPerPattern = 20.0;

std::vector<Rasterizer> peers() {
  return {
#ifdef SHAPES_AGG
      agg_rasterizer(),       packed_agg_rasterizer(),
#endif
#ifdef SHAPES_CAIRO
      cairo_rasterizer(),
#endif
#ifdef SHAPES_FREETYPE
      freetype_rasterizer(),
#endif
#ifdef SHAPES_BLEND2D
      blend2d_rasterizer(),
#endif
#ifdef SHAPES_SKIA
      skia_rasterizer(),
#endif
#ifdef SHAPES_CRATES
      vello_cpu_rasterizer(), tiny_skia_rasterizer(),
#endif
  };
}

double seconds(const auto& work) {
  const auto began = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
}

struct Entry {
  std::string rasterizer;
  double fineness;
  std::unique_ptr<Drawing> drawing;
  double peak;
  Errors found;
  std::vector<double> times{}, times_with_path{};
};

/// Empty where the rasterizer cannot draw the pattern, or is not installed.
std::unique_ptr<Drawing> opened(const Rasterizer& rasterizer, const Pattern& pattern,
                                double fineness) {
  try {
    return rasterizer.open(pattern, fineness);
  } catch (const std::exception& failed) {
    std::fprintf(stderr, "%s: %s\n", rasterizer.name.c_str(), failed.what());
    return nullptr;
  }
}

Entry entry(const Rasterizer& rasterizer, const Pattern& pattern, double fineness,
            const std::vector<double>& truth) {
  Entry made{rasterizer.name, fineness, opened(rasterizer, pattern, fineness), 0.0, {}};
  if (!made.drawing) return made;
  made.drawing->clear();
  const PeakMemory memory;
  made.drawing->draw();
  made.peak = memory.added();
  made.found = errors(made.drawing->coverage(), truth);
  return made;
}

/// The coarsest setting at which no pixel is off by more than 1/255; or, as most round coordinates
/// and never get there, by more than 1/255 above the least that the rasterizer is off by at any.
Entry exact_entry(const Rasterizer& rasterizer, const Pattern& pattern,
                  const std::vector<double>& truth) {
  std::vector<double> finenesses, largest;
  for (double fineness = 1.0; fineness < kFinest; fineness *= std::sqrt(2.0)) {
    finenesses.push_back(fineness);
    largest.push_back(entry(rasterizer, pattern, fineness, truth).found.largest);
    if (largest.back() <= kByte) break;
  }
  const double least = *std::min_element(largest.begin(), largest.end());
  const auto first = std::find_if(largest.begin(), largest.end(), [&](double error) {
    return error <= (least <= kByte ? kByte : least + kByte);
  });
  return entry(rasterizer, pattern, finenesses[first - largest.begin()], truth);
}

/// The time of one drawing after another that is not in the clock, so that neither finds the memory
/// and the branches of the others in the processor's caches.
double drawing_time(Drawing& drawing, bool with_path) {
  const auto draw = [&] {
    if (with_path) drawing.build();
    drawing.draw();
  };
  drawing.clear();
  draw();
  drawing.clear();
  return seconds(draw);
}

void measure(std::vector<Entry>& entries, int rounds) {
  const double once = seconds([&] {
    for (const Entry& one : entries) drawing_time(*one.drawing, false);
  });
  rounds = std::clamp(static_cast<int>(kSecondsPerPattern / once), std::min(30, rounds), rounds);
  for (int round = 0; round < rounds; ++round) {
    for (Entry& one : entries) one.times.push_back(drawing_time(*one.drawing, false));
  }
  for (int round = 0; round < (rounds + 9) / 10; ++round) {
    for (Entry& one : entries) one.times_with_path.push_back(drawing_time(*one.drawing, true));
  }
}

void print(const std::string& pattern, const Entry& one) {
  std::vector<double> times = one.times;
  std::sort(times.begin(), times.end());
  std::printf("%s\t%s\t%.3f\t%.2f\t%.2f\t%.2f\t%.2f\t%.3g\t%.3g\n", pattern.c_str(),
              one.rasterizer.c_str(), one.fineness, 1e6 * times.front(),
              1e6 * times[times.size() / 2],
              1e6 * *std::min_element(one.times_with_path.begin(), one.times_with_path.end()),
              one.peak, one.found.largest, one.found.root_mean_square);
  std::fflush(stdout);
}

void compare(const Pattern& pattern, const std::vector<Rasterizer>& compared, int rounds) {
  const std::vector<double> truth = true_coverage(pattern);
  std::vector<Entry> entries;
  for (const Rasterizer& rasterizer : compared) {
    Entry own = entry(rasterizer, pattern, 1.0, truth);
    if (!own.drawing) continue;
    entries.push_back(std::move(own));
    if (!pattern.curved || !rasterizer.has_tolerance) continue;
    Entry exact = exact_entry(rasterizer, pattern, truth);
    if (exact.fineness != 1.0) entries.push_back(std::move(exact));
  }
  measure(entries, rounds);
  for (const Entry& one : entries) print(pattern.name, one);
}

void print_seam(const std::string& name, const std::vector<float>& coverage) {
  std::printf("%s\t%.2f\n", name.c_str(),
              255 * *std::min_element(coverage.begin(), coverage.end()));
}

void print_seams(const std::vector<Rasterizer>& compared) {
  for (const Rasterizer& rasterizer : compared) {
    Pattern pattern = abutting_quads();
    const std::vector<Path> quads = contours(pattern.path);
    const auto drawing = opened(rasterizer, pattern, 1.0);
    if (!drawing) continue;
    drawing->clear();
    for (const Path& quad : quads) {
      pattern.path = quad;
      drawing->build();
      drawing->draw();
    }
    print_seam(rasterizer.name, drawing->coverage());
  }
}

int main(int count, char** words) {
  int rounds = 200;
  bool filters = false, seams = false;
  std::vector<std::string> names, subjects;
  for (int word = 1; word < count; ++word) {
    const std::string_view option = words[word];
    if (option == "--rounds" && word + 1 < count) {
      rounds = std::max(1, std::atoi(words[++word]));
    } else if (option == "--rasterizers" && word + 1 < count) {
      std::istringstream list(words[++word]);
      for (std::string name; std::getline(list, name, ';');) names.push_back(name);
    } else if (option == "--filters") {
      filters = true;
    } else if (option == "--seams") {
      seams = true;
    } else {
      subjects.emplace_back(option);
    }
  }
  std::vector<Rasterizer> compared = filters ? our_filters() : peers();
#ifdef SHAPES_AGG
  if (filters) compared.push_back(agg_rasterizer());
#endif
  if (!filters && !seams) {
    std::vector<Rasterizer> boxes = our_boxes();
    compared.insert(compared.begin(), boxes.begin(), boxes.end());
  }
  std::erase_if(compared, [&](const Rasterizer& rasterizer) {
    return !names.empty() && std::find(names.begin(), names.end(), rasterizer.name) == names.end();
  });
  if (seams) {
    print_seam("Prefilter", our_sum(abutting_quads()));
    print_seams(compared);
    return 0;
  }
  for (const Pattern& pattern : patterns(subjects)) compare(pattern, compared, rounds);
  return 0;
}

}  // namespace
}  // namespace prefilter::bench

int main(int count, char** words) { return prefilter::bench::main(count, words); }
