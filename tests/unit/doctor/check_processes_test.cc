#include <gmock/gmock.h>

#include "tests/unit/doctor/doctor_testing.h"

namespace rgbdt {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

ProcessFacts Process(const std::string& name, const std::string& text) {
  ProcessFacts process;
  process.first.process = name;
  process.first.ready = true;
  process.first.text = text;
  process.last = process.first;
  process.heard = 3;
  return process;
}

BusFacts Bus(std::vector<ProcessFacts> processes) {
  BusFacts facts;
  facts.seconds = 3;
  facts.processes = std::move(processes);
  return facts;
}

TEST(DoctorProcesses, NobodySpeaksBeforeTheRigIsStarted) {
  EXPECT_THAT(CheckProcesses(Bus({}), {"detector"}),
              ElementsAre(Says(kOk, "none speaks on the bus (listened for 3 s)", "")));
}

TEST(DoctorProcesses, WhatEachDoesAndWhichIsSilent) {
  const BusFacts facts = Bus({Process("fuser", "20 clouds"), Process("solver", "3 views")});
  EXPECT_THAT(CheckProcesses(facts, {"fuser", "solver"}),
              ElementsAre(Says(kOk, "20 clouds", ""), Says(kOk, "3 views", "")));
  EXPECT_THAT(
      CheckProcesses(facts, {"detector", "fuser", "viewer"}),
      ElementsAre(Is(kOk), Is(kOk), Says(kWarning, "detector, viewer", "start what is missing")));
}

TEST(DoctorProcesses, WhatWaits) {
  ProcessFacts waits = Process("fuser", "waits for CALIBRATION");
  waits.last.ready = false;
  EXPECT_THAT(CheckProcesses(Bus({waits}), {}),
              ElementsAre(Says(kWarning, "waits for CALIBRATION", "")));
}

TEST(DoctorProcesses, LossesCountWhileItListens) {
  ProcessFacts loses = Process("fuser", "20 clouds");
  loses.first.counters = loses.last.counters = {
      {"received", 100}, {"dropped", 3}, {"dropped CLOUD", 3}, {"gaps RGB_IMAGE", 7}};
  EXPECT_THAT(CheckProcesses(Bus({loses}), {}), ElementsAre(Is(kOk)));
  loses.last.counters[0].second = 150;
  loses.last.counters[3].second = 9;
  loses.last.counters.emplace_back("unsigned", 4);
  loses.last.last_problem = "ignored: RIG is not signed";
  EXPECT_THAT(
      CheckProcesses(Bus({loses}), {}),
      ElementsAre(::testing::AllOf(
          Says(kWarning,
               "within 3 s: gaps RGB_IMAGE 2, unsigned 4; its newest problem: "
               "ignored: RIG is not signed",
               "uptime"),
          Says(kWarning, "", ""), ::testing::Field(&Finding::what, Not(HasSubstr("dropped"))))));
}

TEST(DoctorProcesses, TwoOfOneName) {
  ProcessFacts twice = Process("session", "step 2 of 9");
  twice.fell_back = 1;  // it was started anew
  EXPECT_THAT(CheckProcesses(Bus({twice}), {}), ElementsAre(Is(kOk)));
  twice.fell_back = 2;
  EXPECT_THAT(CheckProcesses(Bus({twice}), {}),
              ElementsAre(Says(kProblem, "two programs of this name", "bus of its own")));
}

TEST(DoctorProcesses, WhatAStrangerCallsItselfKeepsToItsLine) {
  const ProcessFacts stranger = Process("a\nok       b", "c\nd");
  for (const Finding& finding : CheckProcesses(Bus({stranger}), {})) {
    EXPECT_THAT(finding.check + finding.what, Not(HasSubstr("\n")));
  }
}

TEST(DoctorProcesses, ClocksLinksAndStrangers) {
  BusFacts facts = Bus({Process("fuser", "20 clouds")});
  facts.links.clocks = {{"here", 0}, {"compute (10.0.0.3)", 1000}, {"sensor (10.0.0.2)", -200000}};
  facts.links.datagrams_lost = 17;
  facts.links.worst = "sensor (10.0.0.2): 17 of 2000";
  facts.malformed = {2, "10.0.0.9:40000: no LCM message"};
  EXPECT_THAT(CheckProcesses(facts, {}),
              ElementsAre(Is(kOk), Says(kWarning, "clock of host sensor (10.0.0.2) is 0.2", ""),
                          Says(kWarning, "sensor (10.0.0.2): 17 of 2000", "ip -s link"),
                          Says(kWarning, "10.0.0.9:40000", "LCM_DEFAULT_URL")));
}

}  // namespace
}  // namespace rgbdt
