#include "calib/files/ply_reader.h"

#include <charconv>
#include <cmath>
#include <cstring>
#include <map>

#include "calib/model/errors.h"

namespace rgbdt::ply {
namespace {

constexpr std::size_t kMaxRecords = 200'000'000;
constexpr std::size_t kMaxProperties = 1000;
constexpr std::size_t kMaxHeader = 1 << 20;

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

std::vector<std::string_view> Words(std::string_view line) {
  std::vector<std::string_view> words;
  for (std::string_view w = NextWord(&line); !w.empty(); w = NextWord(&line)) words.push_back(w);
  return words;
}

std::string Quoted(std::string_view word) { return "\"" + std::string(word.substr(0, 40)) + "\""; }

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

struct Type {
  std::size_t size;
  double (*load)(const char*);
};

const Type* FindType(const std::string& name) {
  static const std::map<std::string, Type> types = {
      {"char", {1, Load<std::int8_t>}},     {"int8", {1, Load<std::int8_t>}},
      {"uchar", {1, Load<std::uint8_t>}},   {"uint8", {1, Load<std::uint8_t>}},
      {"short", {2, Load<std::int16_t>}},   {"int16", {2, Load<std::int16_t>}},
      {"ushort", {2, Load<std::uint16_t>}}, {"uint16", {2, Load<std::uint16_t>}},
      {"int", {4, Load<std::int32_t>}},     {"int32", {4, Load<std::int32_t>}},
      {"uint", {4, Load<std::uint32_t>}},   {"uint32", {4, Load<std::uint32_t>}},
      {"float", {4, Load<float>}},          {"float32", {4, Load<float>}},
      {"double", {8, Load<double>}},        {"float64", {8, Load<double>}}};
  const auto found = types.find(name);
  return found == types.end() ? nullptr : &found->second;
}

// The rest of a line after its first word.
std::string AfterKey(std::string_view line) {
  NextWord(&line);
  while (!line.empty() && IsSpace(line.front())) line.remove_prefix(1);
  while (!line.empty() && IsSpace(line.back())) line.remove_suffix(1);
  return std::string(line);
}

}  // namespace

void Table::Fail(const std::string& what) const { throw InputError(where_ + ": " + what); }

Table::Table(std::string_view bytes, std::string where) : where_(std::move(where)) {
  ReadHeader(bytes);
  std::string_view data = bytes.substr(data_begin_);
  if (format_ == "ascii") {
    ReadAscii(data);
    return;
  }
  // Neither product can overflow: records and properties are bounded.
  const std::size_t need = before_bytes_ + count_ * stride_;
  if (data.size() < need) {
    Fail("is cut short: " + std::to_string(count_) + " points take " + std::to_string(need) +
         " bytes, " + std::to_string(data.size()) + " are there");
  }
  binary_ = data.substr(before_bytes_);
}

void Table::ReadHeader(std::string_view bytes) {
  if (bytes.substr(0, 3) != "ply" || bytes.size() < 4 || !IsSpace(bytes[3])) {
    Fail("is not a PLY file: it does not begin with \"ply\"");
  }
  std::size_t at = std::min(bytes.find('\n'), bytes.size());
  for (bool ended = false; !ended;) {
    at = std::min(at + 1, bytes.size());
    if (at == bytes.size() || at > kMaxHeader) Fail("PLY header: no end_header");
    const std::size_t end = std::min(bytes.find('\n', at), bytes.size());
    const std::string_view line = bytes.substr(at, end - at);
    const std::vector<std::string_view> words = Words(line);
    at = end;
    if (words.empty() || words[0] == "obj_info") continue;
    if (words[0] == "comment") {
      comments_.push_back(AfterKey(line));
    } else if (words[0] == "format") {
      format_ = words.size() > 1 ? std::string(words[1]) : "";
    } else if (words[0] == "element") {
      ReadElement(words);
    } else if (words[0] == "property") {
      ReadProperty(words);
    } else if (words[0] == "end_header") {
      ended = true;
    } else {
      Fail("PLY header is damaged at " + Quoted(words[0]));
    }
  }
  data_begin_ = std::min(at + 1, bytes.size());
  if (format_ != "ascii" && format_ != "binary_little_endian") {
    Fail("PLY format is " + Quoted(format_) + "; expected ascii or binary_little_endian");
  }
  if (properties_.empty() || count_ == 0) Fail("holds no points: no vertex in its header");
}

void Table::ReadElement(const std::vector<std::string_view>& words) {
  element_count_ = 0;
  if (words.size() != 3 || !ParseNumber(words[2], &element_count_) ||
      element_count_ > kMaxRecords) {
    Fail("PLY header: an element is " +
         Quoted(words.size() > 2 ? words[2] : std::string_view("nothing")) +
         "; expected a name and a number up to " + std::to_string(kMaxRecords));
  }
  if (words[1] == "vertex" && section_ == Section::kBefore) {
    section_ = Section::kVertex;
    count_ = element_count_;
    return;
  }
  if (section_ == Section::kVertex) section_ = Section::kAfter;
  if (section_ == Section::kBefore) before_records_ += element_count_;
  if (before_records_ > kMaxRecords) Fail("PLY header: too many elements before the vertices");
}

void Table::ReadProperty(const std::vector<std::string_view>& words) {
  if (section_ == Section::kAfter) return;
  const Type* type = words.size() == 3 ? FindType(std::string(words[1])) : nullptr;
  if (type == nullptr || properties_.size() >= kMaxProperties) {
    Fail("PLY header: property " + Quoted(words.size() > 1 ? words[1] : std::string_view()) +
         " before the end of the vertices; expected char to double, and no list");
  }
  if (section_ == Section::kBefore) {
    before_bytes_ += type->size * element_count_;
    if (before_bytes_ > kMaxRecords * 8) Fail("PLY header: too much before the vertices");
    return;
  }
  properties_.push_back({std::string(words[2]), std::string(words[1]), type->size, stride_});
  stride_ += type->size;
}

void Table::ReadAscii(std::string_view data) {
  // A record is a line: one of an element before the vertices has at least its end.
  for (std::size_t i = 0; i < before_records_; ++i) {
    const std::size_t end = data.find('\n');
    if (end == std::string_view::npos) Fail("is cut short before its points");
    data.remove_prefix(end + 1);
  }
  // Every number takes two bytes at least, the last perhaps one.
  if ((data.size() + 1) / 2 / properties_.size() < count_) {
    Fail("is cut short: the header promises " + std::to_string(count_) + " points, only " +
         std::to_string(data.size()) + " bytes are there");
  }
  ascii_.resize(properties_.size());
  for (std::vector<double>& column : ascii_) column.reserve(count_);
  for (std::size_t point = 0; point < count_; ++point) {
    for (std::size_t p = 0; p < properties_.size(); ++p) {
      const std::string_view word = NextWord(&data);
      double value = 0;
      if (word.empty()) {
        Fail("is cut short: the header promises " + std::to_string(count_) + " points, " +
             std::to_string(point) + " are there");
      }
      if (!ParseNumber(word, &value)) {
        Fail("point " + std::to_string(point + 1) + ": " + properties_[p].name + " is " +
             Quoted(word) + "; expected a number");
      }
      ascii_[p].push_back(value);
    }
  }
}

const Property* Table::Find(const std::string& name) const {
  for (const Property& property : properties_) {
    if (property.name == name) return &property;
  }
  return nullptr;
}

std::vector<double> Table::Column(const std::string& name) const {
  const Property* property = Find(name);
  if (property == nullptr) {
    std::string names;
    for (const Property& p : properties_) names += " " + p.name;
    Fail("has no property " + name + "; its properties are:" + names);
  }
  if (!ascii_.empty()) return ascii_[static_cast<std::size_t>(property - properties_.data())];
  const auto load = FindType(property->type)->load;
  std::vector<double> values(count_);
  for (std::size_t i = 0; i < count_; ++i) {
    values[i] = load(binary_.data() + i * stride_ + property->offset);
  }
  return values;
}

}  // namespace rgbdt::ply
