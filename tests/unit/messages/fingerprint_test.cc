#include <gtest/gtest.h>

#include <lcmtypes/rgbdt/radiometry_t.hpp>

#include "services/messages/internal/codec_types.h"

namespace rgbdt {
namespace {

// The wire is frozen: others write these types and read these logs. If this fails, a field was
// changed; put it back and add a new type instead (lcmtypes/README.md).
TEST(Fingerprint, IsWhatItWas) {
  EXPECT_EQ(static_cast<std::uint64_t>(board_crossing_t::getHash()), 0x6c19c0cb7fb44dcaU);
  EXPECT_EQ(static_cast<std::uint64_t>(board_scatter_t::getHash()), 0x08fcae78c0452dbbU);
  EXPECT_EQ(static_cast<std::uint64_t>(calibration_t::getHash()), 0xc21f3b8901adb5f5U);
  EXPECT_EQ(static_cast<std::uint64_t>(cloud_board_t::getHash()), 0x6859950b01c53848U);
  EXPECT_EQ(static_cast<std::uint64_t>(cloud_t::getHash()), 0x125e8ff78f44efb8U);
  EXPECT_EQ(static_cast<std::uint64_t>(corner_selection_t::getHash()), 0x02f689fdcac537a0U);
  EXPECT_EQ(static_cast<std::uint64_t>(encoder_t::getHash()), 0x7aad6668dd2e9ec1U);
  EXPECT_EQ(static_cast<std::uint64_t>(image_side_t::getHash()), 0xd4257e8462efb945U);
  EXPECT_EQ(static_cast<std::uint64_t>(image_t::getHash()), 0xf724a27bdd3abd9cU);
  EXPECT_EQ(static_cast<std::uint64_t>(line_scan_t::getHash()), 0x62ff83194fdec7fcU);
  EXPECT_EQ(static_cast<std::uint64_t>(observation_t::getHash()), 0x882584ff7f6e6b63U);
  EXPECT_EQ(static_cast<std::uint64_t>(observation_v2_t::getHash()), 0xa28c8da94093e439U);
  EXPECT_EQ(static_cast<std::uint64_t>(observation_v3_t::getHash()), 0x3e0cce15794126a8U);
  EXPECT_EQ(static_cast<std::uint64_t>(pose_t::getHash()), 0xfd782618dd276dcfU);
  EXPECT_EQ(static_cast<std::uint64_t>(radiometry_t::getHash()), 0x2570e4bcc16de0dbU);
  EXPECT_EQ(static_cast<std::uint64_t>(report_t::getHash()), 0x5c2dc84a6180ae4dU);
  EXPECT_EQ(static_cast<std::uint64_t>(rgbdt_cloud_t::getHash()), 0xd7bb8efddb8b9255U);
  EXPECT_EQ(static_cast<std::uint64_t>(rgbdt_cloud_v2_t::getHash()), 0x8b533415a1cd35d9U);
  EXPECT_EQ(static_cast<std::uint64_t>(rig_t::getHash()), 0x9c564d644627e935U);
  EXPECT_EQ(static_cast<std::uint64_t>(session_command_t::getHash()), 0x259249a63234a765U);
  EXPECT_EQ(static_cast<std::uint64_t>(session_event_t::getHash()), 0x20babb8a4ce9fbb5U);
  EXPECT_EQ(static_cast<std::uint64_t>(session_request_t::getHash()), 0xa4aca4bce278bf57U);
  EXPECT_EQ(static_cast<std::uint64_t>(sighting_t::getHash()), 0x283a34272dbe5254U);
  EXPECT_EQ(static_cast<std::uint64_t>(status_t::getHash()), 0xcc7326579c48e529U);
  EXPECT_EQ(static_cast<std::uint64_t>(target_pose_t::getHash()), 0x9d6616d77af99f13U);
}

}  // namespace
}  // namespace rgbdt
