#include <gtest/gtest.h>

#include <cstdint>
#include <map>
#include <set>
#include <string>

#include "services/messages/internal/codec_board.h"
#include "services/messages/internal/codec_types.h"
#include "services/messages/internal/lcm_files.h"

// LCM recognises a type by its fingerprint: a hash of its fields' names, types and sizes.

namespace rgbdt {
namespace {

struct Fingerprint {
  const char* name;
  std::uint64_t generated;  // what lcm-gen's code has
  std::uint64_t frozen;
};

template <typename Wire>
Fingerprint Of(std::uint64_t frozen) {
  return {Wire::getTypeName(), static_cast<std::uint64_t>(Wire::getHash()), frozen};
}

// The wire is frozen: others write these types and read these logs. A type that was released never
// changes; what it lacks goes into a new type (lcmtypes/README.md).
const Fingerprint kFingerprints[] = {
    Of<board_crossing_t>(0x5e8f49c77d39f5f6U),
    Of<calibration_t>(0x2b248f720462250dU),
    Of<camera_timing_t>(0x2a5d71714d4cc17bU),
    Of<cloud_board_t>(0x67f4e17f2914bb3dU),
    Of<cloud_t>(0x125e8ff78f44efb8U),
    Of<corner_selection_t>(0x02f689fdcac537a0U),
    Of<encoder_t>(0x7aad6668dd2e9ec1U),
    Of<image_detection_t>(0x2ce9e958f8e31161U),
    Of<image_side_t>(0xd4257e8462efb945U),
    Of<image_t>(0xf724a27bdd3abd9cU),
    Of<left_out_views_t>(0x0212eab24ee5a3bbU),
    Of<line_scan_t>(0x62ff83194fdec7fcU),
    Of<mount_check_t>(0xd5aaa5bd02506231U),
    Of<odometry_t>(0x01ea34d9ea8d22b6U),
    Of<point_group_t>(0xc71a49ecf463d9bbU),
    Of<pose_t>(0xfd782618dd276dcfU),
    Of<radiometry_t>(0x2570e4bcc16de0dbU),
    Of<range_errors_t>(0x026ed0aa7b9298e9U),
    Of<report_t>(0x5c2dc84a6180ae4dU),
    Of<rgbdt_cloud_t>(0x2a5b800eb3691379U),
    Of<rig_t>(0x9c564d644627e935U),
    Of<session_command_t>(0x259249a63234a765U),
    Of<session_event_t>(0x20babb8a4ce9fbb5U),
    Of<session_request_t>(0xa4aca4bce278bf57U),
    Of<solved_lens_t>(0x2166f083e957d365U),
    Of<status_t>(0xcc7326579c48e529U),
    Of<target_pose_t>(0x9d6616d77af99f13U),
    Of<target_status_t>(0x283a34272dbe5254U),
    Of<view_detection_t>(0xc9e1319ede1e345eU),
    Of<wave_progress_t>(0x81a9410fdf5c44fdU),
    Of<waved_clock_t>(0x397e8c863aac8ed7U),
};

TEST(Fingerprint, IsWhatItWas) {
  for (const Fingerprint& type : kFingerprints) {
    EXPECT_EQ(type.generated, type.frozen) << type.name << std::hex << " 0x" << type.generated;
  }
}

// lcm-gen's hash, of what ParseLcm read: the layouts are those of the decoders.
class Hash {
 public:
  void Add(char c) {
    const auto high = static_cast<std::uint64_t>(static_cast<std::int64_t>(value_) >> 55);
    value_ = ((value_ << 8) ^ high) + static_cast<std::uint64_t>(c);
  }
  void Add(const std::string& text) {
    Add(static_cast<char>(text.size()));
    for (const char c : text) Add(c);
  }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0x12345678;
};

using Types = std::map<std::string, LcmType>;

std::uint64_t FingerprintOf(const Types& types, const std::string& name) {
  static const std::set<std::string> primitive = {
      "int8_t", "int16_t", "int32_t", "int64_t", "byte", "boolean", "float", "double", "string"};
  Hash hash;
  std::uint64_t parts = 0;
  for (const LcmField& field : types.at(name).fields) {
    hash.Add(field.name);
    if (primitive.count(field.type) > 0) {
      hash.Add(field.type);
    } else {
      parts += FingerprintOf(types, field.type);
    }
    hash.Add(static_cast<char>(field.sizes.size()));
    for (const std::string& size : field.sizes) {
      const bool is_number = size.find_first_not_of("0123456789") == std::string::npos;
      hash.Add(static_cast<char>(is_number ? 0 : 1));
      hash.Add(size);
    }
  }
  const std::uint64_t sum = hash.value() + parts;
  return sum << 1 | sum >> 63;
}

TEST(Fingerprint, TheLayoutsAreReadAsLcmGenReadsThem) {
  Types types;
  for (LcmType& type : ParseLcm(LcmFiles())) types[type.name] = type;
  EXPECT_EQ(types.size(), std::size(kFingerprints));
  for (const Fingerprint& type : kFingerprints) {
    ASSERT_EQ(types.count(type.name), 1U) << type.name;
    EXPECT_EQ(FingerprintOf(types, type.name), type.generated) << type.name;
  }
}

}  // namespace
}  // namespace rgbdt
