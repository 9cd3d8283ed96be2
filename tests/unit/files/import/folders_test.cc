#include "calib/files/import/folders.h"

#include "calib/files/atomic_file.h"
#include "calib/files/image_files.h"
#include "calib/files/points/cloud_files.h"
#include "calib/model/printable.h"
#include "tests/unit/files/test_data.h"

namespace rgbdt {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

/// Folders "a" (colour), "b" (16 bits) and "clouds" of three views each, and what they are read
/// with.
class FoldersTest : public ::testing::Test {
 protected:
  FoldersTest() {
    for (const char* name : {"p1", "p2", "p3"}) {
      Image("a", name, CV_8UC3);
      Image("b", name, CV_16UC1, {20, 16});
      WritePcd(dir_ / ("clouds/" + std::string(name) + ".pcd"), test::MakeCloud());
    }
    folders_.cameras = {{"", dir_ / "a"}};
    folders_.lidars = {{"", dir_ / "clouds"}};
    folders_.board.squares_x = 8;
    folders_.board.squares_y = 6;
    folders_.board.square_m = 0.1;
    folders_.board.width_m = 1;
    folders_.board.height_m = 0.8;
    folders_.model = Lens::Model::kPinhole;
  }

  void Image(const std::string& folder, const std::string& name, int type,
             cv::Size size = {40, 30}) const {
    WritePng(dir_ / (folder + "/" + name + ".png"), cv::Mat(size, type, cv::Scalar::all(7)));
  }
  void Lens(const std::string& name, int width, int height) const {
    test::WriteQuickly(dir_ / name,
                       "K: [30, 0, 10, 0, 30, 8, 0, 0, 1]\nD: [0, 0, 0, 0, 0]\nwidth: " +
                           std::to_string(width) + "\nheight: " + std::to_string(height) + "\n");
  }
  std::string Error() const {
    return test::ErrorOf([&] { ReadFolders(folders_); });
  }

  test::TempDir dir_;
  Folders folders_;
};

std::vector<std::string> CamerasOf(const Rig& rig) {
  std::vector<std::string> names;
  for (const CameraSpec& camera : rig.cameras) names.push_back(camera.name);
  return names;
}

TEST_F(FoldersTest, MakeASessionThatReadsBack) {
  folders_.cameras.push_back({"", dir_ / "b"});
  Lens("a.yaml", 40, 30);
  Lens("b.yaml", 20, 16);
  folders_.lenses = {{"thermal", dir_ / "b.yaml", ""}, {"", dir_ / "a.yaml", ""}};
  const FolderSession made = ReadFolders(folders_);
  EXPECT_THAT(made.WithoutLens(), IsEmpty());
  EXPECT_THAT(made.left_over, IsEmpty());
  WriteSession(dir_ / "out", made);

  const Session session = OpenSession(dir_ / "out");
  EXPECT_THAT(CamerasOf(session.rig), ElementsAre("rgb", "thermal"));
  EXPECT_EQ(session.rig.cameras[1].kind, CameraKind::kThermal);
  EXPECT_EQ(session.rig.cameras[1].format, PixelFormat::kMono16);
  EXPECT_THAT(session.views, ElementsAre("p1", "p2", "p3"));
  const View view = ReadView(session, "p3");
  EXPECT_TRUE(view.heldout);  // every third
  EXPECT_EQ(view.images.size(), 2u);
  EXPECT_EQ(view.cloud.size(), test::MakeCloud().size());
  EXPECT_FALSE(fs::exists(dir_ / "out/views/p3/cloud.pcd"));

  EXPECT_THAT(test::ErrorOf([&] { WriteSession(dir_ / "out", made); }),
              HasSubstr("earlier session"));
  fs::remove_all(dir_ / "out/views");
  EXPECT_THAT(test::ErrorOf([&] { RequireRoomForSession(dir_ / "out"); }),
              HasSubstr("rig.textproto"));
}

TEST_F(FoldersTest, TimesOfNamesAreTheViews) {
  Image("t", "1700000000.250", CV_8UC1);
  fs::rename(dir_ / "clouds/p1.pcd", dir_ / "clouds/1700000000.200.pcd");
  fs::rename(dir_ / "clouds/p2.pcd", dir_ / "clouds/1700000001.200.pcd");
  folders_.cameras = {{"front", dir_ / "t"}};
  const FolderSession made = ReadFolders(folders_);
  ASSERT_EQ(made.views.size(), 1u);
  EXPECT_EQ(made.views[0].name, "1700000000.200");
  EXPECT_EQ(made.views[0].sweep_utime, 1'700'000'000'200'000);
  EXPECT_EQ(made.views[0].images[0].utime, 1'700'000'000'250'000);
  EXPECT_THAT(made.left_over,
              ElementsAre(AllOf(HasSubstr("2 clouds"), HasSubstr("1700000001.200.pcd, p3.pcd"))));
}

TEST_F(FoldersTest, WhatCannotBeUsedIsLeftOver) {
  test::WriteQuickly(dir_ / "a/p1.png", "no image");
  test::WriteQuickly(dir_ / "clouds/p2.pcd", "no cloud");
  Image("a", "p7", CV_8UC3);
  test::WriteQuickly(dir_ / "a/times.txt", "not looked at");
  const FolderSession made = ReadFolders(folders_);
  ASSERT_EQ(made.views.size(), 1u);
  EXPECT_EQ(made.views[0].name, "p3");
  EXPECT_THAT(made.left_over, ElementsAre(HasSubstr("p1.png"),
                                          AllOf(HasSubstr("1 image of rgb"), HasSubstr("p7.png")),
                                          HasSubstr("p2.pcd")));
}

TEST_F(FoldersTest, OneImageOfAnotherSizeIsLeftOver) {
  for (const char* name : {"p4", "p5"}) {
    Image("a", name, CV_8UC3, name[1] == '5' ? cv::Size(44, 30) : cv::Size(40, 30));
    WritePcd(dir_ / ("clouds/" + std::string(name) + ".pcd"), test::MakeCloud());
  }
  const FolderSession made = ReadFolders(folders_);
  EXPECT_EQ(made.views.size(), 4u);
  EXPECT_THAT(made.left_over,
              Contains(AllOf(HasSubstr("p5.png is 44x30"), HasSubstr("the others are 40x30"))));
}

TEST_F(FoldersTest, WhatExifSaysIsToldAndLeftAside) {
  // An EXIF of one tag, the orientation, after a JPEG's begin.
  const std::string exif(
      "\xFF\xE1\x00\x22"
      "Exif\0\0MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0\x06\0\0\0\0\0\0",
      36);
  const std::string plain = EncodeJpeg(cv::Mat(30, 40, CV_8UC3, cv::Scalar::all(7)), 90);
  const auto said = [&](const std::string& more) {
    for (const char* name : {"p1", "p2", "p3"}) {
      fs::remove(dir_ / ("a/" + std::string(name) + ".png"));
      test::WriteQuickly(dir_ / ("a/" + std::string(name) + ".jpg"),
                         plain.substr(0, 2) + more + plain.substr(2));
    }
    const FolderSession made = ReadFolders(folders_);
    EXPECT_EQ(made.rig.cameras[0].width, 40);
    return made.cameras[0];
  };
  EXPECT_THAT(said(exif), HasSubstr("EXIF says that they are to be turned"));
  EXPECT_THAT(said(""), Not(HasSubstr("EXIF")));
  std::string upright = exif;
  upright[29] = 1;
  EXPECT_THAT(said(upright), Not(HasSubstr("EXIF")));
}

TEST_F(FoldersTest, OtherNumbersButAsManyAreTold) {
  for (const char* name : {"img5", "img3", "img4"}) Image("c", name, CV_8UC1);
  folders_.cameras = {{"", dir_ / "c"}};
  EXPECT_THAT(ReadFolders(folders_).left_over,
              ElementsAre(AllOf(HasSubstr("2 images of rgb"), HasSubstr("--in-order")),
                          HasSubstr("2 clouds")));
  folders_.pairing.in_order = true;
  const FolderSession made = ReadFolders(folders_);
  EXPECT_THAT(made.left_over, IsEmpty());
  EXPECT_EQ(made.views[0].images[0].file.filename(), "img3.png");
}

TEST_F(FoldersTest, LinksAreNamedThemselves) {
  fs::create_directory(dir_ / "links");
  fs::create_symlink(dir_ / "a/p2.png", dir_ / "links/p1.png");
  folders_.cameras = {{"", dir_ / "links"}};
  WriteSession(dir_ / "out", ReadFolders(folders_));
  EXPECT_THAT(ReadWholeFile(dir_ / "out/views/p1/view.textproto"), HasSubstr("links/p1.png"));
}

TEST_F(FoldersTest, AViewMayLackACamera) {
  fs::remove(dir_ / "b/p2.png");
  folders_.cameras.push_back({"", dir_ / "b"});
  const FolderSession made = ReadFolders(folders_);
  ASSERT_EQ(made.views.size(), 3u);
  EXPECT_EQ(made.views[1].images.size(), 1u);
  EXPECT_EQ(made.views[2].images.size(), 2u);
  EXPECT_THAT(made.WithoutLens(), ElementsAre("rgb", "thermal"));
}

TEST_F(FoldersTest, KindsFollowFromImagesAndNames) {
  Image("my_thermal", "p1", CV_8UC1);
  Image("grey", "p1", CV_8UC1);
  folders_.cameras = {{"", dir_ / "my_thermal"}, {"", dir_ / "grey"}, {"", dir_ / "a"}};
  const FolderSession made = ReadFolders(folders_);
  EXPECT_THAT(CamerasOf(made.rig), ElementsAre("thermal", "rgb", "rgb_2"));
  EXPECT_EQ(made.rig.cameras[0].kind, CameraKind::kThermal);
  EXPECT_EQ(made.rig.cameras[1].kind, CameraKind::kColor);
  EXPECT_EQ(made.rig.cameras[1].format, PixelFormat::kMono8);
  Image("coloured", "p1", CV_8UC3);
  WritePng(dir_ / "coloured/p1.png", cv::Mat(30, 40, CV_8UC3, cv::Scalar(7, 90, 200)));
  folders_.cameras = {{"thermal", dir_ / "coloured"}};
  EXPECT_THAT(Error(), AllOf(HasSubstr("3 channels"), HasSubstr("raw counts")));
  folders_.cameras = {{"thermal", dir_ / "a"}};  // three channels, all grey
  EXPECT_EQ(ReadFolders(folders_).rig.cameras[0].kind, CameraKind::kThermal);
  EXPECT_EQ(ReadFolders(folders_).rig.cameras[0].format, PixelFormat::kMono8);
  folders_.cameras = {{"Front", dir_ / "a"}};
  EXPECT_THAT(Error(), HasSubstr("\"Front\""));
}

TEST_F(FoldersTest, SixteenBitsAreThermalWhereANameOrTheirValuesSaySo) {
  const auto write = [&](const std::string& folder, int type, double dark, double bright) {
    for (const char* name : {"p1", "p2", "p3"}) {
      cv::Mat pixels(16, 20, type, cv::Scalar::all(dark));
      pixels.colRange(0, 10) = cv::Scalar::all(bright);
      WritePng(dir_ / (folder + "/" + name + ".png"), pixels);
    }
  };
  const auto read = [&](const std::string& name, const std::string& folder) {
    folders_.cameras = {{name, dir_ / folder}};
    return ReadFolders(folders_);
  };
  write("cam0", CV_16UC3, 29000, 30500);
  EXPECT_EQ(read("", "cam0").rig.cameras[0].kind, CameraKind::kColor) << "three channels";
  EXPECT_EQ(read("", "cam0").rig.cameras[0].format, PixelFormat::kBgr8);
  write("cam1", CV_16UC1, 2000, 60000);
  FolderSession grey = read("", "cam1");
  EXPECT_EQ(grey.rig.cameras[0].kind, CameraKind::kColor);
  EXPECT_EQ(grey.rig.cameras[0].format, PixelFormat::kMono8);
  EXPECT_THAT(grey.cameras,
              ElementsAre(AllOf(HasSubstr("grey picture"), HasSubstr("say --images thermal="))));
  EXPECT_EQ(read("lwir", "cam1").rig.cameras[0].kind, CameraKind::kThermal);
  write("ir", CV_16UC1, 2000, 60000);
  EXPECT_EQ(read("", "ir").rig.cameras[0].kind, CameraKind::kThermal);
  EXPECT_THAT(read("", "ir").cameras, ElementsAre(Not(HasSubstr("16 bit"))));
  write("cam2", CV_16UC1, 29000, 30500);
  const FolderSession counts = read("", "cam2");
  EXPECT_EQ(counts.rig.cameras[0].kind, CameraKind::kThermal);
  EXPECT_EQ(counts.rig.cameras[0].format, PixelFormat::kMono16);
  EXPECT_THAT(counts.cameras, ElementsAre(AllOf(HasSubstr("thermal camera's counts"),
                                                HasSubstr("say --images rgb="))));
  EXPECT_EQ(read("rgb", "cam2").rig.cameras[0].kind, CameraKind::kColor);
}

TEST_F(FoldersTest, LensesBelongToTheirCameras) {
  folders_.model.reset();
  EXPECT_THAT(Error(), AllOf(HasSubstr("\"rgb\" has no lens"), HasSubstr("--pinhole")));
  Lens("a.yaml", 80, 60);
  folders_.lenses = {{"", dir_ / "a.yaml", ""}};
  EXPECT_THAT(Error(), AllOf(HasSubstr("80x60"), HasSubstr("0.5 times")));
  folders_.lenses = {{"front", dir_ / "a.yaml", ""}};
  EXPECT_THAT(Error(), AllOf(HasSubstr("\"front\""), HasSubstr("rgb")));
  Lens("a.yaml", 40, 30);
  folders_.lenses = {{"", dir_ / "a.yaml", ""}, {"", dir_ / "a.yaml", ""}};
  EXPECT_THAT(Error(), HasSubstr("2 lens files are given for 1 camera"));
  // One lens is not two cameras'.
  folders_.lenses = {{"", dir_ / "a.yaml", ""}};
  folders_.cameras.push_back({"", dir_ / "b"});
  EXPECT_THAT(Error(), HasSubstr("\"thermal\" has no lens"));
  folders_.board = {};
  folders_.board.width_m = folders_.board.height_m = 1;
  folders_.model = Lens::Model::kPinhole;
  EXPECT_THAT(Error(), HasSubstr("plain board has no corners"));
}

TEST_F(FoldersTest, FoldersThatMakeNoSenseAreRefused) {
  folders_.lidars[0].clouds = dir_ / "nowhere";
  EXPECT_THAT(Error(), AllOf(HasSubstr("no folder"), HasSubstr("nowhere")));
  folders_.lidars[0].clouds = dir_ / "a";
  EXPECT_THAT(Error(), AllOf(HasSubstr("holds no cloud"), HasSubstr("3 .png")));
  folders_.lidars[0].clouds = dir_.path();
  EXPECT_THAT(Error(), HasSubstr("it has a/, b/, clouds/"));
  folders_.lidars = {{"", dir_ / "clouds"}};
  folders_.cameras = {{"", dir_ / "clouds"}};
  EXPECT_THAT(Error(), AllOf(HasSubstr("holds no image"), HasSubstr("3 .pcd")));
  folders_.cameras = {{"", dir_ / "a"}, {"x", dir_ / "b/../a"}};
  EXPECT_THAT(Error(), HasSubstr("two cameras"));
  folders_.cameras = {{"", dir_ / "a"}};
  Image("a", "p2", CV_8UC3, {20, 15});
  EXPECT_THAT(Error(), AllOf(HasSubstr("40x30"), HasSubstr("20x15")));
  Image("a", "p2", CV_16UC1);
  EXPECT_THAT(Error(), HasSubstr("8 bits and 16"));
}

// They would be printed, those without a pair, too.
TEST_F(FoldersTest, NamesThatMoveACursorAreRefused) {
  for (const std::string bad : {"\x1b[2J", "\n", "\xff", "\u202e"}) {
    Image("a", "alone" + bad, CV_8UC3);
    EXPECT_THAT(Error(), AllOf(HasSubstr("/a/alone"), HasSubstr("rename it")));
    EXPECT_TRUE(IsPrintable(Error()));
    fs::remove(dir_ / ("a/alone" + bad + ".png"));
  }
}

TEST_F(FoldersTest, OfManyOtherFilesAFewAreTold) {
  folders_.lidars = {{"", dir_ / "others"}};
  fs::create_directory(dir_ / "others");
  for (int i = 0; i < 1000; ++i) {
    test::WriteQuickly(dir_ / ("others/a.x" + std::to_string(i)), "");
    fs::create_directory(dir_ / ("others/folder" + std::to_string(i)));
  }
  const std::string error = Error();
  EXPECT_THAT(error, AllOf(HasSubstr("1 .x0, "), HasSubstr("and 992 more and folder0/, "),
                           HasSubstr("/ and 992 more")));
  EXPECT_LT(error.size(), 1000u);
}

TEST_F(FoldersTest, CloudsOfFurtherLidarsJoinTheReferences) {
  for (const char* name : {"q1", "q3", "q7"}) {
    WritePcd(dir_ / ("rear/" + std::string(name) + ".pcd"), test::MakeCloud());
  }
  folders_.lidars = {{"front", dir_ / "clouds"}, {"rear", dir_ / "rear"}};
  Lens("a.yaml", 40, 30);
  folders_.lenses = {{"", dir_ / "a.yaml", ""}};
  const FolderSession made = ReadFolders(folders_);
  EXPECT_THAT(made.left_over, ElementsAre(HasSubstr("1 cloud of rear without a cloud of "
                                                    "front of the same number: q7.pcd")));
  WriteSession(dir_ / "out", made);
  const Session session = OpenSession(dir_ / "out");
  EXPECT_EQ(session.rig.lidar.name, "front");
  ASSERT_EQ(session.rig.further_lidars.size(), 1u);
  EXPECT_EQ(session.rig.further_lidars[0].name, "rear");
  EXPECT_THAT(ReadWholeFile(dir_ / "out/views/p3/view.textproto"),
              AllOf(HasSubstr("lidar: \"rear\""), HasSubstr("rear/q3.pcd")));
  EXPECT_THAT(ReadWholeFile(dir_ / "out/views/p2/view.textproto"),
              ::testing::Not(HasSubstr("rear")));
}

TEST_F(FoldersTest, FurtherLidarsThatMakeNoSenseAreRefused) {
  const auto error = [&](const std::vector<Folders::Lidar>& lidars) {
    folders_.lidars = lidars;
    return Error();
  };
  EXPECT_THAT(error({{"", dir_ / "clouds"}, {"", dir_ / "rear/../clouds"}}),
              HasSubstr("two LIDARs"));
  WritePcd(dir_ / "rear/late.pcd", test::MakeCloud());
  EXPECT_THAT(error({{"", dir_ / "clouds"}, {"", dir_ / "rear"}}),
              AllOf(HasSubstr("none of the 1 clouds of"), HasSubstr("give clouds of one moment")));
  folders_.pairing.in_order = true;
  EXPECT_THAT(error({{"", dir_ / "clouds"}, {"", dir_ / "rear"}}),
              HasSubstr("rear holds 1 clouds and"));
  folders_.pairing.in_order = false;
  fs::rename(dir_ / "rear/late.pcd", dir_ / "rear/p2.pcd");
  folders_.lidars = {{"", dir_ / "clouds"}, {"", dir_ / "rear"}};
  EXPECT_EQ(ReadFolders(folders_).rig.further_lidars.at(0).name, "lidar_2");
  EXPECT_THAT(error({{"rear", dir_ / "clouds"}, {"rear", dir_ / "rear"}}), HasSubstr("twice"));
  test::WriteQuickly(dir_ / "rear/p2.pcd", "no cloud");
  EXPECT_THAT(error({{"", dir_ / "clouds"}, {"", dir_ / "rear"}}),
              AllOf(HasSubstr("no cloud of"), HasSubstr("p2.pcd")));
}

TEST_F(FoldersTest, RealFolders) {
  const char* data = std::getenv("RGBDT_REAL_DATA");
  if (data == nullptr) GTEST_SKIP() << "RGBDT_REAL_DATA is not set: no folders of real files";
  folders_.cameras = {{"", fs::path(data) / "acfr_vlp16/images"}};
  folders_.lidars[0].clouds = fs::path(data) / "acfr_vlp16/clouds";
  const FolderSession made = ReadFolders(folders_);
  EXPECT_THAT(made.left_over, IsEmpty());
  ASSERT_EQ(made.views.size(), 14u);
  EXPECT_EQ(made.views.front().name, "pose3");
  EXPECT_EQ(made.views.back().name, "pose38");
  EXPECT_EQ(made.rig.cameras[0].width, 1920);
}

TEST_F(FoldersTest, ACloudOfWhichNothingReturnedIsLeftOut) {
  Cloud nothing = test::MakeCloud();
  for (Eigen::Vector3f& point : nothing.points) point.setConstant(NAN);
  WritePcd(dir_ / "clouds/p2.pcd", nothing);
  const FolderSession made = ReadFolders(folders_);
  EXPECT_EQ(made.views.size(), 2U);
  EXPECT_THAT(made.left_over, ElementsAre(HasSubstr("p2.pcd: none of its 20 points")));
}

TEST_F(FoldersTest, CloudsInMillimetresAreRefused) {
  test::WriteQuickly(dir_ / "clouds/p2.pcd",
                     "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 2\n"
                     "HEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\nDATA ascii\n"
                     "4000 10 20\n5000 10 20\n");
  EXPECT_THAT(Error(), AllOf(HasSubstr("p2.pcd"), HasSubstr("millimetres")));
}

}  // namespace
}  // namespace rgbdt
