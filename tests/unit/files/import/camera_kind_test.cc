#include "calib/files/import/camera_kind.h"

#include <gtest/gtest.h>

namespace rgbdt {
namespace {

TEST(CameraKind, NamesThatSayThermal) {
  for (const char* name : {"thermal", "/Thermal_cam/image", "lwir2"}) {
    EXPECT_TRUE(SaysThermal(name, false)) << name;
    EXPECT_TRUE(SaysThermal(name, true)) << name;
  }
  for (const char* name : {"flir", "boson_640", "/lepton/image", "TAU2", "/ir/left", "cam_IR"}) {
    EXPECT_FALSE(SaysThermal(name, false)) << name;
    EXPECT_TRUE(SaysThermal(name, true)) << name;
  }
  for (const char* name : {"first", "mirror", "/air/image", "restaurant", "rgb", ""}) {
    EXPECT_FALSE(SaysThermal(name, true)) << name;
  }
}

}  // namespace
}  // namespace rgbdt
