// SPDX-License-Identifier: GPL-3.0-or-later

#include <filesystem>
#include <fstream>
#include <memory>
#include <string>

#include "fuzz/targets.h"
#include "prefilter/base/error.h"
#include "prefilter/base/random_name.h"
#include "prefilter/points/open_points.h"
#include "prefilter/points/ply_faces.h"

namespace prefilter {
namespace {

constexpr std::size_t kAtOnce = 1000;

// A file of these bytes that goes with this.
class Written {
 public:
  Written(std::span<const std::uint8_t> bytes, const std::string& ending) {
    const std::string folder = std::filesystem::temp_directory_path().string();
    // One name for each process: a fuzzer writes a million.
    static const std::string name = folder + "/fuzz-" + random_name();
    path_ = name + ending;
    std::ofstream file(path_, std::ios::binary | std::ios::trunc);
    file.write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
  }
  Written(const Written&) = delete;
  Written& operator=(const Written&) = delete;
  ~Written() { std::filesystem::remove(path_); }

  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

void read_points(const std::string& path) {
  const std::unique_ptr<PointSource> source = open_points(path);
  PointBatch batch;
  for (int pass = 0; pass < 2; ++pass) {
    source->rewind();
    while (source->read(kAtOnce, &batch)) {
    }
  }
}

template <class Read>
void refused_or_not(const Read& read) {
  try {
    read();
  } catch (const Error&) {
  }
}

void read_points_of(std::span<const std::uint8_t> bytes, const std::string& ending) {
  const Written file(bytes, ending);
  refused_or_not([&] { read_points(file.path()); });
}

}  // namespace

void read_ply(std::span<const std::uint8_t> bytes) {
  const Written file(bytes, ".ply");
  refused_or_not([&] { read_points(file.path()); });
  refused_or_not([&] { read_range_grid(file.path(), prefilter::Run()); });
  refused_or_not([&] { read_faces(file.path(), prefilter::Run()); });
}

void read_pcd(std::span<const std::uint8_t> bytes) { read_points_of(bytes, ".pcd"); }
void read_ptx(std::span<const std::uint8_t> bytes) { read_points_of(bytes, ".ptx"); }
void read_obj(std::span<const std::uint8_t> bytes) { read_points_of(bytes, ".obj"); }
void read_text(std::span<const std::uint8_t> bytes) { read_points_of(bytes, ".xyz"); }

}  // namespace prefilter
