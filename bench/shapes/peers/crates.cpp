// SPDX-License-Identifier: GPL-3.0-or-later

// vello_cpu and tiny-skia, through the functions that crates/src/lib.rs has.
#include "bench/shapes/rasterizers.h"

extern "C" {
void* shapes_crate_open(int crate, int width, int height);
void shapes_crate_build(void* drawing, const std::uint8_t* verbs, std::size_t verb_count,
                        const double* points, std::size_t value_count);
void shapes_crate_clear(void* drawing);
void shapes_crate_draw(void* drawing);
void shapes_crate_coverage(const void* drawing, std::uint8_t* bytes);
void shapes_crate_close(void* drawing);
}

namespace prefilter::bench {
namespace {

enum Crate { kVelloCpu = 0, kTinySkia = 1 };

class CrateDrawing final : public Drawing {
 public:
  CrateDrawing(const Pattern& pattern, Crate crate)
      : pattern_(pattern),
        drawing_(shapes_crate_open(crate, pattern.width, pattern.height), shapes_crate_close) {
    build();
  }

  void build() override {
    const Path& path = pattern_.path;
    shapes_crate_build(drawing_.get(), reinterpret_cast<const std::uint8_t*>(path.verbs.data()),
                       path.verbs.size(), path.points.data(), path.points.size());
  }
  void clear() override { shapes_crate_clear(drawing_.get()); }
  void draw() override { shapes_crate_draw(drawing_.get()); }

  std::vector<float> coverage() const override {
    std::vector<std::uint8_t> bytes(static_cast<std::size_t>(pattern_.width) * pattern_.height);
    shapes_crate_coverage(drawing_.get(), bytes.data());
    return from_bytes(bytes);
  }

 private:
  const Pattern& pattern_;
  std::unique_ptr<void, void (*)(void*)> drawing_;
};

Rasterizer rasterizer(const std::string& name, Crate crate) {
  return {name, false, [crate](const Pattern& pattern, double) {
            return std::make_unique<CrateDrawing>(pattern, crate);
          }};
}

}  // namespace

Rasterizer vello_cpu_rasterizer() { return rasterizer("vello_cpu", kVelloCpu); }
Rasterizer tiny_skia_rasterizer() { return rasterizer("tiny-skia", kTinySkia); }

}  // namespace prefilter::bench
