#include "calib/files/schema/session_script.h"

#include "calib/files/atomic_file.h"
#include "calib/files/session/session_dir.h"
#include "tests/unit/files/test_data.h"

namespace rgbdt {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using Kind = SessionStep::Kind;

class Script : public ::testing::Test {
 protected:
  Script() { WriteRig(dir_.path(), test::MakeRig()); }

  SessionScript Read(const std::string& steps) const {
    WriteFileAtomically(dir_ / "s.textproto", "name: \"s\"\nrig: \"rig.textproto\"\n" + steps);
    return ReadSessionScript(dir_ / "s.textproto");
  }

  std::string ErrorOf(const std::string& steps) const {
    return test::ErrorOf([&] { Read(steps); });
  }

  test::TempDir dir_;
};

TEST_F(Script, HoldsItsSteps) {
  const SessionScript script = Read(
      "step { next_pose {} timeout_s: 5 }\nstep { sweep {} }\n"
      "step { capture { heldout: true picked_camera: \"thermal\" } }\n"
      "step { wait { seconds: 1.5 } }\nstep { solve {} }\nstep { evaluate {} }\nstep { save {} }");
  EXPECT_EQ(script.name, "s");
  EXPECT_EQ(script.rig, dir_ / "rig.textproto");
  std::vector<Kind> kinds;
  for (const SessionStep& step : script.steps) kinds.push_back(step.kind);
  EXPECT_THAT(kinds, ElementsAre(Kind::kNextPose, Kind::kSweep, Kind::kCapture, Kind::kWait,
                                 Kind::kSolve, Kind::kEvaluate, Kind::kSave));
  EXPECT_EQ(script.steps[0].timeout_s, 5);
  EXPECT_EQ(script.steps[1].timeout_s, 60);
  EXPECT_TRUE(script.steps[2].heldout);
  EXPECT_THAT(script.steps[2].picked_cameras, ElementsAre("thermal"));
  EXPECT_EQ(script.steps[3].wait_s, 1.5);
}

TEST_F(Script, ErrorsNameLineAndStep) {
  EXPECT_THAT(ErrorOf("step { next_pose {} }\nstep { }\n"),
              HasSubstr("s.textproto:4: step 2 is empty"));
  EXPECT_THAT(ErrorOf("step { sweep {} timeout_s: -1 }"), HasSubstr("step 1 has timeout_s -1"));
  EXPECT_THAT(ErrorOf("step { wait { seconds: -3 } }"), HasSubstr("step 1 has wait.seconds -3"));
  EXPECT_THAT(ErrorOf("step { wait { seconds: nan } }"), HasSubstr("step 1"));
  EXPECT_THAT(ErrorOf("step { wait { seconds: 1e300 } }"), HasSubstr("a week at most"));
  EXPECT_THAT(ErrorOf("step { capture {} }"), HasSubstr("step 1 captures"));
  EXPECT_THAT(ErrorOf("step { sweep {} }\nstep { next_pose {} }\nstep { capture {} }"),
              HasSubstr("step 3 captures"));
  EXPECT_THAT(ErrorOf("step { solve {} }"), HasSubstr("step 1 solves"));
  EXPECT_THAT(ErrorOf("step { sweep {} } step { capture {} } step { evaluate {} }"),
              HasSubstr("step 3 evaluates"));
  EXPECT_THAT(ErrorOf("step { sweep {} }\nstep { capture { picked_camera: \"thermo\" } }"),
              HasSubstr("s.textproto:4: step 2 picked_camera: the rig has no camera \"thermo\""));
  EXPECT_THAT(ErrorOf("step { swep {} }"), HasSubstr("s.textproto:3:"));
  EXPECT_THAT(ErrorOf(""), HasSubstr("step is missing"));
}

TEST_F(Script, TheRigMustBeThere) {
  WriteFileAtomically(dir_ / "s.textproto", "\nrig: \"none.textproto\"\nstep { sweep {} }");
  const std::string error = test::ErrorOf([&] { ReadSessionScript(dir_ / "s.textproto"); });
  EXPECT_THAT(error, HasSubstr("s.textproto:2: rig: "));
  EXPECT_THAT(error, HasSubstr("none.textproto"));
  EXPECT_EQ(ReadSessionScript(dir_ / "s.textproto", dir_ / "rig.textproto").rig,
            dir_ / "rig.textproto");
  WriteFileAtomically(dir_ / "s.textproto", "step { sweep {} }");
  EXPECT_THAT(test::ErrorOf([&] { ReadSessionScript(dir_ / "s.textproto"); }),
              HasSubstr("rig is missing"));
}

TEST_F(Script, EveryShippedScriptLoads) {
  int count = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::string(RGBDT_SOURCE_DIR) + "/scripts/sessions")) {
    EXPECT_NO_THROW(ReadSessionScript(entry.path(), dir_ / "rig.textproto")) << entry.path();
    ++count;
  }
  EXPECT_GT(count, 0);
}

TEST_F(Script, TheDemoHoldsOutEveryThirdOfTwelveViews) {
  const SessionScript script =
      ReadSessionScript(std::string(RGBDT_SOURCE_DIR) + "/scripts/sessions/demo.session.textproto",
                        dir_ / "rig.textproto");
  std::vector<bool> heldout;
  for (const SessionStep& step : script.steps) {
    if (step.kind != Kind::kCapture) continue;
    heldout.push_back(step.heldout);
    EXPECT_THAT(step.picked_cameras, ElementsAre("thermal"));
  }
  ASSERT_EQ(heldout.size(), 12u);
  for (std::size_t i = 0; i < 12; ++i) EXPECT_EQ(heldout[i], i % 3 == 2);
  EXPECT_EQ(script.steps.back().kind, Kind::kSave);
}

TEST_F(Script, DamagedTextNeverCrashes) {
  const std::string text =
      "name: \"s\"\nrig: \"rig.textproto\"\nstep { next_pose {} timeout_s: 5 }\n"
      "step { sweep {} }\nstep { capture { heldout: true picked_camera: \"thermal\" } }\n";
  const auto parse = [&](const std::string& damaged) {
    test::WriteQuickly(dir_ / "s.textproto", damaged);
    ReadSessionScript(dir_ / "s.textproto");
  };
  test::ParseTruncations(text, parse, 100);
  test::ParseDamaged(text, parse, 50);
}

}  // namespace
}  // namespace rgbdt
