#include <gmock/gmock.h>

#include "calib/files/schema/rig_file.h"
#include "tests/unit/files/test_data.h"

namespace rgbdt {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::string RigWith(const std::string& lidar, const std::string& camera) {
  return "name: \"field\"\nlidar { name: \"lidar\" " + lidar +
         " }\ncamera { name: \"rgb\" kind: COLOR width: 640 height: 480 pixel_format: BAYER_RG8\n"
         "pinhole { fx: 500 fy: 500 cx: 320 cy: 240 }\n" +
         camera +
         " }\ntarget { squares_x: 11 squares_y: 8 square_m: 0.1 width_m: 1.2192 height_m: 0.9144 "
         "}\n";
}

const char kMotor[] =
    "turned_scanner { motor_from_scanner { quaternion_wxyz: [1, 0, 0, 0] translation_m: [0, 0, 0] "
    "} ticks_per_degree: 1394 dynamixel { port: \"/dev/ttyUSB0\" from_deg: -30 to_deg: 210 "
    "speed_deg_s: 12 } }";

// As it comes back from being printed.
Rig Again(const std::string& lidar, const std::string& camera) {
  return ParseRig(PrintRig(ParseRig(RigWith(lidar, camera), "rig")), "printed");
}

TEST(RigDevices, ACameraComesBack) {
  const Rig rig = Again("",
                        "device { address: \"10.0.0.3\" feature { name: \"PixelFormat\" value: "
                        "\"BayerRG8\" } feature { name: \"ExposureTime\" value: \"5000\" } "
                        "trigger: SOFTWARE wire: JPEG packet_bytes: 8228 }");
  ASSERT_TRUE(rig.cameras[0].device);
  const CameraDevice& device = *rig.cameras[0].device;
  EXPECT_EQ(device.address, "10.0.0.3");
  EXPECT_EQ(device.serial + device.id, "");
  ASSERT_EQ(device.features.size(), 2u);
  EXPECT_EQ(device.features[1].first, "ExposureTime");
  EXPECT_EQ(device.features[1].second, "5000");
  EXPECT_EQ(device.trigger, CameraDevice::Trigger::kSoftware);
  EXPECT_EQ(device.wire, CameraDevice::Wire::kJpeg);
  EXPECT_EQ(device.packet_bytes, 8228);
  const Rig plain = Again("", "device { address: \"10.0.0.3\" }");
  EXPECT_FALSE(plain.cameras[0].device->wire) << "by where the bus goes";
  const Rig raw = Again("", "device { address: \"10.0.0.3\" wire: RAW }");
  EXPECT_EQ(raw.cameras[0].device->wire, CameraDevice::Wire::kRaw);
}

TEST(RigDevices, EachLidarComesBack) {
  const Rig hokuyo = Again("hokuyo { address: \"192.168.0.10\" }", "");
  EXPECT_EQ(std::get<HokuyoDevice>(hokuyo.lidar.device).address, "192.168.0.10");
  EXPECT_EQ(std::get<HokuyoDevice>(hokuyo.lidar.device).port, 10940);
  const Rig velodyne = Again("velodyne { model: VLP32C port: 2369 pcap: \"drive.pcap\" }", "");
  EXPECT_EQ(std::get<VelodyneDevice>(velodyne.lidar.device).model, VelodyneDevice::Model::kVlp32c);
  EXPECT_EQ(std::get<VelodyneDevice>(velodyne.lidar.device).port, 2369);
  EXPECT_EQ(std::get<VelodyneDevice>(velodyne.lidar.device).pcap, "drive.pcap");
  const auto packets = [](const std::string& text) {
    return std::get<PacketLidarDevice>(Again(text, "").lidar.device);
  };
  const PacketLidarDevice ouster = packets("ouster { metadata: \"os1.json\" pcap: \"a.pcap\" }");
  EXPECT_EQ(ouster.make, PacketLidarDevice::Make::kOuster);
  EXPECT_EQ(ouster.metadata, "os1.json");
  EXPECT_EQ(ouster.port, 7502);
  EXPECT_EQ(ouster.pcap, "a.pcap");
  const PacketLidarDevice hesai = packets("hesai { metadata: \"angles.csv\" port: 2369 }");
  EXPECT_EQ(hesai.make, PacketLidarDevice::Make::kHesai);
  EXPECT_EQ(hesai.port, 2369);
  const PacketLidarDevice livox = packets("livox { }");
  EXPECT_EQ(livox.make, PacketLidarDevice::Make::kLivox);
  EXPECT_EQ(livox.port, 56301);
  const PacketLidarDevice robosense = packets("robosense { metadata: \"angle.csv\" }");
  EXPECT_EQ(robosense.make, PacketLidarDevice::Make::kRobosense);
  EXPECT_EQ(robosense.metadata, "angle.csv");
  EXPECT_EQ(robosense.port, 6699);
  const Rig folder = Again("pcd_folder { folder: \"room\" period_s: 0.5 }", "");
  EXPECT_EQ(std::get<PcdFolderDevice>(folder.lidar.device).folder, "room");
  EXPECT_EQ(std::get<PcdFolderDevice>(folder.lidar.device).period_s, 0.5);
}

TEST(RigDevices, AMotorComesBack) {
  const Rig rig = Again(kMotor, "");
  ASSERT_TRUE(rig.lidar.turned_scanner && rig.lidar.turned_scanner->motor);
  const DynamixelDevice& motor = *rig.lidar.turned_scanner->motor;
  EXPECT_EQ(motor.port, "/dev/ttyUSB0");
  EXPECT_EQ(motor.baud, 57600);
  EXPECT_EQ(motor.id, 1);
  EXPECT_NEAR(motor.from_rad, -30 * M_PI / 180, 1e-12);
  EXPECT_NEAR(motor.to_rad, 210 * M_PI / 180, 1e-12);
  EXPECT_NEAR(motor.speed_rad_s, 12 * M_PI / 180, 1e-12);
}

std::string ErrorOf(const std::string& lidar, const std::string& camera) {
  return test::ErrorOf([&] { ParseRig(RigWith(lidar, camera), "rig.textproto"); });
}

TEST(RigDevices, WhatIsMissingOrWrongIsNamedWithItsLine) {
  EXPECT_THAT(ErrorOf("hokuyo {}", ""),
              HasSubstr("rig.textproto:2: lidar.hokuyo.address is missing"));
  EXPECT_THAT(ErrorOf("velodyne {}", ""), HasSubstr("lidar.velodyne.model is missing"));
  EXPECT_THAT(ErrorOf("velodyne { model: VLP16 port: 70000 }", ""),
              HasSubstr("lidar.velodyne.port is 70000; expected 1 to 65535"));
  EXPECT_THAT(ErrorOf("pcd_folder { folder: \"x\" period_s: -1 }", ""),
              HasSubstr("period_s is -1"));
  EXPECT_THAT(ErrorOf("", "device {}"), HasSubstr("camera.device.serial is missing"));
  EXPECT_THAT(ErrorOf("", "device { serial: \"1\" packet_bytes: 101 }"),
              HasSubstr("packet_bytes is 101; expected 576 to"));
  EXPECT_THAT(ErrorOf("", "device { serial: \"1\" feature { value: \"2\" } }"),
              HasSubstr("feature.name is missing"));
  const auto motor_error = [](const std::string& is, const std::string& becomes) {
    std::string motor = kMotor;
    motor.replace(motor.find(is), is.size(), becomes);
    return ErrorOf(motor, "");
  };
  EXPECT_THAT(motor_error("speed_deg_s: 12", "speed_deg_s: -1"),
              HasSubstr("dynamixel.speed_deg_s is -1"));
  EXPECT_THAT(motor_error("speed_deg_s: 12", "speed_deg_s: 1e300"), HasSubstr("at most 10000"));
  EXPECT_THAT(motor_error("to_deg: 210", "to_deg: -1e300"),
              AllOf(HasSubstr("dynamixel.to_deg is -1"), HasSubstr("at most 256 turns")));
}

}  // namespace
}  // namespace rgbdt
