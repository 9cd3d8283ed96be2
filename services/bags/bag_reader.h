#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "calib/model/time.h"

namespace rgbdt {

/// How a topic's messages are laid out.
enum class BagEncoding {
  kRos1,  ///< ROS 1: packed, little-endian
  kCdr,   ///< ROS 2: CDR, behind four bytes that name its kind
  kProtobuf,
  kOther,  ///< listed, not read
};

struct BagTopic {
  std::string name;  ///< "/camera/image_raw"
  std::string type;  ///< "sensor_msgs/Image", of ROS 2 likewise, without its "msg/"
  BagEncoding encoding = BagEncoding::kOther;
};

/// Where a message lies; of use to the reader that gave it.
struct BagPlace {
  std::int32_t file = 0;    ///< of a bag that is split into several
  std::int64_t at = 0;      ///< of the chunk or message in the file [byte]; sqlite: its row
  std::int64_t within = 0;  ///< of the message in the unpacked chunk [byte]; -1: it is in none
};

/// Files are read in order of their places.
bool operator<(const BagPlace& a, const BagPlace& b);

struct BagMessage {
  std::size_t topic = 0;               ///< index into topics()
  Utime log_utime = 0;                 ///< when the recorder received it; its own clock
  BagPlace place;                      ///< for BagReader::Read
  const std::uint8_t* data = nullptr;  ///< until the reader's next call
  std::size_t size = 0;                ///< [byte]
};

/// No message and no chunk, packed or unpacked, is larger; what claims to be is refused before
/// memory is taken. So a reader never holds more than two of these.
inline constexpr std::size_t kMostBagBytes = std::size_t{128} << 20;
inline constexpr std::size_t kMostBagTopics = 4096;

/// A bag of ROS: its topics, and its messages in the order in which they lie in the file. Memory
/// does not grow with the bag. What is damaged or cut off ends the file's messages, is told by
/// problems(), and loses nothing of what lies before it.
class BagReader {
 public:
  virtual ~BagReader() = default;

  /// The next message; false at the end. Throws InputError where the disk fails.
  virtual bool Next(BagMessage* message) = 0;
  /// Once more a message that Next gave, once Next has come to the end. In the order of places each
  /// chunk is unpacked once. Throws InputError where the file has changed since.
  virtual BagMessage Read(const BagPlace& place) = 0;
  /// Frees what it holds of the file, until it is read on.
  virtual void Rest() = 0;

  /// Those met so far; all of them once Next has come to the end.
  virtual const std::vector<BagTopic>& topics() const = 0;
  /// Once Next has come to the end, a line each: where it is cut off or damaged, and the parts that
  /// its metadata.yaml lists and that are not there.
  virtual const std::vector<std::string>& problems() const = 0;
  /// How far Next is, of how much [byte].
  virtual std::int64_t position() const = 0;
  virtual std::int64_t size() const = 0;
  /// "MCAP", "ROS 2 bag (sqlite)", "ROS 1 bag"
  virtual std::string format() const = 0;
};

/// Opens a bag by what its first bytes say: MCAP, ROS 2's sqlite (.db3), or ROS 1's (version 2.0).
/// A folder, as ROS 2 records it, stands for the bags in it, in the order of their names; of
/// several kinds for those that its metadata.yaml lists. What tools left of an earlier state
/// (NAME.zstd beside NAME, NAME.orig.bag beside NAME.bag) does not count. Throws InputError naming
/// the file, and what to do about it: not there, no regular file, none of these, packed as a whole,
/// a folder of several kinds.
std::unique_ptr<BagReader> OpenBag(const std::filesystem::path& path);

}  // namespace rgbdt
