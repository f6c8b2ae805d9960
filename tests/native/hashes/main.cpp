// SPDX-License-Identifier: GPL-3.0-or-later

// Prints a line for each of many results: its name, and a hash of its bits. The hashes
// must be equal for all builds, on all systems and with any number of threads.
// usage: prefilter_hashes [THREADS [PART]]: 0 = all processors; only names that begin with PART

#include <array>
#include <bit>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "hashes/inputs.h"
#include "prefilter/base/names.h"
#include "prefilter/geometry/subdivision.h"
#include "prefilter/images/exr_tiles.h"
#include "prefilter/images/resize.h"
#include "prefilter/images/transfer.h"
#include "prefilter/points/mesh_sink.h"
#include "prefilter/points/normals.h"
#include "prefilter/points/reconstruct.h"
#include "prefilter/sampling/build_table.h"
#include "prefilter/sampling/resample.h"
#include "prefilter/sampling/sample.h"
#include "prefilter/shapes/rasterize.h"
#include "prefilter/shapes/stroke.h"
#include "prefilter/textures/compress_blocks.h"
#include "prefilter/textures/fit_to_views.h"
#include "prefilter/textures/mipmap_filter.h"
#include "prefilter/textures/mipmaps.h"
#include "prefilter/textures/normal_mipmaps.h"
#include "prefilter/textures/supercompress.h"
#include "prefilter/voxels/as_solid.h"
#include "prefilter/voxels/close_holes.h"
#include "prefilter/voxels/combine.h"
#include "prefilter/voxels/quad_contour.h"
#include "prefilter/voxels/tree_contour.h"
#include "prefilter/voxels/voxelize.h"

namespace prefilter::hashes {
namespace {

class Hash {
 public:
  template <typename T>
  Hash& add(const std::vector<T>& values) {
    return add(values.data(), values.size() * sizeof(T));
  }
  Hash& add(const Image& image) { return add(image.data); }
  Hash& add(const std::vector<Image>& images) {
    for (const Image& image : images) add(image);
    return *this;
  }
  Hash& add(const TriangleMesh& mesh) { return add(mesh.positions).add(mesh.triangles); }
  Hash& add(const Octree& octree) {
    for (const TreeLevel& level : octree.cells.levels) add(level.blocks).add(level.split);
    return *this;
  }
  std::uint64_t value() const { return value_; }

 private:
  Hash& add(const void* data, std::size_t size) {
    const auto* bytes = static_cast<const unsigned char*>(data);
    for (std::size_t i = 0; i < size; ++i) value_ = (value_ ^ bytes[i]) * 0x100000001B3U;
    value_ = (value_ ^ size) * 0x100000001B3U;
    return *this;
  }

  std::uint64_t value_ = 0xCBF29CE484222325U;
};

class MeshOfPieces : public MeshSink {
 public:
  void add_vertices(std::vector<Vector3> positions, std::vector<float> attributes) override {
    hash_.add(positions).add(attributes);
  }
  void add_triangles(std::vector<std::array<std::int64_t, 3>> triangles) override {
    hash_.add(triangles);
  }
  const Hash& hash() const { return hash_; }

 private:
  Hash hash_;
};

struct Setting {
  int threads;
  std::string part;

  bool wants(const std::string& name) const { return name.starts_with(part); }
  void print(const std::string& name, const Hash& hash) const {
    std::printf("%-32s %016llx\n", name.c_str(), static_cast<unsigned long long>(hash.value()));
    std::fflush(stdout);
  }
};

void bakes(const Setting& setting) {
  if (!setting.wants("bake")) return;
  const Surface surface = surface_of(torus(24, 12, 0.1));
  const Image image = picture(63, 48, 4);
  for (const MipmapFilter& filter : mipmap_filters()) {
    MipmapOptions options;
    options.filter = filter;
    options.wrap = {Wrap::kRepeat, Wrap::kClamp};
    options.run = prefilter::Run(setting.threads);
    setting.print("bake " + name_of(filter),
                  Hash().add(mipmaps(image.view(), {&surface}, options)));
  }
  MipmapOptions options;
  options.run = prefilter::Run(setting.threads);
  options.seam_budget = 0.1;
  setting.print("bake seams", Hash().add(mipmaps(image.view(), {&surface}, options)));
  options.seam_budget = 0.0;
  options.footprint = 1.0;
  setting.print("bake footprint", Hash().add(mipmaps(image.view(), {&surface}, options)));
  const std::vector<Image> levels = mipmaps(image.view(), {&surface}, options);
  std::vector<ImageView> views;
  for (const Image& level : levels) views.push_back(level.view());
  ViewFitOptions of_views;
  of_views.run = prefilter::Run(setting.threads);
  of_views.effort = 0.1;
  setting.print("bake views", Hash().add(fit_to_views(views, {&surface}, of_views)));
  const Image roughness = picture(48, 32, 1);
  NormalMipmapOptions of_normals;
  of_normals.run = prefilter::Run(setting.threads);
  const NormalMipmaps normals =
      normal_mipmaps(normal_map(48, 32).view(), nullptr, {&surface}, of_normals);
  setting.print("bake normals", Hash().add(normals.normals));
  const Image map = normal_map(48, 32);
  const ImageView rough = roughness.view();
  setting.print("bake roughness",
                Hash().add(normal_mipmaps(map.view(), &rough, {&surface}, of_normals).roughness));
}

void subdivisions(const Setting& setting) {
  if (!setting.wants("subdivide")) return;
  const Torus mesh = torus(8, 6, 0.3);
  std::vector<double> positions;
  for (const Vector3& p : mesh.positions) positions.insert(positions.end(), p.begin(), p.end());
  std::vector<std::int64_t> corners;
  for (const auto& t : mesh.triangles) corners.insert(corners.end(), t.begin(), t.end());
  const std::vector<std::int64_t> sizes(mesh.triangles.size(), 3);
  PolygonArrays arrays;
  arrays.positions = positions.data();
  arrays.vertex_count = mesh.positions.size();
  arrays.face_sizes = sizes.data();
  arrays.face_count = sizes.size();
  arrays.face_vertices = corners.data();
  arrays.face_uvs = mesh.uvs.data();
  arrays.corner_count = corners.size();
  for (const char* scheme : {"catmull-clark", "loop"}) {
    SubdivisionOptions options;
    options.scheme = value_named("scheme", scheme, kSubdivisionSchemes);
    options.level = 2;
    const Surface surface = subdivide(arrays, options);
    setting.print(std::string("subdivide ") + scheme,
                  Hash().add(surface.positions).add(surface.uvs).add(surface.areas));
  }
}

void print_quads(const Setting& setting, const Octree& octree, const SourceMesh& source) {
  ContourOptions options;
  options.sources = std::span(&source, 1);
  options.run = prefilter::Run(setting.threads);
  const QuadMesh mesh = contour_quads(octree.cells, octree.bounds, options);
  setting.print("solid quads", Hash().add(mesh.positions).add(mesh.quads).add(mesh.origins));
}

void solids(const Setting& setting) {
  if (!setting.wants("solid")) return;
  const Torus source = torus(60, 32, 0.2);
  const Torus other = torus(40, 20, -0.9);
  VoxelizeOptions options;
  options.depth = 6;
  options.run = prefilter::Run(setting.threads);
  const Octree octree = voxelize(source.mesh(), options);
  setting.print("solid octree", Hash().add(octree));
  options.depth = 5;
  const Octree second = voxelize(other.mesh(), options);
  constexpr std::array<std::pair<const char*, SetOperation>, 3> kOperations = {
      {{"union", SetOperation::kUnion},
       {"intersection", SetOperation::kIntersection},
       {"difference", SetOperation::kDifference}}};
  for (const auto& [name, operation] : kOperations) {
    setting.print(std::string("solid ") + name,
                  Hash().add(combine(octree, second, operation, prefilter::Run(setting.threads))));
  }
  const SourceMesh of_source{source.mesh(), {}};
  constexpr std::array<std::pair<const char*, Interpolant>, 4> kInterpolants = {
      {{"occupancy", Interpolant::kOccupancy},
       {"plane", Interpolant::kPlane},
       {"linear", Interpolant::kLinear},
       {"sharp", Interpolant::kSharp}}};
  for (const auto& [name, interpolant] : kInterpolants) {
    ContourOptions contour;
    contour.interpolant = interpolant;
    contour.clean_up = false;
    contour.run = prefilter::Run(setting.threads);
    setting.print(std::string("solid contour ") + name,
                  Hash().add(contour_tree(octree.cells, octree.bounds, contour)));
    contour.clean_up = true;
    contour.adaptivity = 0.3;
    if (interpolant == Interpolant::kSharp) contour.sources = std::span(&of_source, 1);
    setting.print(std::string("solid simplified ") + name,
                  Hash().add(contour_tree(octree.cells, octree.bounds, contour)));
  }
  print_quads(setting, octree, of_source);
  Torus open = source;
  open.triangles.erase(open.triangles.begin() + 200, open.triangles.begin() + 216);
  CloseHolesOptions holes;
  holes.run = prefilter::Run(setting.threads);
  const Caps caps = close_holes(open.mesh(), holes);
  setting.print("solid holes", Hash().add(caps.positions).add(caps.triangles));
  SolidOptions sheets;
  sheets.cell = 0.1;
  sheets.run = prefilter::Run(setting.threads);
  const Solid solid = as_solid(open.mesh(), sheets);
  setting.print("solid sheets", Hash().add(solid.positions).add(solid.triangles));
}

void reconstructions(const Setting& setting) {
  if (!setting.wants("points")) return;
  TorusPoints points(20000);
  for (const WaveletBasis basis : {WaveletBasis::kHaar, WaveletBasis::kD4}) {
    ReconstructOptions options;
    options.depth = 6;
    options.basis = basis;
    options.run = prefilter::Run(setting.threads);
    MeshOfPieces mesh;
    reconstruct(&points, options, &mesh);
    setting.print(basis == WaveletBasis::kHaar ? "points haar" : "points d4", mesh.hash());
  }
  setting.print("points normals",
                Hash().add(estimate_normals(points.positions(), 12, {}, NormalSide::kOutward,
                                            prefilter::Run(setting.threads))));
}

std::vector<Shape> shapes(double size) {
  std::vector<Shape> result(3);
  result[0].outline = drawing(size);
  result[0].fill_rule = FillRule::kEvenOdd;
  StrokeOptions round;
  round.width = 0.04 * size;
  round.join = StrokeJoin::kRound;
  round.cap = StrokeCap::kRound;
  round.dashes = {0.3 * size, 0.1 * size};
  result[1].outline = stroke(drawing(size), round);
  result[2].outline = drawing(0.7 * size);
  Paint& paint = result[2].paint;
  paint.kind = Paint::Kind::kRadialStops;
  paint.stops = {{0.0, {0.2}}, {0.6, {0.9}}, {1.0, {0.4}}};
  paint.start = paint.end = {0.4 * size, 0.3 * size};
  paint.end_radius = 0.5 * size;
  paint.spread = Spread::kReflect;
  return result;
}

void pictures(const Setting& setting) {
  if (!setting.wants("raster")) return;
  RasterOptions options;
  options.width = options.height = 96;
  options.overlap = Overlap::kAdd;
  options.run = prefilter::Run(setting.threads);
  const std::vector<Shape> all = shapes(96.0);
  for (const char* filter : {"box", "tent", "gaussian", "lanczos3", "radial2"}) {
    options.filter = filter;
    setting.print(std::string("raster ") + filter, Hash().add(rasterize(all, options)));
  }
  options.filter = "box";
  options.overlap = Overlap::kCover;
  setting.print("raster covered", Hash().add(rasterize(all, options)));
  options.overlap = Overlap::kAdd;
  options.method = RasterMethod::kWavelet;
  setting.print("raster wavelet", Hash().add(rasterize(std::span(all).first(2), options)));
}

void resampled(const Setting& setting) {
  if (!setting.wants("resample")) return;
  const Image image = picture(61, 40, 4);
  for (const ResizeFilter& filter : resize_filters()) {
    ResizeOptions options;
    options.filter = filter;
    options.run = prefilter::Run(setting.threads);
    setting.print("resample to 37 x 50 " + name_of(filter),
                  Hash().add(resize(image.view(), 37, 50, options)));
  }
  BuildTableOptions build;
  build.shape = {"lanczos2", 4, 2, 1, 1};
  build.run = prefilter::Run(setting.threads);
  const SamplingTable table = build_sampling_table(build);
  Hash of_table;
  for (const TableSection& section : table.sections) {
    of_table.add(section.texels).add(section.coefficients).add(section.errors);
  }
  setting.print("resample table", of_table);
  ResampleOptions options;
  options.run = prefilter::Run(setting.threads);
  const Homography transform = {0.9, 0.3, -4.0, -0.2, 1.7, 3.0, 0.004, 0.009, 1.0};
  for (const auto method : {ResampleOptions::Method::kTrilinear, ResampleOptions::Method::kTable,
                            ResampleOptions::Method::kExact}) {
    options.method = method;
    options.table = &table;
    setting.print("resample by method " + std::to_string(static_cast<int>(method)),
                  Hash().add(resample(image.view(), transform, 64, 64, options)));
  }
  options.method = ResampleOptions::Method::kTable;
  options.max_probes = 8;
  setting.print("resample by probes",
                Hash().add(resample(image.view(), transform, 64, 64, options)));
  options.method = ResampleOptions::Method::kExact;
  options.kernel = find_kernel("gaussian");
  setting.print("resample by ellipses",
                Hash().add(resample(image.view(), transform, 64, 64, options)));
}

/// Many of them, and not all whole: where encoders differ between processors, they do in few.
void blocks(const Setting& setting) {
  constexpr int kWidth = 256;
  constexpr int kHeight = kWidth - 3;
  const std::vector<std::uint8_t> bytes = to_bytes(tiles(kWidth).view(), false, setting.threads);
  const std::vector<HalfBits> halves = half_tiles(kWidth);
  const prefilter::Run run(setting.threads);
  const auto print = [&](const BlockOptions& options, const char* how) {
    const BlockLayout& layout = layout_of(options.format);
    const std::vector<std::uint8_t> result =
        layout.is_float ? compress_blocks(halves.data(), kWidth, kHeight, options, run)
                        : compress_blocks(bytes.data(), kWidth, kHeight, options, run);
    setting.print(std::string("file ") + layout.name + how, Hash().add(result));
  };
  for (int format = 0; format <= static_cast<int>(BlockFormat::kUastc); ++format) {
    print({static_cast<BlockFormat>(format)}, "");
  }
  for (const BlockFormat format :
       {BlockFormat::kBc5, BlockFormat::kBc7, BlockFormat::kEtc2Rgb, BlockFormat::kUastc}) {
    print({format, false, false, BlockEffort::kFast}, " fast");
  }
  for (const BlockFormat format : {BlockFormat::kBc5, BlockFormat::kBc7, BlockFormat::kEtc2Rgb}) {
    print({format, false, false, BlockEffort::kBest}, " best");
  }
  print({BlockFormat::kBc3, true}, " weighed");
  print({BlockFormat::kAstc4x4, true, true}, " weighed srgb");
}

void files(const Setting& setting) {
  if (!setting.wants("file")) return;
  const Image image = picture(96, 64, 4);
  setting.print("file decoded", Hash().add(decode_srgb(image.view(), setting.threads)));
  setting.print("file encoded", Hash().add(encode_srgb(image.view(), setting.threads)));
  const std::vector<std::uint8_t> bytes = to_bytes(image.view(), true, setting.threads);
  setting.print("file bytes", Hash().add(bytes));
  blocks(setting);
  setting.print("file zstd", Hash().add(supercompress(bytes.data(), bytes.size(), {})));
  for (const bool half : {false, true}) {
    ExrTileOptions options;
    options.half = half;
    options.threads = setting.threads;
    setting.print(half ? "file exr half" : "file exr float",
                  Hash().add(exr_tiles(image.view(), 0, 0, 1, options).bytes));
  }
}

}  // namespace

void print_all(int threads, const std::string& part) {
  const Setting setting{threads, part};
  files(setting);
  bakes(setting);
  subdivisions(setting);
  solids(setting);
  pictures(setting);
  resampled(setting);
  reconstructions(setting);
}

}  // namespace prefilter::hashes

int main(int argc, char** argv) {
  try {
    prefilter::hashes::print_all(argc > 1 ? std::atoi(argv[1]) : 0, argc > 2 ? argv[2] : "");
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
