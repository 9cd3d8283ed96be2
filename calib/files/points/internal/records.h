#pragma once

// Tables of binary records, as PCD and PLY hold them.

#include <cstring>
#include <functional>
#include <string>
#include <vector>

namespace rgbdt::records {

struct Column {
  std::string name;
  char type;  ///< PCD's: I, U or F
  std::size_t size;
  std::function<void(std::size_t, char*)> put;  ///< writes the value of one record
};

/// A column of T; value(i) gives the value of record i.
template <typename T, typename Value>
Column MakeColumn(const std::string& name, Value value) {
  const char type = std::is_floating_point_v<T> ? 'F' : std::is_signed_v<T> ? 'I' : 'U';
  return {name, type, sizeof(T), [value](std::size_t i, char* out) {
            const T v = static_cast<T>(value(i));
            std::memcpy(out, &v, sizeof v);
          }};
}

/// `count` records, one after the other, no padding; little-endian, as this machine is.
inline std::string Pack(const std::vector<Column>& columns, std::size_t count) {
  std::size_t stride = 0;
  for (const Column& column : columns) stride += column.size;
  std::string bytes(stride * count, '\0');
  char* out = bytes.data();
  for (std::size_t i = 0; i < count; ++i) {
    for (const Column& column : columns) {
      column.put(i, out);
      out += column.size;
    }
  }
  return bytes;
}

}  // namespace rgbdt::records
