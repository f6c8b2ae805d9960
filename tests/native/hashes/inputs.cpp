// SPDX-License-Identifier: GPL-3.0-or-later

#include "hashes/inputs.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "prefilter/base/elementary.h"

namespace prefilter::hashes {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

struct Place {
  Vector3 position;
  Vector3 normal;
};

Place torus_place(double u, double v, double lean) {
  const double bump = 0.7 + 0.05 * elementary::sin(5.0 * kTurn * u + 3.0 * kTurn * v);
  const Vector3 outward = {elementary::cos(kTurn * u), elementary::sin(kTurn * u), 0.0};
  const double out = elementary::cos(kTurn * v);
  const double up = elementary::sin(kTurn * v);
  const auto leaning = [&](const Vector3& p) {
    return Vector3{p[0], p[1] + lean * p[2], p[2] - lean * p[1]};
  };
  const Vector3 normal = {out * outward[0], out * outward[1], up};
  const double radius = 2.0 + bump * out;
  return {leaning({radius * outward[0], radius * outward[1], bump * up}), leaning(normal)};
}

/// A channel of a tile of `tiles`, between any two values.
class Pattern {
 public:
  static constexpr int kCount = 7;

  Pattern(int kind, Random* random) : kind_(kind), random_(random) {
    low_ = random_->between(0.0, 1.0);
    high_ = random_->between(0.0, 1.0);
    slope_ = random_->between(-1.0, 1.0);
    // Some are close to each other, some as far away as can be.
    const double range = random_->between(0.0, 3.0);
    if (range < 1.0) high_ = low_ + 0.1 * (high_ - low_);
    if (range > 2.0) {
      low_ = 0.0;
      high_ = 1.0;
    }
  }

  double at(double x, double y) {
    return std::clamp(low_ + (high_ - low_) * share(x, y), 0.0, 1.0);
  }

 private:
  double share(double x, double y) {
    const double along = 0.5 + (x - 0.5) + slope_ * (y - 0.5);
    switch (kind_) {
      case 0:
        return 0.0;
      case 1:
        return along;
      case 2:
        return along * along;
      case 3:
        return along < 0.5 ? 0.0 : 1.0;
      case 4:
        return static_cast<int>(8.0 * x) % 2 == static_cast<int>(8.0 * y) % 2 ? along : 1.0 - along;
      case 5:
        return random_->between(0.0, 1.0);
      default:
        return along + random_->between(-0.1, 0.1);
    }
  }

  int kind_;
  Random* random_;
  double low_;
  double high_;
  double slope_;
};

}  // namespace

double Random::between(double low, double high) {
  state_ = state_ * 6364136223846793005U + 1442695040888963407U;
  const std::uint64_t mixed = (state_ ^ (state_ >> 29U)) * 0xBF58476D1CE4E5B9U;
  return low + (high - low) * (static_cast<double>(mixed >> 11U) * 0x1p-53);
}

Image picture(int width, int height, int channels) {
  Image image(width, height, channels);
  Random random(11);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int c = 0; c < channels; ++c) {
        const double ramp = 0.8 * (x + 0.3 * y * (c + 1)) / (width + height);
        const double edge = (x / 7 + y / 5 + c) % 3 == 0 ? 0.2 : 0.0;
        const double noise = random.between(-0.1, 0.1);
        const double value = c == 3 ? 2.0 * ramp : ramp + edge + noise;
        image.texel(x, y)[c] = static_cast<float>(std::clamp(value, 0.0, 1.0));
      }
    }
  }
  return image;
}

Image tiles(int size) {
  constexpr int kSide = 16;
  Image image(size, size, 4);
  Random random(29);
  for (int tile = 0; tile < (size / kSide) * (size / kSide); ++tile) {
    const int kind = tile % Pattern::kCount;
    // Every fifth tile is gray.
    const bool is_gray = tile % 5 == 0;
    std::vector<Pattern> channels(3, Pattern(kind, &random));
    if (!is_gray) {
      for (Pattern& channel : channels) channel = Pattern(kind, &random);
    }
    const int alpha_kind = tile / Pattern::kCount % (Pattern::kCount + 2);
    Pattern alpha(alpha_kind, &random);
    for (int i = 0; i < kSide * kSide; ++i) {
      const int x = tile % (size / kSide) * kSide + i % kSide;
      const int y = tile / (size / kSide) * kSide + i / kSide;
      const double across = (i % kSide) / (kSide - 1.0);
      const double down = (i / kSide) / (kSide - 1.0);
      float* texel = image.texel(x, y);
      for (int c = 0; c < 3; ++c) {
        texel[c] = is_gray && c > 0
                       ? texel[0]
                       : static_cast<float>(channels[static_cast<std::size_t>(c)].at(across, down));
      }
      if (alpha_kind < Pattern::kCount) {
        texel[3] = static_cast<float>(alpha.at(across, down));
      } else {
        texel[3] = alpha_kind == Pattern::kCount ? 1.0F : 0.0F;
      }
    }
  }
  return image;
}

std::vector<std::uint16_t> half_tiles(int size) {
  constexpr int kGreatest = 0x7BFF;
  constexpr int kOne = 0x3C00;
  const Image image = tiles(size);
  std::vector<std::uint16_t> halves;
  for (std::size_t i = 0; i < image.data.size(); ++i) {
    const bool is_alpha = i % 4 == 3;
    const double bits = static_cast<double>(image.data[i]) * (is_alpha ? kOne : kGreatest);
    halves.push_back(static_cast<std::uint16_t>(bits));
    const bool is_negative = !is_alpha && i / 4 % 97 == 0;
    if (is_negative) halves.back() |= 0x8000U;
  }
  return halves;
}

Image normal_map(int width, int height) {
  Image image(width, height, 3);
  Random random(13);
  for (int i = 0; i < width * height; ++i) {
    const double x = random.between(-0.7, 0.7);
    const double y = random.between(-0.7, 0.7);
    const double z = std::sqrt(1.0 - 0.5 * (x * x + y * y));
    const double length = std::sqrt(x * x + y * y + z * z);
    int c = 0;
    for (const double value : {x, y, z}) {
      image.data[3 * i + c++] = static_cast<float>(0.5 + 0.5 * value / length);
    }
  }
  return image;
}

Torus torus(int around, int across, double lean) {
  Torus result;
  for (int i = 0; i < around; ++i) {
    for (int j = 0; j < across; ++j) {
      const double u = static_cast<double>(i) / around;
      const double v = static_cast<double>(j) / across;
      result.positions.push_back(torus_place(u, v, lean).position);
    }
  }
  const auto corner = [&](int i, int j) {
    result.uvs.push_back(0.03 + 0.9 * i / around);
    result.uvs.push_back(0.05 + 0.85 * j / across);
    return (i % around) * across + j % across;
  };
  for (int i = 0; i < around; ++i) {
    for (int j = 0; j < across; ++j) {
      const std::int32_t a = corner(i, j);
      const std::int32_t b = corner(i + 1, j);
      const std::int32_t c = corner(i + 1, j + 1);
      result.triangles.push_back({a, b, c});
      const std::int32_t d = corner(i, j);
      const std::int32_t e = corner(i + 1, j + 1);
      const std::int32_t f = corner(i, j + 1);
      result.triangles.push_back({d, e, f});
    }
  }
  return result;
}

Surface surface_of(const Torus& torus) {
  TexturedMesh textured;
  textured.mesh = torus.mesh();
  textured.uvs = torus.uvs.data();
  return make_surface(textured);
}

TorusPoints::TorusPoints(std::size_t count) {
  Random random(17);
  for (std::size_t i = 0; i < count; ++i) {
    // Arguments are evaluated in an order that compilers choose.
    const double u = random.between(0.0, 1.0);
    const double v = random.between(0.0, 1.0);
    Place place = torus_place(u, v, 0.2);
    std::array<float, 3> normal{};
    for (std::size_t a = 0; a < 3; ++a) {
      place.position[a] += random.between(-0.01, 0.01);
      normal[a] = static_cast<float>(place.normal[a] + random.between(-0.1, 0.1));
    }
    batch_.positions.push_back(place.position);
    batch_.normals.push_back(normal);
  }
}

bool TorusPoints::read(std::size_t most, PointBatch* batch) {
  batch->clear();
  const std::size_t end = std::min(next_ + most, batch_.positions.size());
  for (; next_ < end; ++next_) {
    batch->positions.push_back(batch_.positions[next_]);
    batch->normals.push_back(batch_.normals[next_]);
  }
  return !batch->positions.empty();
}

Outline drawing(double size) {
  Random random(19);
  Outline outline;
  const auto point = [&] {
    const double x = random.between(-0.1 * size, 1.1 * size);
    return Point2{x, random.between(-0.1 * size, 1.1 * size)};
  };
  for (int contour = 0; contour < 6; ++contour) {
    outline.move_to(point());
    for (int i = 0; i < 4; ++i) {
      outline.line_to(point());
      const std::array<Point2, 3> cubic = {point(), point(), point()};
      outline.curve_to(cubic);
      const std::array<Point2, 2> quadratic = {point(), point()};
      outline.curve_to(quadratic);
      const Point2 control = point();
      outline.conic_to(control, 0.6, point());
    }
    outline.close();
  }
  return outline;
}

}  // namespace prefilter::hashes
