// SPDX-License-Identifier: GPL-3.0-or-later

#include <OpenImageIO/imageio.h>
#include <OpenImageIO/texture.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <stdexcept>
#include <string>

#include "bench/sampling/peers.h"

namespace prefilter::bench {
namespace {

constexpr int kTile = 64;

/// A tiled TIFF with all levels, as maketx writes it; removed at the end.
class TextureFile {
 public:
  TextureFile(const Texture& texture, bool bytes)
      : path_(std::filesystem::temp_directory_path() /
              ("sampling_bench-" + std::to_string(::getpid()) + (bytes ? "-bytes.tif" : ".tif"))) {
    const auto output = OIIO::ImageOutput::create(path_.string());
    if (!output) throw std::runtime_error(OIIO::geterror());
    for (std::size_t i = 0; i < texture.floats.size(); ++i) {
      OIIO::ImageSpec spec(kSide >> i, kSide >> i, kChannels,
                           bytes ? OIIO::TypeDesc::UINT8 : OIIO::TypeDesc::FLOAT);
      spec.tile_width = spec.tile_height = kTile;
      spec.attribute("textureformat", "Plain Texture");
      const auto mode = i == 0 ? OIIO::ImageOutput::Create : OIIO::ImageOutput::AppendSubimage;
      const void* texels = bytes ? static_cast<const void*>(texture.bytes[i].data())
                                 : static_cast<const void*>(texture.floats[i].data());
      if (!output->open(path_.string(), spec, mode) || !output->write_image(spec.format, texels)) {
        throw std::runtime_error(output->geterror());
      }
    }
    output->close();
  }
  ~TextureFile() { std::filesystem::remove(path_); }
  TextureFile(const TextureFile&) = delete;
  TextureFile& operator=(const TextureFile&) = delete;

  std::string path() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

class OpenImageIo : public Peer {
 public:
  OpenImageIo(const Texture& texture, bool bytes)
      : file_(texture, bytes), system_(OIIO::TextureSystem::create(false)) {
    system_->attribute("max_memory_MB", 512.0F);
    thread_ = system_->get_perthread_info();
    handle_ = system_->get_texture_handle(OIIO::ustring(file_.path()), thread_);
    options_.swrap = options_.twrap = OIIO::TextureOpt::WrapPeriodicPow2;
    options_.mipmode = OIIO::TextureOpt::MipModeTrilinear;
    options_.interpmode = OIIO::TextureOpt::InterpBilinear;
  }
  ~OpenImageIo() override { OIIO::TextureSystem::destroy(system_); }

  void sample(const Samples& samples, float* result) override {
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const auto [u, v] = samples.float_coordinates[i];
      const float width = samples.float_scales[i] / kSide;
      if (!system_->texture(handle_, thread_, options_, u, v, width, 0.0F, 0.0F, width, kChannels,
                            result + kChannels * i)) {
        throw std::runtime_error(system_->geterror());
      }
    }
  }

 private:
  TextureFile file_;
  OIIO::TextureSystem* system_;
  OIIO::TextureSystem::Perthread* thread_;
  OIIO::TextureSystem::TextureHandle* handle_;
  OIIO::TextureOpt options_;
};

}  // namespace

std::unique_ptr<Peer> openimageio(const Texture& texture, bool bytes) {
  return std::make_unique<OpenImageIo>(texture, bytes);
}

}  // namespace prefilter::bench
