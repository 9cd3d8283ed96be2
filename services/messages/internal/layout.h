#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "services/messages/internal/lcm_files.h"

namespace rgbdt {

/// The layouts of message types, to check bytes against before lcm-gen's decoder reads them.
/// LCM 1.3.1's decoders trust what they read: they size a vector by the count before looking
/// whether the bytes are there (2^31 - 1: gigabytes; negative: an exception), multiply counts in
/// `int` (2^30 floats: wraps to 0, passes the check and reads past the heap), take a string's
/// length minus one for its length (0: an exception; negative: another, and the position runs
/// backwards) and ignore bytes that are left over.
class Layouts {
 public:
  /// Throws std::logic_error at a type that is not known and at a count that is no earlier int32_t.
  explicit Layouts(const std::vector<LcmType>& types);
  Layouts(const Layouts&) = delete;  // a field points to the type that it holds
  Layouts& operator=(const Layouts&) = delete;

  /// The types of lcmtypes/.
  static const Layouts& OfMessages();

  /// Throws InputError, naming the field that does not fit, unless `size` bytes are exactly a
  /// fingerprint (any) and one value of the type.
  void Check(std::string_view type, const std::uint8_t* data, std::size_t size) const;

 private:
  struct Type;
  struct Field {
    std::string name;
    std::uint64_t bytes = 0;  // of one element; of a string or a struct the least that it takes
    bool is_string = false;
    bool is_count = false;            // counts a later field's elements
    const Type* part = nullptr;       // of a struct
    std::uint64_t repeats = 1;        // the constant sizes of an array, multiplied
    std::vector<std::size_t> counts;  // its other sizes: which of the type's counts they are
  };
  struct Type {
    std::vector<Field> fields;
  };
  class Walker;

  Field MakeField(const LcmType& type, const LcmField& field) const;
  void AddSize(const LcmType& type, const std::string& size, Field* field) const;

  std::map<std::string, Type, std::less<>> types_;
};

}  // namespace rgbdt
