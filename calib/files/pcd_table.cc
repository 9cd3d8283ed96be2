#include "calib/files/pcd_table.h"

#include <liblzf/lzf.h>

#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>

#include "calib/model/errors.h"

namespace rgbdt::pcd {
namespace {

constexpr std::size_t kMaxPoints = 200'000'000;

bool IsSpace(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

// Takes the next word off the front of `text`; empty at its end.
std::string_view NextWord(std::string_view* text) {
  std::size_t begin = 0;
  while (begin < text->size() && IsSpace((*text)[begin])) ++begin;
  std::size_t end = begin;
  while (end < text->size() && !IsSpace((*text)[end])) ++end;
  const std::string_view word = text->substr(begin, end - begin);
  text->remove_prefix(end);
  return word;
}

bool IsKey(std::string_view word) {
  for (const char* key : {"VERSION", "FIELDS", "SIZE", "TYPE", "COUNT", "WIDTH", "HEIGHT",
                          "VIEWPOINT", "POINTS", "DATA"}) {
    if (word == key) return true;
  }
  return false;
}

std::vector<std::string_view> Words(std::string_view line) {
  std::vector<std::string_view> words;
  for (std::string_view w = NextWord(&line); !w.empty(); w = NextWord(&line)) words.push_back(w);
  return words;
}

// Not strtod: that one reads "0,5" in some locales.
template <typename T>
bool ParseNumber(std::string_view word, T* value) {
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), *value);
  return error == std::errc() && end == word.data() + word.size();
}

template <typename T>
double Load(const char* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return static_cast<double>(value);
}

using Loader = double (*)(const char*);

Loader LoaderOf(const Field& field) {
  switch (field.type) {
    case 'F':
      return field.size == 4 ? Load<float> : field.size == 8 ? Load<double> : nullptr;
    case 'I':
      return field.size == 1   ? Load<std::int8_t>
             : field.size == 2 ? Load<std::int16_t>
             : field.size == 4 ? Load<std::int32_t>
             : field.size == 8 ? Load<std::int64_t>
                               : nullptr;
    case 'U':
      return field.size == 1   ? Load<std::uint8_t>
             : field.size == 2 ? Load<std::uint16_t>
             : field.size == 4 ? Load<std::uint32_t>
             : field.size == 8 ? Load<std::uint64_t>
                               : nullptr;
    default:
      return nullptr;
  }
}

std::uint32_t LoadU32(std::string_view bytes) {
  std::uint32_t value;
  std::memcpy(&value, bytes.data(), sizeof value);
  return value;
}

}  // namespace

std::size_t Header::PointBytes() const {
  std::size_t bytes = 0;
  for (const Field& field : fields) bytes += field.size * field.count;
  return bytes;
}

void Table::Fail(const std::string& what) const { throw InputError(where_ + ": " + what); }

Table::Table(std::string_view bytes, std::string where) : where_(std::move(where)) {
  ReadHeader(bytes);
  const std::string_view data = bytes.substr(header_.data_begin);
  if (header_.data == "ascii") {
    ReadAscii(data);
  } else if (header_.data == "binary") {
    RequireBytes(data.size());
    binary_ = data;
  } else {
    Unpack(data);
  }
}

void Table::ReadHeader(std::string_view bytes) {
  std::size_t points = 0;
  bool has_points = false;
  const auto size = [&](std::string_view word, const char* key, std::size_t most) {
    std::size_t value = 0;
    if (!ParseNumber(word, &value) || value > most) {
      Fail(std::string("PCD header: ") + key + " is \"" + std::string(word) +
           "\"; expected a whole number up to " + std::to_string(most));
    }
    return value;
  };
  const auto per_field = [&](const std::vector<std::string_view>& words) {
    if (words.size() != header_.fields.size() + 1) {
      Fail("PCD header: " + std::string(words[0]) + " has " + std::to_string(words.size() - 1) +
           " entries for " + std::to_string(header_.fields.size()) + " FIELDS");
    }
  };
  std::size_t at = 0;
  while (at < bytes.size() && header_.data.empty()) {
    const std::size_t end = std::min(bytes.find('\n', at), bytes.size());
    const std::vector<std::string_view> words = Words(bytes.substr(at, end - at));
    at = std::min(end + 1, bytes.size());
    if (words.empty() || words[0].front() == '#') continue;
    const std::string_view key = words[0];
    if (!IsKey(key)) {
      Fail("is not a PCD file, or its header is damaged at \"" + std::string(key.substr(0, 40)) +
           "\"");
    }
    if (words.size() < 2) Fail("PCD header: " + std::string(key) + " is empty");
    if (key == "FIELDS") {
      header_.fields.clear();
      for (std::size_t i = 1; i < words.size(); ++i) {
        header_.fields.push_back({std::string(words[i])});
      }
    } else if (key == "SIZE") {
      per_field(words);
      for (std::size_t i = 1; i < words.size(); ++i) {
        header_.fields[i - 1].size = size(words[i], "SIZE", 8);
      }
    } else if (key == "TYPE") {
      per_field(words);
      for (std::size_t i = 1; i < words.size(); ++i) header_.fields[i - 1].type = words[i].front();
    } else if (key == "COUNT") {
      per_field(words);
      for (std::size_t i = 1; i < words.size(); ++i) {
        header_.fields[i - 1].count = size(words[i], "COUNT", 100'000);
      }
    } else if (key == "WIDTH") {
      header_.width = size(words[1], "WIDTH", kMaxPoints);
    } else if (key == "HEIGHT") {
      header_.height = size(words[1], "HEIGHT", kMaxPoints);
    } else if (key == "POINTS") {
      points = size(words[1], "POINTS", kMaxPoints);
      has_points = true;
    } else if (key == "DATA") {
      header_.data = std::string(words[1]);
      header_.data_begin = at;
    }
  }
  if (header_.data != "ascii" && header_.data != "binary" && header_.data != "binary_compressed") {
    Fail(header_.data.empty() ? "is not a PCD file: its header has no DATA line"
                              : "PCD header: DATA is \"" + header_.data.substr(0, 40) +
                                    "\"; expected ascii, binary or binary_compressed");
  }
  if (header_.fields.empty()) Fail("PCD header: no FIELDS");
  for (const Field& field : header_.fields) {
    if (LoaderOf(field) == nullptr || field.count == 0) {
      Fail("PCD header: field " + field.name + " has TYPE " + field.type + ", SIZE " +
           std::to_string(field.size) + " and COUNT " + std::to_string(field.count) +
           "; expected F with 4 or 8, I or U with 1, 2, 4 or 8");
    }
  }
  if (header_.height == 0 && header_.width > 0) header_.height = 1;
  if (header_.width == 0 && header_.height <= 1 && has_points) {
    header_.width = points;
    header_.height = 1;
  }
  if (has_points && header_.points() != points) {
    Fail("PCD header: WIDTH " + std::to_string(header_.width) + " times HEIGHT " +
         std::to_string(header_.height) + " is not POINTS " + std::to_string(points));
  }
  if (header_.points() == 0) Fail("holds no points");
  if (header_.points() > kMaxPoints) Fail("PCD header: too many points");
}

void Table::RequireBytes(std::size_t have) const {
  const std::size_t need = header_.points() * header_.PointBytes();
  if (have < need) {
    Fail("is cut short: " + std::to_string(header_.points()) + " points take " +
         std::to_string(need) + " bytes, " + std::to_string(have) + " are there");
  }
}

void Table::ReadAscii(std::string_view data) {
  // Every number takes two bytes at least.
  if (data.size() / 2 + 1 < header_.points()) RequireBytes(data.size());
  ascii_.resize(header_.fields.size());
  for (std::vector<double>& column : ascii_) column.reserve(header_.points());
  for (std::size_t point = 0; point < header_.points(); ++point) {
    for (std::size_t f = 0; f < header_.fields.size(); ++f) {
      for (std::size_t i = 0; i < header_.fields[f].count; ++i) {
        const std::string_view word = NextWord(&data);
        double value = std::numeric_limits<double>::quiet_NaN();
        if (word.empty()) {
          Fail("is cut short: the header promises " + std::to_string(header_.points()) +
               " points, " + std::to_string(point) + " are there");
        }
        if (!ParseNumber(word, &value)) {
          Fail("point " + std::to_string(point + 1) + ": " + header_.fields[f].name + " is \"" +
               std::string(word.substr(0, 40)) + "\"; expected a number");
        }
        if (i == 0) ascii_[f].push_back(value);
      }
    }
  }
}

void Table::Unpack(std::string_view data) {
  if (data.size() < 8) Fail("is cut short: the compressed points are missing");
  const std::uint32_t packed = LoadU32(data);
  const std::uint32_t unpacked = LoadU32(data.substr(4));
  data.remove_prefix(8);
  if (data.size() < packed) {
    Fail("is cut short: " + std::to_string(packed) + " compressed bytes are announced, " +
         std::to_string(data.size()) + " are there");
  }
  RequireBytes(unpacked);
  // LZF makes at most 264 bytes of 3: more is a forged length.
  if (unpacked > std::size_t{packed} * 100) Fail("is damaged: its unpacked length cannot be true");
  unpacked_.resize(unpacked);
  if (lzf_decompress(data.data(), packed, unpacked_.data(), unpacked) != unpacked) {
    Fail("is damaged: its points cannot be unpacked");
  }
  binary_ = unpacked_;
  by_field_ = true;
}

const Field* Table::Find(const std::string& name) const {
  for (const Field& field : header_.fields) {
    if (field.name == name) return &field;
  }
  return nullptr;
}

bool Table::Has(const std::string& field) const { return Find(field) != nullptr; }

char Table::TypeOf(const std::string& field) const { return Find(field)->type; }

std::vector<double> Table::Column(const std::string& name) const {
  const Field* field = Find(name);
  if (field == nullptr) {
    std::string names;
    for (const Field& f : header_.fields) names += " " + f.name;
    Fail("has no field " + name + "; its fields are:" + names);
  }
  const std::size_t index = static_cast<std::size_t>(field - header_.fields.data());
  if (!ascii_.empty()) return ascii_[index];
  std::size_t before = 0;  // bytes of one point that precede the field
  for (std::size_t i = 0; i < index; ++i) {
    before += header_.fields[i].size * header_.fields[i].count;
  }
  const std::size_t offset = by_field_ ? before * header_.points() : before;
  const std::size_t stride = by_field_ ? field->size * field->count : header_.PointBytes();
  const Loader load = LoaderOf(*field);
  std::vector<double> values(header_.points());
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = load(binary_.data() + offset + i * stride);
  }
  return values;
}

}  // namespace rgbdt::pcd
