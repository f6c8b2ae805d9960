// SPDX-License-Identifier: GPL-3.0-or-later

// The PCD format of PCL, up to version 0.7.
#include "prefilter/points/scan/pcd_points.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <map>
#include <utility>

#include "prefilter/base/error.h"
#include "prefilter/base/io/text_reader.h"
#include "prefilter/points/scan/lzf.h"
#include "prefilter/points/scan/point_fields.h"

namespace prefilter {
namespace {

constexpr std::size_t kMaxPcdFields = 4096;
constexpr std::uint64_t kMaxPcdHeaderSize = std::uint64_t{1} << 20;
constexpr std::size_t kMaxRecordSize = std::size_t{1} << 20;

struct PcdField {
  std::string name;
  std::uint64_t size = 4;
  char type = 'F';
  std::uint64_t count = 1;
};

struct PcdHeader {
  std::vector<PcdField> fields;
  std::uint64_t points = 0;
  bool is_image = false;
  std::optional<Vector3> viewpoint;
  std::string data;  // ascii, binary or binary_compressed
};

ScalarType type_of(const PcdField& field, const std::string& name) {
  using enum ScalarType;
  static const std::map<std::pair<char, std::uint64_t>, ScalarType> kTypes = {
      {{'I', 1}, kInt8},  {{'I', 2}, kInt16},  {{'I', 4}, kInt32},  {{'I', 8}, kInt64},
      {{'U', 1}, kUint8}, {{'U', 2}, kUint16}, {{'U', 4}, kUint32}, {{'U', 8}, kUint64},
      {{'F', 4}, kFloat}, {{'F', 8}, kDouble}};
  const auto entry = kTypes.find({field.type, field.size});
  if (entry == kTypes.end()) {
    throw_invalid(name + ": field " + in_quotes(field.name) + " of TYPE " +
                  in_quotes(std::string(1, field.type)) + " and SIZE " +
                  std::to_string(field.size) +
                  "; I or U of 1, 2, 4 or 8 bytes, or F of 4 or 8, are needed");
  }
  return entry->second;
}

bool is_color(const PcdField& field) {
  return (field.name == "rgb" || field.name == "rgba") && field.size == 4 && field.count == 1;
}

// Reads a header, and leaves the text at the first point.
class PcdHeaderReader {
 public:
  explicit PcdHeaderReader(TextReader* text) : text_(text) {}

  PcdHeader read() {
    std::string_view line;
    while (next_line(&line)) {
      const std::string_view keyword = take_word(&line);
      if (keyword.empty() || keyword.front() == '#') continue;
      words_.clear();
      for (std::string_view word; !(word = take_word(&line)).empty();) words_.push_back(word);
      if (words_.empty())
        throw_invalid(text_->where() + ": " + in_quotes(keyword) + " without a value");
      take(keyword);
      if (keyword == "DATA") {
        check();
        return std::move(header_);
      }
    }
    throw_invalid(text_->name() + (header_.fields.empty() ? " is not a PCD file" : "") +
                  ": there is no line DATA");
  }

 private:
  bool next_line(std::string_view* line) {
    if (text_->bytes().offset() > kMaxPcdHeaderSize) return false;
    return text_->next_line(line);
  }

  void take(std::string_view keyword) {
    if (keyword == "FIELDS" || keyword == "COLUMNS") {
      if (words_.size() > kMaxPcdFields) throw_invalid(text_->where() + ": too many fields");
      for (const std::string_view word : words_) header_.fields.push_back({std::string(word)});
    } else if (keyword == "SIZE") {
      for_fields([&](PcdField* field, std::size_t k) { field->size = count(k); });
    } else if (keyword == "TYPE") {
      for_fields([&](PcdField* field, std::size_t k) { field->type = words_[k].front(); });
    } else if (keyword == "COUNT") {
      for_fields([&](PcdField* field, std::size_t k) { field->count = count(k); });
    } else if (keyword == "WIDTH") {
      width_ = count(0);
    } else if (keyword == "HEIGHT") {
      height_ = count(0);
    } else if (keyword == "POINTS") {
      points_ = count(0);
    } else if (keyword == "VIEWPOINT") {
      take_viewpoint();
    } else if (keyword == "DATA") {
      header_.data = words_[0];
      if (header_.data != "ascii" && header_.data != "binary" &&
          header_.data != "binary_compressed") {
        throw_invalid(text_->where() + ": DATA " + in_quotes(header_.data) +
                      "; ascii, binary or binary_compressed is needed");
      }
    } else if (keyword != "VERSION") {
      throw_invalid(text_->where() + ": " + in_quotes(keyword) + " is not part of a PCD header");
    }
  }

  template <typename Take>
  void for_fields(const Take& take) {
    if (words_.size() != header_.fields.size()) {
      throw_invalid(text_->where() + ": found " + std::to_string(words_.size()) + " words for " +
                    std::to_string(header_.fields.size()) + " fields");
    }
    for (std::size_t k = 0; k < words_.size(); ++k) take(&header_.fields[k], k);
  }

  std::uint64_t count(std::size_t word) const {
    std::uint64_t result = 0;
    if (!to_count(words_[word], &result)) {
      throw_invalid(text_->where() + ": found " + in_quotes(words_[word]) +
                    "; a whole number from 0 to 2^63 - 1 is needed");
    }
    return result;
  }

  void take_viewpoint() {
    Vector3 place{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (words_.size() != 7 || !to_number(words_[axis], &place[axis])) {
        throw_invalid(text_->where() + ": VIEWPOINT needs seven numbers");
      }
    }
    if (std::isfinite(length(place))) header_.viewpoint = place;
  }

  void check() {
    if (header_.fields.empty()) throw_invalid(text_->name() + ": there is no line FIELDS");
    if (!width_ && !points_) throw_invalid(text_->name() + ": there is no line WIDTH or POINTS");
    const std::uint64_t width = width_ ? *width_ : *points_;
    const std::uint64_t height = width_ ? height_.value_or(1) : 1;
    if (width > 0 && height > (std::uint64_t{1} << 62) / width) {
      throw_invalid(text_->name() + ": WIDTH times HEIGHT is above 2^62");
    }
    header_.points = width * height;
    if (points_ && *points_ != header_.points) {
      throw_invalid(text_->name() + ": POINTS is " + std::to_string(*points_) + ", but WIDTH is " +
                    std::to_string(width) + " and HEIGHT " + std::to_string(height));
    }
    header_.is_image = height > 1;
  }

  TextReader* text_;
  PcdHeader header_;
  std::vector<std::string_view> words_;
  std::optional<std::uint64_t> width_;
  std::optional<std::uint64_t> height_;
  std::optional<std::uint64_t> points_;
};

// Positions of the fields in a record and among the numbers of a line.
struct PcdLayout {
  PointFields fields;
  std::size_t stride = 0;  // bytes per record
  std::size_t width = 0;   // numbers per line
  // For each color: the index of its packed number in a line, and of the first of its four
  // channels.
  std::vector<std::pair<std::size_t, std::size_t>> colors;
  std::vector<bool> is_float_color;
  std::size_t values = 0;  // numbers per line, with the channels of colors
  // bytes of each field in a record
  std::vector<std::size_t> sizes;
};

PcdLayout layout_of(const PcdHeader& header, const std::string& name) {
  PcdLayout layout;
  std::vector<ScanField> fields;
  for (const PcdField& field : header.fields) {
    const ScalarType type = type_of(field, name);
    if (field.count > (kMaxRecordSize - layout.stride) / field.size) {
      throw_invalid(name + ": points are larger than 1 MiB");
    }
    if (field.count == 1 && field.name != "_" && !is_color(field)) {
      fields.push_back({field.name, type, layout.width, layout.stride});
    }
    layout.sizes.push_back(static_cast<std::size_t>(field.size * field.count));
    layout.stride += layout.sizes.back();
    layout.width += static_cast<std::size_t>(field.count);
  }
  layout.values = layout.width;
  std::size_t offset = 0;
  std::size_t index = 0;
  for (const PcdField& field : header.fields) {
    if (is_color(field)) {
      layout.colors.emplace_back(index, layout.values);
      layout.is_float_color.push_back(field.type == 'F');
      const std::size_t channels = field.name.size();
      for (std::size_t k = 0; k < channels; ++k) {
        // From the lowest byte: blue, green, red, alpha.
        static constexpr const char* kColors[] = {"red", "green", "blue", "alpha"};
        const std::size_t byte = k < 3 ? 2 - k : 3;
        fields.push_back({kColors[k], ScalarType::kUint8, layout.values + byte, offset + byte});
      }
      layout.values += 4;
    }
    offset += static_cast<std::size_t>(field.size * field.count);
    index += static_cast<std::size_t>(field.count);
  }
  layout.fields = PointFields(fields, name);
  return layout;
}

class PcdPoints final : public PointSource {
 public:
  explicit PcdPoints(const std::string& path)
      : text_(path),
        header_(PcdHeaderReader(&text_).read()),
        layout_(layout_of(header_, text_.name())) {
    first_ = text_.place();
    if (header_.data == "ascii") {
      check_size(header_.points, 2 * layout_.width, 1);
    } else if (header_.data == "binary") {
      check_size(header_.points, layout_.stride, 0);
    } else {
      unpack();
    }
    end_ = header_.points;
    find_color_scale(this, &layout_.fields);
  }

  std::optional<std::size_t> count() const override {
    return static_cast<std::size_t>(end_ - begin_);
  }
  bool has_normals() const override { return layout_.fields.has_normals(); }
  const std::vector<PointAttribute>& attributes() const override {
    return layout_.fields.attributes();
  }
  bool is_double() const override { return layout_.fields.is_double(); }
  std::vector<std::string> warnings() const override {
    if (!has_more_) return {};
    return {text_.name() + ": holds more than the " + std::to_string(header_.points) +
            " points in its header; the rest was not read"};
  }
  std::optional<Vector3> viewpoint() const override {
    if (header_.viewpoint == Vector3{} && !header_.is_image) return std::nullopt;
    return header_.viewpoint;
  }

  std::optional<std::size_t> rows() const override {
    if (header_.data == "ascii") return std::nullopt;
    return static_cast<std::size_t>(header_.points);
  }
  void choose_rows(std::size_t begin, std::size_t end) override {
    begin_ = begin;
    end_ = end;
    rewind();
  }

  void rewind() override {
    text_.go_to(first_);
    if (header_.data == "binary" && begin_ > 0) {
      text_.bytes().seek(text_.bytes().offset() + begin_ * layout_.stride);
    }
    done_ = begin_;
  }

  bool read(std::size_t most, PointBatch* batch) override {
    const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(most, end_ - done_));
    layout_.fields.resize(count, batch);
    if (header_.data == "ascii") {
      for (std::size_t point = 0; point < count; ++point) read_line(point, batch);
    } else if (header_.data == "binary") {
      read_records(count, batch);
    } else {
      read_columns(count, batch);
    }
    if (done_ == header_.points) find_surplus();
    return count > 0;
  }

 private:
  static constexpr bool kIsSwapped = std::endian::native == std::endian::big;

  void check_size(std::uint64_t count, std::uint64_t size, std::uint64_t spare) {
    const std::uint64_t there = text_.bytes().remaining();
    if (count <= (there + spare) / std::max<std::uint64_t>(size, 1)) return;
    throw_invalid(text_.name() + ": too short for the " + std::to_string(count) +
                  " points in its header: " + std::to_string(there) + " bytes follow the header");
  }

  void read_line(std::size_t point, PointBatch* batch) {
    ++done_;
    std::string_view line;
    do {
      if (!text_.next_line(&line)) {
        throw_invalid(text_.where() + ": ends after " + std::to_string(done_ - 1) + " of " +
                      std::to_string(header_.points) + " points");
      }
    } while (line.find_first_not_of(kBlanks) == std::string_view::npos);
    text_.parse(line, kBlanks, &values_);
    if (values_.size() != layout_.width) {
      throw_invalid(text_.where() + ": found " + std::to_string(values_.size()) + " numbers; " +
                    std::to_string(layout_.width) + " are needed");
    }
    values_.resize(layout_.values);
    for (std::size_t k = 0; k < layout_.colors.size(); ++k) {
      const auto [from, to] = layout_.colors[k];
      const double value = values_[from];
      std::uint32_t bits = 0;
      if (layout_.is_float_color[k]) {
        bits = std::bit_cast<std::uint32_t>(static_cast<float>(value));
      } else if (value >= -2147483648.0 && value <= 4294967295.0) {
        bits = static_cast<std::uint32_t>(static_cast<std::int64_t>(value));
      }
      for (std::size_t byte = 0; byte < 4; ++byte) values_[to + byte] = (bits >> (8 * byte)) & 255;
    }
    layout_.fields.put_values(values_.data(), point, batch);
  }

  void read_records(std::size_t count, PointBatch* batch) {
    for (std::size_t point = 0; point < count;) {
      const auto bytes = text_.bytes().peek(layout_.stride);
      const std::size_t some = std::min(count - point, bytes.size() / layout_.stride);
      if (some == 0) {
        throw_invalid(text_.name() + ": ends within point " + std::to_string(done_ + 1) + " of " +
                      std::to_string(header_.points));
      }
      layout_.fields.put_records(bytes.data(), layout_.stride, kIsSwapped, point, some, batch);
      text_.bytes().skip(some * layout_.stride);
      point += some;
      done_ += some;
    }
  }

  // Decompresses the data, which is stored field by field.
  void unpack() {
    std::uint32_t sizes[2] = {0, 0};
    const auto bytes = text_.bytes().peek(sizeof sizes);
    if (bytes.size() >= sizeof sizes) std::memcpy(sizes, bytes.data(), sizeof sizes);
    text_.bytes().skip(std::min(bytes.size(), sizeof sizes));
    if (kIsSwapped) {
      for (std::uint32_t& size : sizes) size = __builtin_bswap32(size);
    }
    if (sizes[0] > text_.bytes().remaining()) {
      throw_invalid(text_.name() + ": " + std::to_string(sizes[0]) +
                    " bytes of compressed points are announced; " +
                    std::to_string(text_.bytes().remaining()) + " follow");
    }
    if (header_.points > sizes[1] / layout_.stride || sizes[1] != header_.points * layout_.stride) {
      throw_invalid(text_.name() + ": " + std::to_string(header_.points) + " points of " +
                    std::to_string(layout_.stride) + " bytes in its header, but " +
                    std::to_string(sizes[1]) + " bytes are compressed");
    }
    columns_.emplace();
    decode_lzf(&text_.bytes(), sizes[0], sizes[1], &*columns_);
  }

  void read_columns(std::size_t count, PointBatch* batch) {
    std::vector<std::byte> column;
    const std::size_t at_once = kMaxRecordSize / layout_.stride;
    std::vector<std::byte> records(at_once * layout_.stride);
    for (std::size_t point = 0; point < count;) {
      const std::size_t some = std::min(at_once, count - point);
      std::uint64_t column_begin = 0;
      std::size_t offset = 0;
      for (const std::size_t size : layout_.sizes) {
        column.resize(some * size);
        columns_->read_at(column_begin + done_ * size, column);
        for (std::size_t i = 0; i < some; ++i) {
          std::memcpy(records.data() + i * layout_.stride + offset, column.data() + i * size, size);
        }
        column_begin += header_.points * size;
        offset += size;
      }
      layout_.fields.put_records(records.data(), layout_.stride, kIsSwapped, point, some, batch);
      point += some;
      done_ += some;
    }
  }

  void find_surplus() {
    if (columns_) return;
    while (true) {
      const auto trailing = text_.bytes().peek(1);
      if (trailing.empty()) return;
      // Some binary files pad their last page with zeros.
      constexpr std::string_view kPadding(" \t\r\n\v\f\0", 7);
      const std::string_view more(reinterpret_cast<const char*>(trailing.data()), trailing.size());
      if (more.find_first_not_of(kPadding) != std::string_view::npos) {
        has_more_ = true;
        return;
      }
      text_.bytes().skip(trailing.size());
    }
  }

  TextReader text_;
  PcdHeader header_;
  PcdLayout layout_;
  TextPlace first_;
  std::optional<TemporaryFile> columns_;  // decompressed data
  bool has_more_ = false;                 // surplus data after the points in the header
  std::uint64_t begin_ = 0;
  std::uint64_t end_ = 0;
  std::uint64_t done_ = 0;
  std::vector<double> values_;
};

}  // namespace

std::unique_ptr<PointSource> open_pcd_points(const std::string& path) {
  return std::make_unique<PcdPoints>(path);
}

}  // namespace prefilter
