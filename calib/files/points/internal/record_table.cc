#include "calib/files/points/internal/record_table.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>

#include "calib/model/errors.h"

namespace rgbdt::records {
namespace {

bool IsSpace(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

template <typename T>
bool ParseWhole(std::string_view word, T* value) {
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

void RequireBytes(const Source& source, std::size_t have) {
  // Not count times bytes: forged, that product overflows.
  if (have / source.RecordBytes() >= source.count) return;
  throw InputError(source.where + ": is cut short: " + std::to_string(source.count) +
                   " points of " + std::to_string(source.RecordBytes()) + " bytes from byte " +
                   std::to_string(source.data_begin) + " on, " + std::to_string(have) +
                   " bytes are there");
}

}  // namespace

bool IsKnown(const Field& field) { return LoaderOf(field) != nullptr && field.count > 0; }

std::size_t Source::RecordBytes() const {
  std::size_t sum = 0;
  for (const Field& field : fields) sum += field.size * field.count;
  return sum;
}

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

bool ParseNumber(std::string_view word, double* value) { return ParseWhole(word, value); }
bool ParseNumber(std::string_view word, std::size_t* value) { return ParseWhole(word, value); }
bool ParseNumber(std::string_view word, std::int64_t* value) { return ParseWhole(word, value); }

std::string LineOf(std::string_view bytes, std::size_t at) {
  const auto end = bytes.begin() + static_cast<std::ptrdiff_t>(std::min(at, bytes.size()));
  return "line " + std::to_string(1 + std::count(bytes.begin(), end, '\n'));
}

void Table::Fail(const std::string& what) const { throw InputError(source_.where + ": " + what); }

Table Table::FromAscii(Source source) {
  Table table(std::move(source));
  table.ParseAscii();
  return table;
}

Table Table::FromBinary(Source source) {
  RequireBytes(source, source.bytes.size() - source.data_begin);
  return Table(std::move(source));
}

Table Table::FromColumns(Source source, std::string unpacked) {
  RequireBytes(source, unpacked.size());
  Table table(std::move(source));
  table.unpacked_ = std::move(unpacked);
  return table;
}

void Table::ParseAscii() {
  std::string_view data = source_.bytes.substr(source_.data_begin);
  ascii_.resize(source_.fields.size());
  for (std::size_t record = 0; record < source_.count; ++record) {
    for (std::size_t f = 0; f < source_.fields.size(); ++f) {
      for (std::size_t i = 0; i < source_.fields[f].count; ++i) {
        const std::string_view word = NextWord(&data);
        double value = 0;
        if (word.empty()) {
          Fail("is cut short: the header promises " + std::to_string(source_.count) + " points, " +
               std::to_string(record) + " are there");
        }
        if (!ParseNumber(word, &value)) {
          Fail(LineOf(source_.bytes, static_cast<std::size_t>(word.data() - source_.bytes.data())) +
               ": " + source_.fields[f].name + " is \"" + std::string(word.substr(0, 40)) +
               "\"; expected a number");
        }
        if (i == 0) ascii_[f].push_back(value);
      }
    }
  }
}

const Field* Table::Find(const std::string& name) const {
  for (const Field& field : source_.fields) {
    if (field.name == name) return &field;
  }
  return nullptr;
}

const Field& Table::Get(const std::string& name) const {
  const Field* field = Find(name);
  if (field != nullptr) return *field;
  std::string names;
  for (const Field& f : source_.fields) names += " " + f.name;
  Fail("has no field " + name + "; its fields are:" + names);
}

// Calls take(i, bytes) with the field's first element of every record.
template <typename Take>
void Table::ForEach(const Field& field, Take take) const {
  std::size_t before = 0;  // bytes of one record that precede the field
  for (const Field* f = source_.fields.data(); f != &field; ++f) before += f->size * f->count;
  const bool by_column = !unpacked_.empty();
  const char* first = by_column ? unpacked_.data() + before * size()
                                : source_.bytes.data() + source_.data_begin + before;
  const std::size_t stride = by_column ? field.size * field.count : source_.RecordBytes();
  for (std::size_t i = 0; i < size(); ++i) take(i, first + i * stride);
}

std::vector<double> Table::Column(const std::string& name) const {
  const Field& field = Get(name);
  if (!ascii_.empty()) return ascii_[static_cast<std::size_t>(&field - source_.fields.data())];
  const Loader load = LoaderOf(field);
  std::vector<double> values(size());
  ForEach(field, [&](std::size_t i, const char* bytes) { values[i] = load(bytes); });
  return values;
}

std::vector<std::uint32_t> Table::Bits(const std::string& name) const {
  const Field& field = Get(name);
  std::vector<std::uint32_t> bits(size(), 0);
  if (ascii_.empty() && field.size == 4) {
    ForEach(field, [&](std::size_t i, const char* bytes) {
      std::memcpy(&bits[i], bytes, sizeof bits[i]);
    });
    return bits;
  }
  const std::vector<double> values = Column(name);
  for (std::size_t i = 0; i < size(); ++i) {
    const float value = static_cast<float>(values[i]);
    if (values[i] >= 1 && values[i] < 0x1p32 && values[i] == std::floor(values[i])) {
      bits[i] = static_cast<std::uint32_t>(values[i]);
    } else {
      std::memcpy(&bits[i], &value, sizeof bits[i]);
    }
  }
  return bits;
}

}  // namespace rgbdt::records
