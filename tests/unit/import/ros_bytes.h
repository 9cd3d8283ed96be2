#pragma once

// Messages of ROS, byte by byte.

#include <cstdint>
#include <cstring>
#include <string>

#include "services/bags/bag_reader.h"

namespace rgbdt::test {

/// Appends fields as ROS 1 lays them out, or CDR of ROS 2, of either byte order.
class RosBytes {
 public:
  explicit RosBytes(BagEncoding encoding, bool big_endian = false)
      : encoding_(encoding), big_endian_(big_endian) {}

  template <typename T>
  RosBytes& Add(T value) {
    if (encoding_ == BagEncoding::kCdr)
      body_.resize((body_.size() + sizeof(T) - 1) / sizeof(T) * sizeof(T));
    std::string bytes(sizeof(T), '\0');
    std::memcpy(bytes.data(), &value, sizeof(T));
    body_ += big_endian_ ? std::string(bytes.rbegin(), bytes.rend()) : bytes;
    return *this;
  }
  RosBytes& Text(const std::string& text) {
    const bool cdr = encoding_ == BagEncoding::kCdr;
    Add(static_cast<std::uint32_t>(text.size() + (cdr ? 1 : 0)));
    body_ += text;
    if (cdr) body_ += '\0';
    return *this;
  }
  RosBytes& Blob(const std::string& bytes) {
    Add(static_cast<std::uint32_t>(bytes.size()));
    body_ += bytes;
    return *this;
  }
  RosBytes& Header(std::uint32_t seconds, std::uint32_t nanoseconds, const std::string& frame) {
    if (encoding_ == BagEncoding::kRos1) Add(std::uint32_t{17});  // seq
    return Add(seconds).Add(nanoseconds).Text(frame);
  }

  std::string Bytes() const {
    if (encoding_ == BagEncoding::kRos1) return body_;
    return std::string("\0", 1) + (big_endian_ ? '\0' : '\1') + std::string(2, '\0') + body_;
  }

 private:
  BagEncoding encoding_;
  bool big_endian_;
  std::string body_;
};

inline BagMessage MessageOf(const std::string& bytes) {
  BagMessage message;
  message.data = reinterpret_cast<const std::uint8_t*>(bytes.data());
  message.size = bytes.size();
  return message;
}

}  // namespace rgbdt::test
