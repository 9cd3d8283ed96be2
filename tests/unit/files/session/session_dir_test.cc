#include "calib/files/session/session_dir.h"

#include <sys/resource.h>

#include <cmath>
#include <csignal>

#include "calib/files/atomic_file.h"
#include "calib/files/image_files.h"
#include "calib/files/schema/rig_file.h"
#include "tests/unit/files/test_data.h"

namespace rgbdt {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

bool SameImage(const cv::Mat& a, const cv::Mat& b) {
  return a.type() == b.type() && a.size() == b.size() && cv::norm(a, b, cv::NORM_INF) == 0;
}

/// Writing fails from so many bytes of a file on, as on a disk that is full.
class RoomFor {
 public:
  explicit RoomFor(rlim_t bytes) : before_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &limit_);
    const rlimit less{bytes, limit_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &less);
  }
  ~RoomFor() {
    setrlimit(RLIMIT_FSIZE, &limit_);
    std::signal(SIGXFSZ, before_);
  }
  RoomFor(const RoomFor&) = delete;
  RoomFor& operator=(const RoomFor&) = delete;

 private:
  rlimit limit_{};
  void (*before_)(int);
};

/// A session with six views, of which the last one's view.textproto can be replaced.
class SessionDir : public ::testing::Test {
 protected:
  SessionDir() {
    WriteRig(dir_.path(), test::MakeRig());
    View view = test::MakeView();
    for (const char* name : {"0001", "0002", "0003", "0004", "0005", "0006"}) {
      view.name = name;
      WriteView(dir_.path(), view);
    }
  }

  fs::path Folder(const std::string& view) const { return dir_ / ("views/" + view); }

  void WriteViewText(const std::string& view, const std::string& text) const {
    WriteFileAtomically(Folder(view) / "view.textproto", text);
  }

  std::string ErrorOfView(const std::string& text) const {
    WriteViewText("0006", text);
    return test::ErrorOf([&] { ReadView(OpenSession(dir_.path()), "0006"); });
  }

  test::TempDir dir_;
};

TEST_F(SessionDir, ImagesCanBeReadWithoutACloud) {
  fs::remove(Folder("0001") / "cloud.pcd");
  const Session session = OpenSession(dir_.path());
  EXPECT_EQ(ReadImages(session, "0001").images.size(), test::MakeView().images.size());
  EXPECT_THAT(test::ErrorOf([&] { ReadView(session, "0001"); }), HasSubstr("cloud"));
  WriteViewText("0006", "image { camera: \"thermal\" file: \"thermal.png\" }\n");
  EXPECT_EQ(ReadImages(session, "0006").images.size(), 1u);
  EXPECT_EQ(ReadImages(session, "0006").cloud.size(), 0u);
}

TEST_F(SessionDir, GivesBackTheWholeView) {
  const Session session = OpenSession(dir_.path());
  EXPECT_EQ(session.views.size(), 6u);
  const View view = test::MakeView();
  for (const bool heldout : {false, true}) {
    View written = view;
    written.heldout = heldout;
    if (heldout) {
      written.map_from_lidar =
          Rigid3{Eigen::Quaterniond(0.6, 0, 0.8, 0), Eigen::Vector3d(7, -8, 9)};
    }
    WriteView(dir_.path(), written);
    const View back = ReadView(session, "0001");
    EXPECT_EQ(back.heldout, heldout);
    ASSERT_EQ(back.map_from_lidar.has_value(), heldout);
    if (!heldout) continue;
    EXPECT_EQ(back.map_from_lidar->translation, Eigen::Vector3d(7, -8, 9));
    EXPECT_NEAR(back.map_from_lidar->rotation.y(), 0.8, 1e-12);
  }
  // The random pixels of this very view.
  WriteView(dir_.path(), view);
  const View back = ReadView(session, "0001");
  EXPECT_EQ(back.name, "0001");
  test::ExpectSame(back.cloud, view.cloud);
  ASSERT_EQ(back.images.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    const Image& a = view.images[i];
    const Image& b = back.images[i];
    EXPECT_EQ(b.camera, a.camera);
    EXPECT_EQ(b.utime, a.utime);
    EXPECT_EQ(b.frame_number, a.frame_number);
    EXPECT_EQ(b.device_utime, a.device_utime);
    EXPECT_EQ(b.exposure_s, a.exposure_s);
    EXPECT_EQ(b.format, a.format);
    EXPECT_TRUE(SameImage(b.pixels, a.pixels)) << a.camera;
  }
  EXPECT_EQ(back.images[1].radiometry.kind, Radiometry::Kind::kLinear);
  EXPECT_EQ(back.images[1].radiometry.gain, 0.04);
  EXPECT_EQ(back.images[1].radiometry.emissivity, 0.9);
  EXPECT_EQ(back.images[1].radiometry.reflected_temperature_k, 290.25);
  ASSERT_EQ(back.picks.size(), 1u);
  EXPECT_EQ(back.picks[0].camera, "thermal");
  EXPECT_EQ(back.picks[0].image_utime, view.picks[0].image_utime);
  EXPECT_EQ(back.picks[0].corners, view.picks[0].corners);
}

TEST_F(SessionDir, ANewViewIsThereWholeOrNotAtAll) {
  View view = test::MakeView();
  view.name = "0007";
  int failed = 0;
  bool written = false;
  for (rlim_t bytes = 1; !written; bytes *= 2) {
    try {
      const RoomFor room(bytes);
      WriteView(dir_.path(), view);
      written = true;
    } catch (const InputError& e) {
      ++failed;
      EXPECT_THAT(e.what(), HasSubstr("0007"));
      EXPECT_EQ(OpenSession(dir_.path()).views.size(), 6u) << bytes;
      EXPECT_FALSE(fs::exists(dir_ / "views/.0007.part")) << bytes;
    }
  }
  EXPECT_GT(failed, 5);
  test::ExpectSame(ReadView(OpenSession(dir_.path()), "0007").cloud, view.cloud);
}

// What a killed process left of it is no view, and in nobody's way.
TEST_F(SessionDir, APartOfAViewIsNone) {
  fs::create_directories(dir_ / "views/.0007.part");
  WriteFileAtomically(dir_ / "views/.0007.part/rgb_5.png", "half an ima");
  EXPECT_EQ(OpenSession(dir_.path()).views.size(), 6u);
  View view = test::MakeView();
  view.name = "0007";
  WriteView(dir_.path(), view);
  EXPECT_FALSE(fs::exists(dir_ / "views/.0007.part"));
  EXPECT_FALSE(fs::exists(Folder("0007") / "rgb_5.png"));
}

TEST_F(SessionDir, AViewThatIsSetAsideIsNoViewAndIsKept) {
  EXPECT_EQ(SetViewAside(dir_.path(), "0006"), ".0006.unfinished");
  EXPECT_EQ(OpenSession(dir_.path()).views.size(), 5u);
  View view = test::MakeView();
  view.name = "0006";
  WriteView(dir_.path(), view);
  EXPECT_EQ(SetViewAside(dir_.path(), "0006"), ".0006.unfinished-2");
  for (const char* name : {".0006.unfinished", ".0006.unfinished-2"}) {
    EXPECT_TRUE(fs::exists(dir_ / "views" / name / "view.textproto")) << name;
  }
  EXPECT_THAT(test::ErrorOf([&] { SetViewAside(dir_.path(), "0006"); }),
              AllOf(HasSubstr("cannot rename"), HasSubstr("views/0006")));
}

TEST_F(SessionDir, KeepsTheRigsOwnText) {
  Rig rig = ParseRig("# mine\n" + PrintRig(test::MakeRig()), "");
  WriteRig(dir_.path(), rig);
  EXPECT_EQ(OpenSession(dir_.path()).rig.hash, rig.hash);
}

TEST_F(SessionDir, EveryThirdViewIsHeldOutUnlessSaid) {
  for (const char* view : {"0001", "0002", "0003", "0004", "0005", "0006"}) {
    std::string text = ReadWholeFile(Folder(view) / "view.textproto");
    const std::string line = "heldout: false\n";
    text.erase(text.find(line), line.size());
    WriteViewText(view, text);
  }
  WriteViewText("0005", ReadWholeFile(Folder("0005") / "view.textproto") + "heldout: true\n");
  const Session session = OpenSession(dir_.path());
  std::vector<bool> heldout;
  for (const std::string& view : session.views) heldout.push_back(ReadView(session, view).heldout);
  EXPECT_THAT(heldout, ElementsAre(false, false, true, false, true, true));
}

// A copy of the session, in a folder of this name somewhere.
void CopyTo(const fs::path& from, const fs::path& to) {
  fs::create_directories(to);
  fs::copy(from, to, fs::copy_options::recursive);
}

TEST_F(SessionDir, SeveralAreOne) {
  const test::TempDir other;
  CopyTo(dir_.path(), other / "monday");
  CopyTo(dir_.path(), other / "friday");
  const Session joined =
      JoinSessions({OpenSession(other / "monday"), OpenSession(other / "friday/")});
  EXPECT_EQ(joined.Title(), "monday, friday");
  ASSERT_EQ(joined.views.size(), 12u);
  EXPECT_EQ(joined.views.front(), "monday/0001");
  EXPECT_EQ(joined.views.back(), "friday/0006");
  const View view = ReadView(joined, "friday/0001");
  EXPECT_EQ(view.name, "friday/0001");
  test::ExpectSame(view.cloud, ReadView(OpenSession(other / "friday"), "0001").cloud);
  EXPECT_EQ(ReadCloud(joined, "friday/0001").size(), view.cloud.size());
  EXPECT_THAT(test::ErrorOf([&] { ReadView(joined, "friday/0009"); }),
              AllOf(HasSubstr("has no view \"0009\""), HasSubstr("0001")));
  EXPECT_THAT(test::ErrorOf([&] { ReadView(joined, "sunday/0001"); }), HasSubstr("monday/0001"));

  const std::vector<Session> parts = PartsOf(joined);
  ASSERT_EQ(parts.size(), 2u);
  EXPECT_EQ(parts[1].Title(), "friday");
  EXPECT_EQ(parts[1].views.front(), "friday/0001");
  EXPECT_EQ(ReadView(parts[1], "friday/0001").name, "friday/0001");
}

TEST_F(SessionDir, SeveralOfOneNameAreToldByTheirPaths) {
  const test::TempDir other;
  CopyTo(dir_.path(), other / "monday/session");
  CopyTo(dir_.path(), other / "friday/session");
  const Session joined =
      JoinSessions({OpenSession(other / "monday/session"), OpenSession(other / "friday/session")});
  for (const std::string& view : joined.views) EXPECT_EQ(ReadView(joined, view).name, view);
  EXPECT_THAT(joined.views.front(), HasSubstr("monday/session/0001"));
  EXPECT_THAT(test::ErrorOf([&] {
                JoinSessions({OpenSession(other / "monday/session"),
                              OpenSession(other / "friday/../monday/session")});
              }),
              HasSubstr("named twice"));
}

TEST_F(SessionDir, SeveralAreOfOneRig) {
  const test::TempDir other;
  CopyTo(dir_.path(), other / "friday");
  Rig rig = test::MakeRig();
  rig.cameras[0].lens.fx += 10;
  WriteRig(other / "friday", rig);
  EXPECT_THAT(test::ErrorOf([&] {
                JoinSessions({OpenSession(dir_.path()), OpenSession(other / "friday")});
              }),
              AllOf(HasSubstr("fx: "), HasSubstr("rgbdt compare")));
}

TEST_F(SessionDir, ViewsAreSortedAsPeopleCount) {
  const test::TempDir dir;
  WriteRig(dir.path(), test::MakeRig());
  for (const char* view : {"pose10", "pose9", "pose1", ".hidden"}) {
    fs::create_directories(dir / (std::string("views/") + view));
  }
  EXPECT_THAT(OpenSession(dir.path()).views, ElementsAre("pose1", "pose9", "pose10"));
}

TEST_F(SessionDir, MoreThanOneImageACamera) {
  View view = test::MakeView();
  view.images.push_back(view.images[0]);
  view.images.back().utime += 1'000'000;
  view.images.back().pixels = cv::Mat::zeros(32, 48, CV_8UC1);
  WriteView(dir_.path(), view);
  const View back = ReadView(OpenSession(dir_.path()), "0001");
  ASSERT_EQ(back.images.size(), 3u);
  EXPECT_EQ(back.images[2].camera, "rgb");
  EXPECT_EQ(cv::countNonZero(back.images[2].pixels), 0);
  EXPECT_TRUE(SameImage(back.images[0].pixels, view.images[0].pixels));
}

TEST_F(SessionDir, ViewsOfOnesOwnFilesNeedLittle) {
  WritePng(dir_ / "elsewhere/my image.png", cv::Mat(32, 48, CV_8UC3, cv::Scalar(1, 2, 3)));
  fs::copy_file(Folder("0001") / "cloud.pcd", dir_ / "elsewhere/my.pcd");
  WriteViewText("0006", "cloud: \"../../elsewhere/my.pcd\"\nimage { camera: \"rgb\" file: \"" +
                            (dir_ / "elsewhere/my image.png").string() + "\" }\n");
  const View view = ReadView(OpenSession(dir_.path()), "0006");
  EXPECT_TRUE(view.heldout);
  EXPECT_EQ(view.images[0].format, PixelFormat::kBgr8);
  EXPECT_EQ(view.images[0].utime, 0);
  EXPECT_EQ(view.cloud.size(), 20u);
  EXPECT_TRUE(view.picks.empty());
}

TEST_F(SessionDir, AnImageWithoutRadiometryHasTheRigs) {
  WriteViewText("0006",
                "cloud: \"cloud.pcd\"\nimage { camera: \"thermal\" file: \"thermal.png\" }\n");
  const View view = ReadView(OpenSession(dir_.path()), "0006");
  EXPECT_EQ(view.images[0].radiometry.kind, Radiometry::Kind::kPlanck);
  EXPECT_EQ(view.images[0].radiometry.emissivity, 0.95);
}

TEST_F(SessionDir, AThermalImageOfThreeChannelsIsRefused) {
  WritePng(Folder("0006") / "thermal.png", cv::Mat(18, 24, CV_8UC3, cv::Scalar(7, 90, 200)));
  const std::string error = ErrorOfView(
      "cloud: \"cloud.pcd\"\nimage {\n  camera: \"thermal\"\n  file: \"thermal.png\"\n}\n");
  EXPECT_THAT(error, HasSubstr("view.textproto:4: image.file"));
  EXPECT_THAT(error, HasSubstr("thermal.png has 3 channels"));
  EXPECT_THAT(error, HasSubstr("one channel"));
}

TEST_F(SessionDir, AColourCamerasImageOfSixteenBitIsReadAsEight) {
  for (const int type : {CV_16UC1, CV_16UC3}) {
    WritePng(Folder("0006") / "rgb.png", cv::Mat(32, 48, type, cv::Scalar::all(0x8000)));
    WriteViewText("0006", "cloud: \"cloud.pcd\"\nimage { camera: \"rgb\" file: \"rgb.png\" }\n");
    const Image image = ReadView(OpenSession(dir_.path()), "0006").images.at(0);
    EXPECT_EQ(image.format, type == CV_16UC1 ? PixelFormat::kMono8 : PixelFormat::kBgr8);
    EXPECT_EQ(image.pixels.ptr<std::uint8_t>()[0], 0x80);
  }
}

// As video of a thermal camera is: grey, within what its compression leaves.
TEST_F(SessionDir, AThermalImageOfThreeChannelsThatAreAlikeIsOne) {
  WriteViewText("0006",
                "cloud: \"cloud.pcd\"\nimage { camera: \"thermal\" file: \"thermal.png\" }\n");
  cv::Mat pixels = ReadView(OpenSession(dir_.path()), "0006").images[0].pixels;
  pixels = cv::Mat(pixels.size(), CV_8UC3, cv::Scalar(101, 100, 98));
  WritePng(Folder("0006") / "thermal.png", pixels);
  const View view = ReadView(OpenSession(dir_.path()), "0006");
  EXPECT_EQ(view.images[0].format, PixelFormat::kMono8);
  EXPECT_EQ(view.images[0].pixels.at<unsigned char>(3, 5), 100);
}

TEST_F(SessionDir, WhatDoesNotFitTheRigIsRefused) {
  const auto image = [](const std::string& fields) {
    return "cloud: \"cloud.pcd\"\nimage { " + fields + " }\n";
  };
  WritePng(Folder("0006") / "rgb.png", cv::Mat(33, 48, CV_8UC3));
  EXPECT_THAT(ErrorOfView(image("camera: \"rgb\" file: \"rgb.png\"")),
              HasSubstr("rgb.png is 48x33 px, but the rig says 48x32"));
  WritePng(Folder("0006") / "rgb.png", cv::Mat(32, 48, CV_8UC3));
  EXPECT_THAT(ErrorOfView(image("camera: \"rgb\" file: \"rgb.png\" pixel_format: BAYER_RG8")),
              HasSubstr("not BAYER_RG8"));
  const std::string unknown = ErrorOfView(image("camera: \"rbg\" file: \"rgb.png\""));
  EXPECT_THAT(unknown, HasSubstr("view.textproto:2: image.camera"));
  EXPECT_THAT(unknown, HasSubstr("it has: rgb, thermal"));
}

TEST_F(SessionDir, CloudAndImageOfDifferentTimesAreRefused) {
  const auto text = [](Utime image_utime) {
    return "cloud: \"cloud.pcd\"\nsweep_utime: 1000000000000000\nimage {\n"
           "  camera: \"rgb\"\n  file: \"rgb.png\"\n  pixel_format: BAYER_RG8\n  utime: " +
           std::to_string(image_utime) + "\n}\n";
  };
  const std::string error = ErrorOfView(text(1'000'000'061'000'000));
  EXPECT_THAT(error, HasSubstr("view.textproto:7: image.utime"));
  EXPECT_THAT(error, HasSubstr("cloud and image belong to different times"));
  EXPECT_THAT(ErrorOfView(text(999'999'939'000'000)), HasSubstr("different times"));
  EXPECT_THAT(ErrorOfView(text(INT64_MIN)), HasSubstr("different times"));
  for (const Utime good : {Utime{0}, Utime{1'000'000'059'000'000}}) {
    WriteViewText("0006", text(good));
    EXPECT_NO_THROW(ReadView(OpenSession(dir_.path()), "0006"));
  }
}

TEST_F(SessionDir, WhatIsMissingIsNamedWithTheFieldThatAskedForIt) {
  const std::string cloud = ErrorOfView(
      "\n# none\ncloud: \"none.pcd\"\n"
      "image { camera: \"rgb\" file: \"rgb.png\" pixel_format: BAYER_RG8 }\n");
  EXPECT_THAT(cloud, HasSubstr("view.textproto:3: cloud"));
  EXPECT_THAT(cloud, HasSubstr("none.pcd: No such file"));
  const std::string image =
      ErrorOfView("cloud: \"cloud.pcd\"\nimage {\n camera: \"rgb\"\n file: \"no.png\" }\n");
  EXPECT_THAT(image, HasSubstr("view.textproto:4: image.file"));
  EXPECT_THAT(image, HasSubstr("no.png: No such file"));
  EXPECT_THAT(ErrorOfView("image {}"), HasSubstr("cloud is missing"));
  EXPECT_THAT(ErrorOfView("cloud: \"cloud.pcd\""), HasSubstr("image is missing"));
  EXPECT_THAT(ErrorOfView("cloud: \"cloud.pcd\"\nimage { camera: \"rgb\" }"),
              HasSubstr("view.textproto:2: image.file is missing"));
  EXPECT_THAT(ErrorOfView("clod: \"cloud.pcd\""), HasSubstr("clod"));
  EXPECT_THAT(ErrorOfView("cloud: \"cloud.pcd\"\nimage { camera: \"rgb\" file: \"rgb.png\"\n"
                          "pixel_format: BAYER_RG8 picked {\n corner_px: [1, 2, 3] } }"),
              HasSubstr("view.textproto:4: image.picked.corner_px has 3"));
  fs::remove(Folder("0006") / "view.textproto");
  EXPECT_THAT(test::ErrorOf([&] { ReadView(OpenSession(dir_.path()), "0006"); }),
              HasSubstr("view.textproto is missing"));
  EXPECT_THAT(test::ErrorOf([&] { ReadView(OpenSession(dir_.path()), "0007"); }),
              HasSubstr("it has: 0001, 0002"));
}

TEST_F(SessionDir, AnUnfinishedSessionSaysWhatToDo) {
  const test::TempDir dir;
  EXPECT_THAT(test::ErrorOf([&] { OpenSession(dir / "none"); }), HasSubstr("no session directory"));
  EXPECT_THAT(test::ErrorOf([&] { OpenSession(dir.path()); }),
              HasSubstr("rig.textproto is missing"));
  WriteRig(dir.path(), test::MakeRig());
  EXPECT_THAT(test::ErrorOf([&] { OpenSession(dir.path()); }), HasSubstr("holds no view"));
}

TEST_F(SessionDir, NamesThatLeadElsewhereAreRefused) {
  for (const char* name : {"", "..", "../x", "a/b", "a b", "\n"}) {
    View view = test::MakeView();
    view.name = name;
    EXPECT_THROW(WriteView(dir_.path(), view), InputError) << name;
    view = test::MakeView();
    view.images[0].camera = name;
    EXPECT_THROW(WriteView(dir_.path(), view), InputError) << name;
  }
}

TEST_F(SessionDir, PicksOfAnImageThatIsNotThereAreRefused) {
  View view = test::MakeView();
  view.picks[0].image_utime += 1;
  EXPECT_THAT(test::ErrorOf([&] { WriteView(dir_.path(), view); }), HasSubstr("\"thermal\""));
}

TEST_F(SessionDir, DamagedViewsNeverCrash) {
  const Session session = OpenSession(dir_.path());
  const auto parse = [&](const std::string& text) {
    test::WriteQuickly(Folder("0006") / "view.textproto", text);
    ReadView(session, "0006");
  };
  const std::string text = ReadWholeFile(Folder("0006") / "view.textproto");
  test::ParseTruncations(text, parse, 100);
  test::ParseDamaged(text, parse, 60);
}

TEST_F(SessionDir, TruthGivesBackEveryBit) {
  Truth truth;
  truth.camera_from_lidar["rgb"] = test::MakePose(0.3, {1, 2, 1.0 / 3});
  truth.camera_from_lidar["thermal"] = test::MakePose(0.5, {0, 0, 0});
  truth.lidar_from_target["0001"] = test::MakePose(1.3, {4, 0.1, 0});
  WriteTruth(dir_ / "truth.textproto", truth, "rgb: off by 3 px\nrings: 5 mm\n");
  EXPECT_NE(ReadWholeFile(dir_ / "truth.textproto").find("\n# rings: 5 mm\n"), std::string::npos);
  const Truth back = ReadTruth(dir_ / "truth.textproto");
  ASSERT_EQ(back.camera_from_lidar.size(), 2u);
  test::ExpectSame(back.camera_from_lidar.at("rgb"), truth.camera_from_lidar.at("rgb"));
  test::ExpectSame(back.lidar_from_target.at("0001"), truth.lidar_from_target.at("0001"));
  EXPECT_EQ(back.lidar_from_target.size(), 1u);
  WriteFileAtomically(dir_ / "truth.textproto", "view { }\n");
  test::ErrorOf([&] { ReadTruth(dir_ / "truth.textproto"); });
}

TEST_F(SessionDir, TheReadmesExamplesAreGood) {
  const std::string readme =
      ReadWholeFile(std::string(RGBDT_SOURCE_DIR) + "/calib/files/README.md");
  const auto block = [&](const std::string& beginning) {
    const std::size_t begin = readme.find("```\n" + beginning) + 4;
    return readme.substr(begin, readme.find("```", begin) - begin);
  };
  const Rig rig = ParseRig(block("name: \"cart\""), "README.md");
  // Forward of the LIDAR is forward of the camera.
  const Rigid3 guess = *rig.cameras[0].camera_from_lidar_guess;
  EXPECT_LT((guess * Eigen::Vector3d(5, 0, 0.1) - Eigen::Vector3d(0, 0, 5)).norm(), 1e-12);
  // The view is read up to the first of its files, which is not there.
  EXPECT_THAT(ErrorOfView(block("# views/pose07")), HasSubstr("/data/pose7.png: No such file"));
}

TEST_F(SessionDir, RealSession) {
  const char* data = std::getenv("RGBDT_REAL_DATA");
  if (data == nullptr) GTEST_SKIP() << "RGBDT_REAL_DATA is not set: no session made of real files";
  const test::TempDir dir;
  const auto quoted = [](const fs::path& path) { return " '" + path.string() + "'"; };
  const std::string command = quoted(fs::path(RGBDT_SOURCE_DIR) / "scripts/session-from-acfr") +
                              quoted(fs::path(data) / "acfr_vlp16") + quoted(dir.path()) +
                              " >/dev/null";
  ASSERT_EQ(std::system(command.c_str()), 0);
  const Session session = OpenSession(dir.path());
  ASSERT_EQ(session.views.size(), 14u);
  EXPECT_EQ(session.views.front(), "pose03");
  EXPECT_EQ(session.views.back(), "pose38");
  const View view = ReadView(session, "pose07");
  EXPECT_TRUE(view.heldout);
  ASSERT_EQ(view.images.size(), 1u);
  EXPECT_EQ(view.images[0].format, PixelFormat::kBgr8);
  EXPECT_EQ(view.images[0].pixels.cols, 1920);
  EXPECT_GT(view.cloud.size(), 20'000u);
}

}  // namespace
}  // namespace rgbdt
