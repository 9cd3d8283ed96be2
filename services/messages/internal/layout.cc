#include "services/messages/internal/layout.h"

#include <algorithm>
#include <cctype>
#include <cstring>
#include <stdexcept>

#include "calib/model/errors.h"

namespace rgbdt {
namespace {

constexpr std::size_t kFingerprintBytes = 8;
constexpr std::uint64_t kLeastString = 5;  // its length and its NUL

// 0: not one of LCM's own types.
std::uint64_t BytesOf(std::string_view type) {
  if (type == "int64_t" || type == "double") return 8;
  if (type == "int32_t" || type == "float") return 4;
  if (type == "int16_t") return 2;
  if (type == "int8_t" || type == "byte" || type == "boolean") return 1;
  return type == "string" ? kLeastString : 0;
}

bool IsNumber(const std::string& size) {
  return std::isdigit(static_cast<unsigned char>(size.front())) != 0;
}

// The fields that count others', in their order.
std::vector<std::string> CountsOf(const LcmType& type) {
  std::vector<std::string> counts;
  for (const LcmField& field : type.fields) {
    const bool counts_others =
        std::any_of(type.fields.begin(), type.fields.end(), [&](const LcmField& other) {
          return std::find(other.sizes.begin(), other.sizes.end(), field.name) != other.sizes.end();
        });
    if (counts_others) counts.push_back(field.name);
  }
  return counts;
}

[[noreturn]] void Fail(const LcmType& type, const std::string& field, const std::string& why) {
  throw std::logic_error(type.name + "." + field + ": " + why);
}

}  // namespace

// Goes through a message field by field.
class Layouts::Walker {
 public:
  Walker(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {
    Skip(kFingerprintBytes, "the fingerprint");
  }

  void Fields(const Type& type) {
    std::vector<std::uint64_t> counts;
    for (const Field& field : type.fields) {
      if (field.is_count) {
        counts.push_back(ReadCount(field));
      } else {
        Elements(field, NumberOf(field, counts));
      }
    }
  }

  void End() const {
    if (at_ == size_) return;
    throw InputError("the message has " + std::to_string(size_ - at_) +
                     " bytes more than its fields take");
  }

 private:
  // After each count no more elements than bytes are left. So nothing overflows, and a decoder that
  // allocates an array's outer sizes first does not allocate more either.
  std::uint64_t NumberOf(const Field& field, const std::vector<std::uint64_t>& counts) const {
    std::uint64_t number = 1;
    for (const std::size_t count : field.counts) {
      number *= counts[count];
      Hold(number * field.bytes, field.name);
    }
    return number * field.repeats;
  }

  void Elements(const Field& field, std::uint64_t number) {
    if (field.part == nullptr && !field.is_string) return Skip(number * field.bytes, field.name);
    for (std::uint64_t i = 0; i < number; ++i) {
      if (field.is_string) {
        SkipString(field.name);
      } else {
        Fields(*field.part);
      }
    }
  }

  void Hold(std::uint64_t bytes, std::string_view what) const {
    if (bytes <= size_ - at_) return;
    throw InputError("the message is cut short: " + std::string(what) + " needs " +
                     std::to_string(bytes) + " bytes at byte " + std::to_string(at_) + " of " +
                     std::to_string(size_));
  }

  void Skip(std::uint64_t bytes, std::string_view what) {
    Hold(bytes, what);
    at_ += bytes;
  }

  std::int32_t ReadInt(std::string_view what) {
    const std::uint8_t* p = data_ + at_;
    Skip(4, what);
    return static_cast<std::int32_t>(std::uint32_t{p[0]} << 24 | std::uint32_t{p[1]} << 16 |
                                     std::uint32_t{p[2]} << 8 | std::uint32_t{p[3]});
  }

  std::uint64_t ReadCount(const Field& field) {
    const std::int32_t value = ReadInt(field.name);
    if (value < 0) throw InputError(field.name + " is " + std::to_string(value));
    return static_cast<std::uint64_t>(value);
  }

  // A length that includes the closing NUL, the characters, NUL.
  void SkipString(const std::string& name) {
    const std::int32_t length = ReadInt(name);
    if (length < 1) throw InputError("length of " + name + " is " + std::to_string(length));
    const std::uint8_t* text = data_ + at_;
    Skip(static_cast<std::uint64_t>(length), name);
    if (std::memchr(text, 0, static_cast<std::size_t>(length)) != text + length - 1) {
      throw InputError(name + " at byte " + std::to_string(text - data_) +
                       " does not end with its only NUL");
    }
  }

  const std::uint8_t* data_;
  std::size_t size_;
  std::size_t at_ = 0;
};

Layouts::Layouts(const std::vector<LcmType>& types) {
  for (const LcmType& type : types) types_[type.name];  // all names first: fields point to types
  for (const LcmType& type : types) {
    if (type.fields.empty()) throw std::logic_error(type.name + " has no fields");
    std::vector<Field>& fields = types_[type.name].fields;
    for (const LcmField& field : type.fields) fields.push_back(MakeField(type, field));
  }
}

const Layouts& Layouts::OfMessages() {
  static const Layouts layouts(ParseLcm(LcmFiles()));
  return layouts;
}

void Layouts::Check(std::string_view type, const std::uint8_t* data, std::size_t size) const {
  const auto known = types_.find(type);
  if (known == types_.end()) throw std::logic_error("no .lcm file has a " + std::string(type));
  Walker walker(data, size);
  walker.Fields(known->second);
  walker.End();
}

Layouts::Field Layouts::MakeField(const LcmType& type, const LcmField& field) const {
  Field made;
  made.name = field.name;
  made.bytes = BytesOf(field.type);
  made.is_string = field.type == "string";
  if (made.bytes == 0) {
    const auto part = types_.find(field.type);
    if (part == types_.end()) Fail(type, field.name, "unknown type " + field.type);
    made.part = &part->second;
    made.bytes = 1;
  }
  const std::vector<std::string> counts = CountsOf(type);
  made.is_count = std::find(counts.begin(), counts.end(), field.name) != counts.end();
  if (made.is_count && (field.type != "int32_t" || !field.sizes.empty())) {
    Fail(type, field.name, "a count is one int32_t");
  }
  for (const std::string& size : field.sizes) AddSize(type, size, &made);
  return made;
}

void Layouts::AddSize(const LcmType& type, const std::string& size, Field* field) const {
  if (IsNumber(size)) {
    field->repeats *= std::stoul(size);
    return;
  }
  const std::vector<Field>& before = types_.find(type.name)->second.fields;
  const auto is_named = [&](const Field& other) { return other.name == size; };
  if (std::none_of(before.begin(), before.end(), is_named)) {
    Fail(type, field->name, "no field " + size + " before it");
  }
  const std::vector<std::string> counts = CountsOf(type);
  const auto count = std::find(counts.begin(), counts.end(), size);
  field->counts.push_back(static_cast<std::size_t>(count - counts.begin()));
}

}  // namespace rgbdt
