#include "calib/methods/detect_session.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "calib/methods/calibrate.h"
#include "calib/simulate/internal/cloud_world.h"
#include "tests/simulated_variants.h"
#include "tests/unit/files/test_data.h"

namespace rgbdt {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::Field;
using ::testing::HasSubstr;

/// A session of one view that can be read, named over and over, and of folders of nothing.
class ManyViews : public ::testing::Test {
 protected:
  SessionDetection Detect(int readable, int unreadable) {
    WriteRig(dir_.path(), test::MakeRig());
    View view = test::MakeView();
    view.name = "1";
    WriteView(dir_.path(), view);
    const auto views = dir_ / "views";
    for (int i = 2; i <= readable; ++i) {
      std::filesystem::create_directory_symlink(views / "1", views / std::to_string(i));
    }
    for (int i = 1; i <= unreadable; ++i) {
      std::filesystem::create_directory(views / std::to_string(readable + i));
    }
    session_ = OpenSession(dir_.path());
    return DetectSession(session_, kPlaneMethod, [](const std::string&) {});
  }

  static std::ptrdiff_t Unread(const SessionDetection& detection) {
    return std::count_if(
        detection.views.begin(), detection.views.end(), [](const ViewDetection& view) {
          return view.cloud.why_not.find("view.textproto is missing") != std::string::npos;
        });
  }

  test::TempDir dir_;
  Session session_;
};

TEST_F(ManyViews, OfFewThatCannotBeReadAllAreListed) {
  const SessionDetection detection = Detect(1, 100);
  EXPECT_EQ(detection.unreadable.size(), 100u);
  EXPECT_EQ(detection.views.size(), 101u);
  EXPECT_EQ(ListedOnly(session_, detection.views).views, session_.views);
  Report report;
  report.cameras.resize(1);
  EXPECT_TRUE(WithUnlisted(report, session_, detection.views).cameras[0].warnings.empty());
}

TEST_F(ManyViews, OfVeryManyTheFirstAreListedAndTheOthersCounted) {
  const SessionDetection detection = Detect(1, 150);
  EXPECT_EQ(detection.unreadable.size(), 150u);
  EXPECT_EQ(Unread(detection), 100);
  EXPECT_EQ(detection.views.size(), 101u);
  const Session listed = ListedOnly(session_, detection.views);
  EXPECT_EQ(listed.views,
            std::vector<std::string>(session_.views.begin(), session_.views.begin() + 101));
  Report report;
  report.cameras.resize(2);
  report = WithUnlisted(std::move(report), session_, detection.views);
  report = WithUnlisted(std::move(report), session_, detection.views);  // is said once
  EXPECT_THAT(report.cameras,
              Each(Field(&CameraReport::warnings, ElementsAre(HasSubstr("50 more")))));
}

// So that a report in which most views are missing says so, however many they are.
TEST_F(ManyViews, AsManyAreListedAsCouldBeRead) {
  const SessionDetection detection = Detect(120, 150);
  EXPECT_EQ(detection.views.size(), 240u);
  EXPECT_EQ(Unread(detection), 120);
}

TEST(RingNumbersOfASession, ThatSayNothingAreAWarning) {
  simulate::Options physics;
  simulate::UseLidar(16, &physics);
  View view = test::MakeView();
  view.cloud =
      simulate::Unorganised(simulate::CloudWorld(physics, 0).Sweep(view.cloud.sweep_utime), true);
  for (const bool right : {true, false}) {
    if (!right) std::fill(view.cloud.ring.begin(), view.cloud.ring.end(), std::uint16_t{0});
    const test::TempDir dir;
    WriteRig(dir.path(), test::MakeRig());
    WriteView(dir.path(), view);
    std::vector<std::string> lines;
    const SessionDetection detection =
        DetectSession(OpenSession(dir.path()), kAutoMethod,
                      [&](const std::string& line) { lines.push_back(line); });
    ASSERT_THAT(detection.unreadable, ::testing::IsEmpty());
    ASSERT_EQ(lines.size(), right ? 1U : 2U);
    if (!right) {
      EXPECT_THAT(lines[1], HasSubstr("warning: the ring numbers of 1 clouds are not those"));
    }
  }
}

}  // namespace
}  // namespace rgbdt
