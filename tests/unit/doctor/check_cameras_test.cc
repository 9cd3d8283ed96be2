#include <gmock/gmock.h>

#include "tests/unit/doctor/doctor_testing.h"

namespace rgbdt {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr std::uint32_t kMask24 = 0xffffff00;

GvcpDevice Device() {
  GvcpDevice device;
  device.address = 0xc0a80714;  // 192.168.7.20
  device.mask = kMask24;
  device.gateway = 0xc0a80713;
  device.mac = "00:11:1c:00:12:34";
  device.vendor = "Acme";
  device.model = "Fieldcam 3";
  device.serial = "A1";
  return device;
}

// A camera that sends 600 Mbit/s at the end of eth1, within reach and free.
CameraNetwork Network() {
  CameraNetwork network;
  network.interfaces = {{"lo", 1, true, true, true, 65536, {{0x7f000001, 0xff000000, 0}}},
                        {"eth1", 2, true, false, true, 9000, {{0xc0a80701, kMask24, 0}}}};
  network.found = {{Device(), "eth1"}};
  network.mbit_per_s = {{"eth1", 1000}};
  CameraFacts camera;
  camera.name = "rgb";
  camera.device.serial = "A1";
  camera.rate = {600e6, 30, true};
  camera.found = network.found[0];
  camera.interface = camera.next_interface = "eth1";
  camera.control = GvcpControl::kFree;
  network.cameras = {camera};
  return network;
}

TEST(DoctorCameras, OneThatIsWell) {
  EXPECT_THAT(CheckCameras(Network()), ElementsAre(Is(kOk)));
  EXPECT_THAT(CheckPackets(Network()), ElementsAre(Is(kOk)));
  EXPECT_THAT(CheckLinks(Network()), ElementsAre(Is(kOk)));
}

TEST(DoctorCameras, OneInAnotherSubnet) {
  CameraNetwork network = Network();
  InterfaceAddress& own = network.interfaces[1].addresses[0];
  own.address = 0x0a090001;
  // 192.168.7.19 is the camera's router, .18 another camera.
  FoundGvcpDevice other = network.found[0];
  other.device.address = 0xc0a80712;
  network.found.push_back(other);
  EXPECT_THAT(CheckCameras(network),
              ElementsAre(Says(kProblem,
                               "it has 192.168.7.20/24, eth1 where it answers has "
                               "10.9.0.1/24",
                               "sudo ip addr add 192.168.7.17/24 dev eth1")));
  network.cameras[0].found->device.mask = 0xffffffff;
  EXPECT_THAT(CheckCameras(network), ElementsAre(Says(kProblem, "", "192.168.7.17/24")));
  network.interfaces[1].addresses.clear();
  EXPECT_THAT(CheckCameras(network), ElementsAre(Says(kProblem, "has no address", "ip addr add")));
}

TEST(DoctorCameras, ReachIsSeenFromBothSides) {
  NetworkInterface interface = Network().interfaces[1];
  EXPECT_TRUE(WithinReach(Device(), interface));
  interface.addresses[0] = {0xc0a80101, 0xffff0000, 0};  // 192.168.1.1/16: the camera cannot answer
  EXPECT_FALSE(WithinReach(Device(), interface));
  interface.addresses.push_back({0xc0a807c8, kMask24, 0});
  EXPECT_TRUE(WithinReach(Device(), interface));
}

TEST(DoctorCameras, OneByAnotherWay) {
  CameraNetwork network = Network();
  network.cameras[0].next_interface = "eth0";
  EXPECT_THAT(
      CheckCameras(network),
      ElementsAre(Says(kProblem, "leads to eth0", "sudo ip route add 192.168.7.20/32 dev eth1")));
}

TEST(DoctorCameras, OneThatAnotherProgramHolds) {
  CameraNetwork network = Network();
  network.cameras[0].control = GvcpControl::kHeld;
  EXPECT_THAT(CheckCameras(network), ElementsAre(Says(kProblem, "another machine", "close it")));
  network.camera_programs = {{7, "arv-viewer-0.8"}};
  EXPECT_THAT(CheckCameras(network), ElementsAre(Says(kProblem, "arv-viewer-0.8", "kill 7")));
  network.camera_programs = {{8, "rgbdt-camera"}};
  EXPECT_THAT(CheckCameras(network), ElementsAre(Says(kWarning, "rgbdt-camera (pid 8)", "kill 8")));
  network.cameras[0].control = GvcpControl::kNoAnswer;
  EXPECT_THAT(CheckCameras(network), ElementsAre(Says(kProblem, "firewall", "ping -c 1")));
}

TEST(DoctorCameras, OneThatNobodyIs) {
  CameraNetwork network = Network();
  network.cameras[0].found.reset();
  network.cameras[0].device.serial = "B2";
  EXPECT_THAT(CheckCameras(network),
              ElementsAre(Says(kProblem,
                               "serial number B2; there is Acme Fieldcam 3, serial "
                               "number A1, 00:11:1c:00:12:34 at 192.168.7.20 on eth1",
                               "ip -br link")));
  network.filtered = {"eth1"};
  EXPECT_THAT(CheckCameras(network),
              ElementsAre(Is(kProblem), Says(kWarning, "reverse-path filter of eth1",
                                             "net.ipv4.conf.eth1.rp_filter=0")));
  network.cameras[0].by_usb = true;
  EXPECT_THAT(CheckCameras(network), ElementsAre(Is(kOk)));
}

TEST(DoctorCameras, IsTheOneThatTheRigMeans) {
  CameraDevice wanted;
  wanted.address = "192.168.7.20";
  EXPECT_TRUE(IsDevice(wanted, Device()));
  wanted.address = "192.168.7.2";
  EXPECT_FALSE(IsDevice(wanted, Device()));
  wanted.address = "";
  for (const char* id : {"Acme-Fieldcam-3-A1", "Acme-A1", "00:11:1c:00:12:34"}) {
    wanted.id = id;
    EXPECT_TRUE(IsDevice(wanted, Device())) << id;
  }
  wanted.id = "Acme-A2";
  EXPECT_FALSE(IsDevice(wanted, Device()));
  wanted.serial = "A1";
  EXPECT_TRUE(IsDevice(wanted, Device()));
}

TEST(DoctorCameras, PacketsThatTheInterfaceDoesNotTake) {
  CameraNetwork network = Network();
  network.interfaces[1].mtu = 1500;
  EXPECT_THAT(CheckPackets(network), ElementsAre(Says(kWarning, "600 Mbit/s at 30 Hz (assumed)",
                                                      "sudo ip link set dev eth1 mtu 9000")));
  network.cameras[0].rate.bits_per_s = 299e6;
  EXPECT_THAT(CheckPackets(network), ElementsAre(Is(kOk)));
  network.cameras[0].device.packet_bytes = 1501;
  EXPECT_THAT(CheckPackets(network), ElementsAre(Says(kProblem, "1501 bytes", "mtu 9000")));
  network.cameras[0].device.packet_bytes = 9216;
  EXPECT_THAT(CheckPackets(network), ElementsAre(Says(kProblem, "", "mtu 9216")));
}

TEST(DoctorCameras, CamerasThatOneLinkDoesNotCarry) {
  CameraNetwork network = Network();
  network.cameras.push_back(network.cameras[0]);
  network.cameras[1].name = "thermal";
  network.cameras[1].rate = {600e6, 20, false};
  EXPECT_THAT(
      CheckLinks(network),
      ElementsAre(Says(kProblem,
                       "rgb 600 Mbit/s at 30 Hz (assumed), thermal 600 Mbit/s at 20 Hz, "
                       "together 1200 Mbit/s, more than the link's 1000 Mbit/s",
                       "value: \"23.7\" }; of thermal: feature { name: \"AcquisitionFrameRate\" "
                       "value: \"15.8\" }")));
  network.cameras[1].interface = "eth2";
  EXPECT_THAT(CheckLinks(network), ElementsAre(Is(kOk)));
  network.mbit_per_s.clear();
  EXPECT_THAT(CheckLinks(network), IsEmpty()) << "the speed is unknown";
}

TEST(DoctorCameras, WhatACameraSends) {
  CameraSpec camera;
  camera.width = 1000;
  camera.height = 500;
  camera.format = PixelFormat::kMono16;
  EXPECT_EQ(RateOf(camera).hz, 0) << "not ours to serve";
  camera.device = CameraDevice();
  EXPECT_EQ(RateOf(camera).bits_per_s, 240e6);
  EXPECT_TRUE(RateOf(camera).assumed);
  camera.device->features = {{"AcquisitionFrameRate", "10"}};
  EXPECT_EQ(RateOf(camera).bits_per_s, 80e6);
  EXPECT_FALSE(RateOf(camera).assumed);
  camera.device->features = {{"AcquisitionFrameRate", "fast"}};
  EXPECT_TRUE(RateOf(camera).assumed);
  camera.device->trigger = CameraDevice::Trigger::kSoftware;
  EXPECT_EQ(RateOf(camera).hz, 0) << "waits for commands";
}

}  // namespace
}  // namespace rgbdt
