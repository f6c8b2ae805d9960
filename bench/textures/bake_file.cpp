// SPDX-License-Identifier: GPL-3.0-or-later

// Makes a mip-mapped TIFF of a picture file, as a program built around the library would.
//
// usage: prefilter_bake_file PICTURE MESH TARGET FILTER THREADS, with an 8-bit RGBA or RGB PNG as
// the picture, and mesh.bin of scene.py as the mesh.
#include <png.h>
#include <tiffio.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <exception>
#include <fstream>
#include <iostream>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "prefilter/geometry/surface.h"
#include "prefilter/images/transfer.h"
#include "prefilter/textures/mipmaps.h"

namespace {

using prefilter::Image;
using prefilter::MipmapOptions;
using prefilter::Surface;
using prefilter::TexelSource;

struct Bytes {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> data;  // RGBA, row 0 at the bottom
};

Bytes read_picture(const char* path) {
  png_image file{};
  file.version = PNG_IMAGE_VERSION;
  if (png_image_begin_read_from_file(&file, path) == 0) throw std::runtime_error(file.message);
  file.format = PNG_FORMAT_RGBA;
  Bytes picture{static_cast<int>(file.width), static_cast<int>(file.height), {}};
  picture.data.resize(PNG_IMAGE_SIZE(file));
  const auto stride = -static_cast<png_int_32>(PNG_IMAGE_ROW_STRIDE(file));
  if (png_image_finish_read(&file, nullptr, picture.data.data(), stride, nullptr) == 0) {
    throw std::runtime_error(file.message);
  }
  return picture;
}

template <typename Value>
std::vector<Value> read_values(std::istream& file, std::int64_t count) {
  std::vector<Value> values(static_cast<std::size_t>(count));
  file.read(reinterpret_cast<char*>(values.data()),
            static_cast<std::streamsize>(values.size() * sizeof(Value)));
  return values;
}

Surface read_mesh(const char* path) {
  std::ifstream file(path, std::ios::binary);
  const std::vector<std::int64_t> counts = read_values<std::int64_t>(file, 2);
  if (!file) throw std::runtime_error(std::string("cannot read '") + path + "'");
  const auto positions = read_values<prefilter::Vector3>(file, counts[0]);
  const auto triangles = read_values<std::array<std::int64_t, 3>>(file, counts[1]);
  const auto uvs = read_values<double>(file, 6 * counts[1]);
  if (!file) throw std::runtime_error(std::string("'") + path + "' ends too early");
  return prefilter::make_surface({{positions, triangles}, uvs.data()});
}

class TiffFile {
 public:
  explicit TiffFile(const char* path) : file_(TIFFOpen(path, "w")) {
    if (!file_) throw std::runtime_error(std::string("cannot write '") + path + "'");
  }

  // Adds a level of RGBA bytes, row 0 at the bottom.
  void add(const std::uint8_t* data, int width, int height) {
    // The tile size of maketx.
    constexpr int kTile = 64;
    TIFF* tiff = file_.get();
    if (levels_++ > 0) TIFFSetField(tiff, TIFFTAG_SUBFILETYPE, FILETYPE_REDUCEDIMAGE);
    TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, width);
    TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, height);
    TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, 8);
    TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 4);
    const std::uint16_t alpha = EXTRASAMPLE_ASSOCALPHA;
    TIFFSetField(tiff, TIFFTAG_EXTRASAMPLES, 1, &alpha);
    TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_RGB);
    TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
    TIFFSetField(tiff, TIFFTAG_COMPRESSION, COMPRESSION_ADOBE_DEFLATE);
    TIFFSetField(tiff, TIFFTAG_PREDICTOR, PREDICTOR_HORIZONTAL);
    TIFFSetField(tiff, TIFFTAG_TILEWIDTH, kTile);
    TIFFSetField(tiff, TIFFTAG_TILELENGTH, kTile);
    std::vector<std::uint8_t> tile(std::size_t{4} * kTile * kTile);
    for (int y0 = 0; y0 < height; y0 += kTile) {
      for (int x0 = 0; x0 < width; x0 += kTile) {
        std::fill(tile.begin(), tile.end(), 0);
        const auto row_size = static_cast<std::size_t>(4 * std::min(kTile, width - x0));
        for (int y = y0; y < std::min(y0 + kTile, height); ++y) {
          const std::size_t from = static_cast<std::size_t>(height - 1 - y) * width + x0;
          std::memcpy(tile.data() + std::size_t{4} * (y - y0) * kTile, data + 4 * from, row_size);
        }
        if (TIFFWriteTile(tiff, tile.data(), x0, y0, 0, 0) < 0) fail();
      }
    }
    if (TIFFWriteDirectory(tiff) == 0) fail();
  }

 private:
  [[noreturn]] static void fail() { throw std::runtime_error("cannot write the TIFF file"); }

  struct Close {
    void operator()(TIFF* file) const { TIFFClose(file); }
  };

  std::unique_ptr<TIFF, Close> file_;
  int levels_ = 0;
};

void bake(const char* picture_path, const char* mesh_path, const char* target,
          const std::string& filter, int threads) {
  const Bytes picture = read_picture(picture_path);
  const Surface surface = read_mesh(mesh_path);
  const prefilter::ByteValues values = prefilter::byte_values(true);
  MipmapOptions options;
  options.filter = prefilter::mipmap_filter(filter);
  options.wrap = {prefilter::Wrap::kRepeat, prefilter::Wrap::kRepeat};
  options.run = prefilter::Run(threads);
  std::vector<Image> levels = prefilter::coarser_levels(
      TexelSource(picture.data.data(), picture.width, picture.height, 4, &values), {&surface},
      options);
  TiffFile file(target);
  file.add(picture.data.data(), picture.width, picture.height);
  for (const Image& level : levels) {
    const auto bytes = prefilter::to_bytes(level.view(), true, threads);
    file.add(bytes.data(), level.width, level.height);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 6) {
    std::cerr << "usage: " << argv[0] << " PICTURE MESH TARGET FILTER THREADS\n";
    return 2;
  }
  try {
    bake(argv[1], argv[2], argv[3], argv[4], std::stoi(argv[5]));
  } catch (const std::exception& error) {
    std::cerr << argv[0] << ": " << error.what() << '\n';
    return 1;
  }
  return 0;
}
