#pragma once

// A regular file that is read by place, and what the readers of bags share.

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "calib/model/descriptor.h"
#include "calib/model/errors.h"
#include "services/bags/bag_reader.h"

namespace rgbdt::bags {

/// The disk fails: no matter of what is written in the bag, and met again at the next try.
struct DiskError : InputError {
  using InputError::InputError;
};

class BagFile {
 public:
  /// Throws InputError: not there, or no regular file (a pipe or device could hold us forever).
  explicit BagFile(const std::filesystem::path& path);

  const std::string& path() const { return path_; }
  std::int64_t size() const { return size_; }
  /// At most `bytes` from `from`; fewer at the end of the file. Throws DiskError.
  std::size_t Read(std::int64_t from, void* to, std::size_t bytes) const;
  /// False where the file ends before.
  bool ReadAll(std::int64_t from, std::size_t bytes, std::vector<std::uint8_t>* to) const;

 private:
  std::string path_;
  Descriptor descriptor_;
  std::int64_t size_ = 0;
};

/// The topics of a bag, each once.
class TopicList {
 public:
  /// Its index. "sensor_msgs/msg/Image" and "sensor_msgs/Image" are one. Throws InputError for more
  /// than kMostBagTopics.
  std::size_t Add(const std::string& name, const std::string& type, BagEncoding encoding);
  const std::vector<BagTopic>& topics() const { return topics_; }

 private:
  std::vector<BagTopic> topics_;
  std::map<std::string, std::size_t> index_;
};

/// What was wrong, a line each; of very many the first ones, and how many more there were.
class Problems {
 public:
  void Add(const std::string& line);
  const std::vector<std::string>& lines() const { return lines_; }

 private:
  std::vector<std::string> lines_;
  std::size_t more_ = 0;
};

/// Of a chunk with more records than this that are of no use the rest is left out.
inline constexpr std::size_t kMostBadRecords = 100'000;

/// Unsigned, little-endian, as long as T.
template <typename T>
T LittleEndian(const std::uint8_t* bytes) {
  T value = 0;
  for (std::size_t i = 0; i < sizeof(T); ++i) value |= static_cast<T>(T{bytes[i]} << (8 * i));
  return value;
}

/// Nanoseconds since 1970 as Utime.
inline Utime FromNanoseconds(std::uint64_t ns) { return static_cast<Utime>(ns / 1000); }

std::unique_ptr<BagReader> OpenMcap(const std::filesystem::path& path);
std::unique_ptr<BagReader> OpenSqlite(const std::filesystem::path& path);
std::unique_ptr<BagReader> OpenRos1(const std::filesystem::path& path);

}  // namespace rgbdt::bags
