#include "services/up/rig_programs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/matchers.h"

namespace rgbdt {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

UpOptions Options() {
  UpOptions options;
  options.programs = "/programs";
  options.rig = "rig.textproto";
  options.out = "out/session";
  options.logs = "out/session.logs";
  return options;
}

std::vector<std::string> NamesOn(const std::string& host, const Rig& rig,
                                 const UpOptions& options = Options()) {
  std::vector<std::string> names;
  for (const Program& program : ProgramsOn(host, rig, ProgramsOf(rig, options))) {
    names.push_back(program.name);
  }
  return names;
}

Rig OnTwoHosts() {
  Rig rig;
  rig.hosts = {{"sensor", {"detector", "fuser"}},
               {"desk", {"solver", "session", "viewer", "logger"}}};
  return rig;
}

TEST(RigPrograms, OneMachineRunsAllWhateverItsName) {
  EXPECT_THAT(NamesOn("anything", Rig()),
              ElementsAre("detector", "solver", "fuser", "session", "viewer"));
}

TEST(RigPrograms, EachHostRunsWhatIsIts) {
  EXPECT_THAT(NamesOn("sensor", OnTwoHosts()), ElementsAre("detector", "fuser"));
  EXPECT_THAT(NamesOn("desk", OnTwoHosts()), ElementsAre("solver", "session", "viewer", "logger"));
}

TEST(RigPrograms, ADriveIsWatchedAndMappedByTheRigOfASession) {
  UpOptions options = Options();
  options.out = "out/drive";
  options.drive = "out/session";
  EXPECT_THAT(NamesOn("anything", Rig(), options),
              ElementsAre("monitor", "fuser", "odometry", "mapper", "viewer"));
  const std::vector<Program> all = ProgramsOf(Rig(), options);
  EXPECT_THAT(all[0].arguments, ElementsAre("/programs/rgbdt-monitor", "out/session"));
  EXPECT_THAT(all[3].arguments,
              ElementsAre("/programs/rgbdt-mapper", "--out", "out/drive/map.ply"));
  // A rig file that says where a session's programs run holds for the drive, too.
  EXPECT_THAT(NamesOn("sensor", OnTwoHosts(), options),
              ElementsAre("monitor", "fuser", "odometry", "mapper"));
  EXPECT_THAT(NamesOn("desk", OnTwoHosts(), options), ElementsAre("viewer", "logger"));
  Rig rig = OnTwoHosts();
  rig.hosts[1].runs.emplace_back("mapper");
  EXPECT_THAT(NamesOn("desk", rig, options), ElementsAre("mapper", "viewer", "logger"));
  EXPECT_THAT(NamesOn("desk", rig), ElementsAre("solver", "session", "viewer", "logger"));
}

TEST(RigPrograms, SpeakersAreListedByTheirRoles) {
  Rig rig;
  rig.cameras.resize(2);
  rig.cameras[0].name = "rgb";
  rig.cameras[1].name = "simulated";
  rig.cameras[0].device = CameraDevice();
  EXPECT_THAT(SpeakersOf(rig, {Role::kDriver}), ElementsAre("camera-rgb"));
  EXPECT_THAT(SpeakersOf(rig, {Role::kDrive}), ElementsAre("monitor", "odometry", "mapper"));
  // A session ends by itself.
  EXPECT_THAT(SpeakersOf(rig, {Role::kSession}), ElementsAre("detector", "solver"));
  rig.lidar.turned_scanner = TurnedScanner();
  EXPECT_THAT(SpeakersOf(rig, {Role::kBoth}), ElementsAre("assembler", "fuser", "viewer"));
}

TEST(RigPrograms, ALidarSpeaksForAsLongAsTheRigIsUpUnlessItIsARecording) {
  PacketLidarDevice recorded_packets;
  recorded_packets.pcap = "drive.pcap";
  VelodyneDevice recorded_velodyne;
  recorded_velodyne.pcap = "drive.pcap";
  Rig rig;
  EXPECT_THAT(SpeakersOf(rig, {Role::kDriver}), ElementsAre());
  const auto speaks = [&] { return !SpeakersOf(rig, {Role::kDriver}).empty(); };
  const auto ends = [&] { return ProgramsOf(rig, Options())[0].ends; };
  rig.lidar.device = HokuyoDevice();
  EXPECT_TRUE(speaks() && !ends());
  rig.lidar.device = VelodyneDevice();
  EXPECT_TRUE(speaks() && !ends());
  rig.lidar.device = PacketLidarDevice();
  EXPECT_TRUE(speaks() && !ends());
  rig.lidar.device = recorded_velodyne;
  EXPECT_TRUE(!speaks() && ends());
  rig.lidar.device = recorded_packets;
  EXPECT_TRUE(!speaks() && ends());
  rig.lidar.device = PcdFolderDevice();
  EXPECT_TRUE(!speaks() && ends());
}

TEST(RigPrograms, HostsThatDoNotFitTheRigAreNamed) {
  EXPECT_THAT(InputErrorOf([] { NamesOn("laptop", OnTwoHosts()); }),
              AllOf(HasSubstr("\"laptop\""), HasSubstr("sensor, desk"), HasSubstr("--host")));
  Rig rig = OnTwoHosts();
  rig.hosts[0].runs = {"detector"};
  EXPECT_THAT(InputErrorOf([&] { NamesOn("desk", rig); }), HasSubstr("no host runs fuser"));
  rig.hosts[0].runs = {"detector", "fuser", "camera-rgb"};
  EXPECT_THAT(InputErrorOf([&] { NamesOn("desk", rig); }),
              AllOf(HasSubstr("\"sensor\" runs \"camera-rgb\""), HasSubstr("expected some of")));
}

TEST(RigPrograms, ALoggerRunsWhereItIsAskedForAndKeepsWhatAnEarlierOneWrote) {
  UpOptions options = Options();
  options.log = "bus.lcmlog";
  options.url = "udpm://239.255.76.67:7667?ttl=1";
  const Program logger = ProgramsOf(Rig(), options).back();
  EXPECT_EQ(logger.name, "logger");
  EXPECT_THAT(logger.arguments, Contains("bus.lcmlog"));
  EXPECT_THAT(logger.arguments, Contains("-i"));
  EXPECT_THAT(logger.arguments, Contains("--lcm-url=udpm://239.255.76.67:7667?ttl=1"));
  EXPECT_FALSE(logger.speaks);
  EXPECT_THAT(ProgramsOf(OnTwoHosts(), Options()).back().arguments, Contains("out/session.lcmlog"));
  // Where no host of the rig has one, on the machine where it was asked for.
  Rig rig = OnTwoHosts();
  rig.hosts[1].runs.pop_back();
  EXPECT_THAT(NamesOn("sensor", rig, options), ElementsAre("detector", "fuser", "logger"));
}

}  // namespace
}  // namespace rgbdt
