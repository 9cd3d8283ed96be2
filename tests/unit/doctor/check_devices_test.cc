#include <gmock/gmock.h>

#include <cerrno>

#include "tests/unit/doctor/doctor_testing.h"

namespace rgbdt {
namespace {

SerialFacts GoodSerial() {
  SerialFacts facts;
  facts.port = "/dev/ttyUSB0";
  facts.is_tty = true;
  facts.group = "dialout";
  facts.group_may = true;
  return facts;
}

TEST(DoctorDevices, ASerialPortWithoutPermission) {
  EXPECT_THAT(CheckSerial(GoodSerial()), Is(kOk));
  SerialFacts facts = GoodSerial();
  facts.access_error = EACCES;
  EXPECT_THAT(CheckSerial(facts),
              Says(kProblem, "members of dialout", "sudo usermod -aG dialout $USER"));
  facts.group = "uucp";
  EXPECT_THAT(CheckSerial(facts), Says(kProblem, "group uucp", "sudo usermod -aG uucp $USER"));
  facts.group_may = false;
  EXPECT_THAT(CheckSerial(facts),
              Says(kProblem, "nor has any group", "sudo chgrp dialout /dev/ttyUSB0; "));
}

TEST(DoctorDevices, ASerialPortThatIsNotThere) {
  SerialFacts facts;
  facts.port = "/dev/ttyUSB0";
  facts.access_error = ENOENT;
  EXPECT_THAT(CheckSerial(facts), Says(kProblem, "no USB serial port at all", "dmesg"));
  facts.others = {"/dev/ttyUSB1", "/dev/ttyACM0"};
  EXPECT_THAT(CheckSerial(facts), Says(kProblem, "there is /dev/ttyUSB1, /dev/ttyACM0", ""));
  facts.access_error = 0;
  EXPECT_THAT(CheckSerial(facts), Says(kProblem, "is no serial port", "ls -l"));
}

TEST(DoctorDevices, ASerialPortInUse) {
  SerialFacts facts = GoodSerial();
  facts.holders = {{12, "screen"}, {14, "rgbdt-motor"}};
  EXPECT_THAT(CheckSerial(facts),
              Says(kProblem, "screen (pid 12), rgbdt-motor (pid 14)", "kill 12 14"));
  facts.holders = {{14, "rgbdt-motor"}};
  EXPECT_THAT(CheckSerial(facts), Says(kWarning, "rgbdt-motor (pid 14)", "kill 14"));
  facts.holders = {};
  facts.open_error = EBUSY;
  EXPECT_THAT(CheckSerial(facts), Says(kProblem, "another user", "sudo fuser -v /dev/ttyUSB0"));
  facts.open_error = EIO;
  EXPECT_THAT(CheckSerial(facts), Says(kProblem, "Input/output", "dmesg"));
}

TEST(DoctorDevices, AUdpPortInUse) {
  PortFacts facts{2368, "Velodyne", 0, {}};
  EXPECT_THAT(CheckPort(facts), Is(kOk));
  facts.error = EADDRINUSE;
  const std::string command = "sudo ss -ulpn 'sport = :2368'";
  EXPECT_THAT(CheckPort(facts), Says(kProblem, "another user", command));
  facts.holders = {{5, "vlp"}};
  EXPECT_THAT(CheckPort(facts), Says(kProblem, "vlp (pid 5)", command));
  facts.holders = {{5, "rgbdt-lidar"}};
  EXPECT_THAT(CheckPort(facts), Says(kWarning, "rgbdt-lidar (pid 5)", command));
  facts.error = EACCES;
  EXPECT_THAT(CheckPort(facts), Says(kProblem, "Permission denied", command));
}

TEST(DoctorDevices, AHokuyoThatIsNotReached) {
  HokuyoFacts facts;
  facts.device.address = "192.168.0.10";
  facts.on_link = true;
  facts.interface = "eth1";
  EXPECT_THAT(CheckHokuyo(facts), Is(kOk));
  facts.answer = TcpAnswer::kRefused;
  EXPECT_THAT(CheckHokuyo(facts), Says(kProblem, "refuses port 10940", "ip neigh show 192.168"));
  facts.answer = TcpAnswer::kTimedOut;
  EXPECT_THAT(CheckHokuyo(facts), Says(kProblem, "nobody answers", "ip -br link show eth1"));
  facts.answer = TcpAnswer::kBadAddress;
  EXPECT_THAT(CheckHokuyo(facts), Says(kProblem, "no address", "192.168.0.10"));
  facts.answer = TcpAnswer::kUnreachable;
  EXPECT_THAT(CheckHokuyo(facts), Says(kProblem, "nobody answers", "ping -c 1 192.168.0.10"));
  facts.on_link = false;
  EXPECT_THAT(CheckHokuyo(facts),
              Says(kProblem, "out of reach", "sudo ip addr add 192.168.0.100/24 dev eth1"));
  facts.device.address = "192.168.0.100";
  EXPECT_THAT(CheckHokuyo(facts), Says(kProblem, "", "192.168.0.101/24")) << "not its own";
}

}  // namespace
}  // namespace rgbdt
