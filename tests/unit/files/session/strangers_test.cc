// Sessions that a stranger made: what they hold is told in one line, costs little, and nothing
// outside their folder is changed.
#include <algorithm>
#include <fstream>

#include "calib/files/atomic_file.h"
#include "calib/files/schema/calibration_file.h"
#include "calib/files/session/session_dir.h"
#include "calib/model/printable.h"
#include "tests/unit/files/test_data.h"

namespace rgbdt {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;

class StrangersSession : public ::testing::Test {
 protected:
  StrangersSession() {
    WriteRig(dir(), test::MakeRig());
    View view = test::MakeView();
    view.name = "0001";
    WriteView(dir(), view);
  }

  fs::path dir() const { return folder_ / "session"; }
  fs::path ViewFile(const std::string& name) const { return dir() / "views/0001" / name; }
  std::string ErrorOfView() const {
    return test::ErrorOf([&] { ReadView(OpenSession(dir()), "0001"); });
  }

  test::TempDir folder_;
};

TEST_F(StrangersSession, EmptyFilesAreNamed) {
  for (const std::string name : {"cloud.pcd", "rgb.png", "view.textproto"}) {
    const std::string kept = ReadWholeFile(ViewFile(name));
    test::WriteQuickly(ViewFile(name), "");
    EXPECT_THAT(ErrorOfView(), HasSubstr(name));
    test::WriteQuickly(ViewFile(name), kept);
  }
  test::WriteQuickly(dir() / "rig.textproto", "");
  EXPECT_THAT(ErrorOfView(), HasSubstr("rig.textproto"));
}

// They take no room on the disk, and would take all memory.
TEST_F(StrangersSession, FilesOfTenGigabytesAreRefusedUnread) {
  constexpr std::uintmax_t kSize = 10'000'000'000;
  for (const std::string name : {"rgb.png", "view.textproto"}) {
    const std::string kept = ReadWholeFile(ViewFile(name));
    fs::resize_file(ViewFile(name), kSize);
    EXPECT_THAT(ErrorOfView(), AllOf(HasSubstr(name), HasSubstr("has 10000000000 bytes")));
    test::WriteQuickly(ViewFile(name), kept);
  }
  fs::resize_file(ViewFile("cloud.pcd"), kSize);
  EXPECT_THAT(ErrorOfView(), AllOf(HasSubstr("cloud.pcd"), HasSubstr("has 10000000000 bytes")));
  fs::resize_file(dir() / "rig.textproto", kSize);
  EXPECT_THAT(ErrorOfView(), AllOf(HasSubstr("rig.textproto"), HasSubstr("10000000000 bytes")));
}

TEST_F(StrangersSession, WhatIsNoRegularFileIsRefused) {
  fs::remove(ViewFile("rgb.png"));
  fs::create_symlink("/dev/zero", ViewFile("rgb.png"));
  EXPECT_THAT(ErrorOfView(), HasSubstr("expected a file"));
  fs::remove(ViewFile("rgb.png"));
  fs::create_symlink("rgb.png", ViewFile("rgb.png"));
  EXPECT_THAT(ErrorOfView(), HasSubstr("rgb.png"));
}

// A result takes a link's place; what the link leads to stays as it is.
TEST_F(StrangersSession, LinksThatLeadOutAreNotWrittenThrough) {
  const fs::path outside = folder_ / "precious";
  test::WriteQuickly(outside, "precious");
  for (const std::string name : {"calibration.textproto", "report.json", "rig.textproto"}) {
    fs::remove(dir() / name);
    fs::create_symlink(outside, dir() / name);
  }
  SetResultsAside(dir());
  EXPECT_TRUE(fs::is_symlink(dir() / "calibration.previous.textproto"));
  WriteCalibration(dir() / "calibration.textproto", test::MakeReport().ToCalibration());
  fs::create_symlink(outside, dir() / "report.json");
  SetResultsAside(dir());
  WriteRig(dir(), test::MakeRig());
  EXPECT_FALSE(fs::is_symlink(dir() / "rig.textproto"));
  EXPECT_EQ(ReadWholeFile(outside), "precious");
}

TEST_F(StrangersSession, FoldersThatAreLinksAreNotWrittenTo) {
  const fs::path outside = folder_ / "outside";
  View view = test::MakeView();
  view.name = "0001";
  const ViewFiles named{"0001", ViewFile("cloud.pcd"), 0, {}};
  for (const fs::path& link : {dir() / "views/0001", dir() / "views"}) {
    fs::rename(link, outside);
    fs::create_directory_symlink(outside, link);
    const fs::path cloud = outside / (link.filename() == "views" ? "0001/cloud.pcd" : "cloud.pcd");
    test::WriteQuickly(cloud, "precious");
    EXPECT_THAT(test::ErrorOf([&] { WriteView(dir(), view); }),
                AllOf(HasSubstr(link.string()), HasSubstr("symbolic link")));
    EXPECT_THAT(test::ErrorOf([&] { WriteView(dir(), named); }), HasSubstr("symbolic link"));
    if (link.filename() == "views") {
      EXPECT_THAT(test::ErrorOf([&] { SetViewAside(dir(), "0001"); }), HasSubstr("symbolic link"));
    }
    EXPECT_EQ(ReadWholeFile(cloud), "precious");
    fs::remove(link);
    fs::create_directory_symlink(folder_ / "nowhere", link);  // would be made
    EXPECT_THAT(test::ErrorOf([&] { WriteView(dir(), view); }), HasSubstr("symbolic link"));
    EXPECT_FALSE(fs::exists(folder_ / "nowhere"));
    fs::remove(link);
    fs::rename(outside, link);
  }
}

TEST_F(StrangersSession, NamesMayBeOfAnyScript) {
  const std::string name = "\xd0\xb2\xd0\xb8\xd0\xb4 \xe8\xa6\x96\xe9\x87\x8e \xf0\x9f\x8c\xa1";
  fs::rename(dir() / "views/0001", dir() / "views" / name);
  const Session session = OpenSession(dir());
  EXPECT_THAT(session.views, ::testing::ElementsAre(name));
  EXPECT_EQ(ReadView(session, name).name, name);
}

TEST_F(StrangersSession, NamesThatMoveACursorOrTurnTextAboutAreNoNames) {
  View view = test::MakeView();
  for (const std::string bad : {"\x1b[2J", "\x7f", "\u009b2J", "\u2028", "\u202egnp", "\xff"}) {
    fs::rename(dir() / "views/0001", dir() / "views" / bad);
    const std::string error = test::ErrorOf([&] { OpenSession(dir()); });
    EXPECT_THAT(error, HasSubstr("rename its folder"));
    EXPECT_TRUE(IsPrintable(error)) << error;
    fs::rename(dir() / "views" / bad, dir() / "views/0001");
    view.name = bad;
    EXPECT_THAT(test::ErrorOf([&] { WriteView(dir(), view); }),
                HasSubstr("cannot be a file's name"));
  }
}

// Of rigs the first LIDAR's and a machine's name are any text, and errors tell what they quote.
TEST_F(StrangersSession, TextsThatMoveACursorAreRefusedWhereTheyStand) {
  WriteCalibration(dir() / "calibration.textproto", test::MakeReport().ToCalibration());
  for (const std::string name :
       {"rig.textproto", "calibration.textproto", "views/0001/view.textproto"}) {
    const std::string kept = ReadWholeFile(dir() / name);
    for (std::size_t at = kept.find(": \""); at != std::string::npos; at = kept.find(": \"", at)) {
      at += 3;
      for (const std::string bad : {"\\033[2J", "\\n", "\xe2\x80\xae"}) {
        std::string text = kept;
        test::WriteQuickly(dir() / name, text.insert(at, bad));
        const std::string error = test::ErrorOf([&] {
          ReadView(OpenSession(dir()), "0001");
          ReadCalibration(dir() / "calibration.textproto");
        });
        const auto line = std::count(kept.begin(), kept.begin() + static_cast<long>(at), '\n') + 1;
        EXPECT_THAT(error, AllOf(HasSubstr(name + ":" + std::to_string(line) + ": "),
                                 HasSubstr("control character")));
        EXPECT_TRUE(IsPrintable(error)) << error;
      }
    }
    test::WriteQuickly(dir() / name, kept);
  }
}

TEST_F(StrangersSession, ManyViewsAreListedButNotTold) {
  constexpr int kViews = 5'000;
  for (int i = 2; i <= kViews; ++i) fs::create_directory(dir() / "views" / std::to_string(i));
  const Session session = OpenSession(dir());
  EXPECT_EQ(session.views.size(), static_cast<std::size_t>(kViews));
  EXPECT_EQ(session.views.back(), "5000");
  EXPECT_EQ(ReadView(session, "0001").name, "0001");
  const std::string error = test::ErrorOf([&] { ReadView(session, "none"); });
  EXPECT_THAT(error, HasSubstr("no view \"none\""));
  EXPECT_LT(error.size(), 2000U) << "the names of all of them";
}

}  // namespace
}  // namespace rgbdt
