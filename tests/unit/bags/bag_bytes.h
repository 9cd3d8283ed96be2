#pragma once

// Small bags, byte by byte from the formats' pages.

#include <cstdint>
#include <string>

namespace rgbdt::test {

template <typename T>
std::string Little(T value) {
  std::string bytes;
  for (std::size_t i = 0; i < sizeof(T); ++i) {
    bytes += static_cast<char>(static_cast<std::uint64_t>(value) >> (8 * i));
  }
  return bytes;
}

inline std::string Text(const std::string& text) {
  return Little(static_cast<std::uint32_t>(text.size())) + text;
}

// MCAP

inline const std::string kMcapMagic = "\x89MCAP0\r\n";

inline std::string McapRecord(int opcode, const std::string& content) {
  return static_cast<char>(opcode) + Little(std::uint64_t{content.size()}) + content;
}

/// Channel 1, "/a" of a/msg/A, and channel 2, "/b" of b/B.
inline std::string McapChannels() {
  std::string bytes;
  for (const std::uint16_t id : {1, 2}) {
    const std::string letter = id == 1 ? "a" : "b", type = id == 1 ? "a/msg/A" : "b/B";
    bytes += McapRecord(3, Little(id) + Text(type) + Text("ros2msg") + Text(""));
    bytes += McapRecord(4, Little(id) + Little(id) + Text("/" + letter) +
                               Text(id == 1 ? "cdr" : "json") + Little(std::uint32_t{0}));
  }
  return bytes;
}

inline std::string McapMessage(int channel, std::uint64_t log_ns, const std::string& data) {
  return McapRecord(5, Little(static_cast<std::uint16_t>(channel)) + Little(std::uint32_t{0}) +
                           Little(log_ns) + Little(log_ns) + data);
}

inline std::string McapChunk(const std::string& compression, const std::string& packed,
                             std::uint64_t unpacked, std::uint32_t crc = 0) {
  return McapRecord(6, Little(std::uint64_t{0}) + Little(std::uint64_t{0}) + Little(unpacked) +
                           Little(crc) + Text(compression) + Little(std::uint64_t{packed.size()}) +
                           packed);
}

inline std::string McapEnd() { return McapRecord(15, Little(std::uint32_t{0})); }

// ROS 1

inline const std::string kRos1Magic = "#ROSBAG V2.0\n";

inline std::string Ros1Record(const std::string& header, const std::string& data) {
  return Text(header) + Text(data);
}

inline std::string Ros1Field(const std::string& name, const std::string& value) {
  return Text(name + "=" + value);
}

inline std::string Ros1Connection() {
  return Ros1Record(Ros1Field("op", "\x07") + Ros1Field("conn", Little(std::uint32_t{5})) +
                        Ros1Field("topic", "/a"),
                    Ros1Field("topic", "/a") + Ros1Field("type", "a/A"));
}

inline std::string Ros1Message(std::uint32_t seconds, const std::string& data) {
  return Ros1Record(Ros1Field("op", "\x02") + Ros1Field("conn", Little(std::uint32_t{5})) +
                        Ros1Field("time", Little(seconds) + Little(std::uint32_t{500'000'000})),
                    data);
}

inline std::string Ros1Chunk(const std::string& compression, const std::string& packed,
                             std::uint32_t unpacked) {
  return Ros1Record(Ros1Field("op", "\x05") + Ros1Field("compression", compression) +
                        Ros1Field("size", Little(unpacked)),
                    packed);
}

}  // namespace rgbdt::test
