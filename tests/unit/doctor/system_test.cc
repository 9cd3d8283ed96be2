#include "services/doctor/system.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <fstream>

#include "services/doctor/facts.h"

namespace rgbdt {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

// A tree that the kernel could have written.
class DoctorSystem : public ::testing::Test {
 protected:
  DoctorSystem() {
    std::string name = (fs::temp_directory_path() / "rgbdt-doctor-XXXXXX").string();
    root_ = mkdtemp(name.data());
    roots_ = {root_ / "proc", root_ / "sys", root_};
    fs::create_directories(roots_.proc);
  }
  ~DoctorSystem() override { fs::remove_all(root_); }

  void Write(const std::string& file, const std::string& text) {
    fs::create_directories((root_ / file).parent_path());
    std::ofstream(root_ / file) << text;
  }
  void Link(const std::string& file, const std::string& target) {
    fs::create_directories((root_ / file).parent_path());
    fs::create_symlink(target, root_ / file);
  }

  fs::path root_;
  SystemRoots roots_;
};

TEST_F(DoctorSystem, NamesWhoHasSomethingOpen) {
  Write("proc/1200/comm", "screen\n");
  Link("proc/1200/fd/0", "/dev/pts/3");
  Link("proc/1200/fd/5", "/dev/ttyUSB0");
  Write("proc/300/comm", "rgbdt-motor\n");
  Link("proc/300/fd/7", "/dev/ttyUSB0");
  Write("proc/400/comm", "other\n");
  Link("proc/400/fd/7", "/dev/ttyUSB1");
  const std::string own = "proc/" + std::to_string(getpid());
  Link(own + "/fd/3", "/dev/ttyUSB0");
  Link("proc/self/fd/3", "/dev/ttyUSB0");
  EXPECT_EQ(HoldersText(HoldersOf(roots_, {"/dev/ttyUSB0"})),
            "rgbdt-motor (pid 300), screen (pid 1200)");
  EXPECT_THAT(HoldersOf(roots_, {"/dev/ttyUSB2"}), IsEmpty());
}

TEST_F(DoctorSystem, FindsAUdpPortsHolder) {
  const std::string head = "   sl  local_address rem_address   st tx_queue rx_queue tr\n";
  const std::string tail = " 00000000:0000 07 00000000:00000000 00:00000000 00000000  0 0 ";
  Write("proc/net/udp", head + "  10: 00000000:0940" + tail + "555 2 0000 0\n  11: 00000000:0941" +
                            tail + "556 2 0000 0\n");
  Write("proc/net/udp6", head + "  10: 00000000000000000000000000000000:0940 " +
                             "00000000000000000000000000000000:0000" + tail.substr(14) + "557\n");
  for (const char* inode : {"555", "556", "557"}) {
    const std::string process = std::string("proc/") + inode;
    Write(process + "/comm", std::string("p") + inode);
    Link(process + "/fd/3", std::string("socket:[") + inode + "]");
  }
  EXPECT_EQ(HoldersText(HoldersOfUdpPort(roots_, 2368)), "p555 (pid 555), p557 (pid 557)");
  EXPECT_THAT(HoldersOfUdpPort(roots_, 2370), IsEmpty());
}

TEST_F(DoctorSystem, ProcessesOfAnotherNetworkAreNotOurs) {
  Link("proc/self/ns/net", "net:[1]");
  for (const char* pid : {"21", "22", "23"}) {
    Write(std::string("proc/") + pid + "/comm", "rgbdt-camera");
  }
  Link("proc/21/ns/net", "net:[1]");
  Link("proc/22/ns/net", "net:[2]");
  EXPECT_EQ(HoldersText(ProcessesNamed(roots_, {"arv-viewer", "rgbdt-cam"})),
            "rgbdt-camera (pid 21), rgbdt-camera (pid 23)");
}

TEST_F(DoctorSystem, ReadsALinksSpeed) {
  Write("sys/class/net/eth1/ifindex", "3\n");
  EXPECT_FALSE(LinkSpeed(roots_, "eth1", 3)) << "the driver does not tell";
  Write("sys/class/net/eth1/speed", "1000\n");
  EXPECT_EQ(LinkSpeed(roots_, "eth1", 3), 1000);
  EXPECT_FALSE(LinkSpeed(roots_, "eth1", 4)) << "another namespace's";
  EXPECT_FALSE(LinkSpeed(roots_, "eth2", 3));
  Write("sys/class/net/eth1/speed", "-1\n");
  EXPECT_FALSE(LinkSpeed(roots_, "eth1", 3)) << "no cable";
}

TEST_F(DoctorSystem, ReadsTheRest) {
  Write("sys/bus/usb/devices/1-2/serial", "U3V1\n");
  Write("sys/bus/usb/devices/1-0:1.0/bInterfaceClass", "09\n");
  EXPECT_THAT(UsbSerials(roots_), ElementsAre("U3V1"));
  EXPECT_EQ(ReversePathFilter(roots_, "eth1"), 0);
  Write("proc/sys/net/ipv4/conf/all/rp_filter", "1\n");
  Write("proc/sys/net/ipv4/conf/eth1/rp_filter", "2\n");
  EXPECT_EQ(ReversePathFilter(roots_, "eth1"), 2);
  EXPECT_FALSE(InContainer(roots_));
  Write("run/systemd/container", "lxc");
  EXPECT_TRUE(InContainer(roots_));
}

TEST_F(DoctorSystem, TheBufferIsTheSmallerOfWhatIsSaidAndWhatIsGranted) {
  const std::int64_t granted = GatherBuffer(roots_).largest;
  EXPECT_GT(granted, 0);
  Write("proc/sys/net/core/rmem_max", "1000\n");
  EXPECT_EQ(GatherBuffer(roots_).largest, 1000);
  Write("proc/sys/net/core/rmem_max", "99999999999\n");
  EXPECT_EQ(GatherBuffer(roots_).largest, granted);
}

}  // namespace
}  // namespace rgbdt
