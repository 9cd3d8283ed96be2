#include "calib/files/import/lens_file.h"

#include "calib/files/atomic_file.h"
#include "calib/files/schema/exports.h"
#include "tests/unit/files/test_data.h"

namespace rgbdt {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr char kOpenCv[] = R"(%YAML:1.0
---
calibration_time: "Tue 02 Jan 2024"
image_width: 640
image_height: 480
flags: 0
camera_matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 500., 0., 320.5, 0., 501.5,
       240.25, 0., 0., 1. ]
distortion_coefficients: !!opencv-matrix
   rows: 5
   cols: 1
   dt: d
   data: [ -1.5e-01, 2.5e-02, 1.0000000000000000e-03, -2.e-03, 0.125 ]
)";

constexpr char kCameraInfo[] = R"(header:
  stamp: {sec: 12, nanosec: 5}
  frame_id: camera
height: 480
width: 640
distortion_model: rational_polynomial
d:
- 0.1
- 0.2
- 0.3
- 0.4
- 0.5
- 0.6
- 0.7
- 0.8
k: [500.0, 0.0, 320.5, 0.0, 501.5, 240.25, 0.0, 0.0, 1.0]
r: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]
p: [500.0, 0.0, 320.5, 0.0, 0.0, 501.5, 240.25, 0.0, 0.0, 0.0, 1.0, 0.0]
binning_x: 0
roi: {x_offset: 0, y_offset: 0, height: 0, width: 0, do_rectify: false}
---
)";

constexpr char kCamchain[] = R"(cam0:
  cam_overlaps: [1]
  camera_model: pinhole
  distortion_coeffs: [-0.1, 0.2, 0.001, -0.002]
  distortion_model: radtan
  intrinsics: [500.0, 501.5, 320.5, 240.25]
  resolution: [640, 480]
  rostopic: /front/image_raw
cam1:
  T_cn_cnm1:
  - [1.0, 0.0, 0.0, 0.1]
  - [0.0, 1.0, 0.0, 0.0]
  - [0.0, 0.0, 1.0, 0.0]
  - [0.0, 0.0, 0.0, 1.0]
  camera_model: pinhole
  distortion_coeffs: [-0.01, 0.02, -0.03, 0.04]
  distortion_model: equidistant
  intrinsics: [300.0, 301.0, 160.0, 128.0]
  resolution: [320, 256]
  rostopic: /thermal/image_raw
)";

LensWanted Wanted() {
  LensWanted wanted;
  wanted.file = "lens.yaml";
  wanted.camera = "rgb";
  return wanted;
}

FileLens Parse(const std::string& text) { return ParseLensFile(text, Wanted()); }

std::string ErrorOfLens(const std::string& text, const LensWanted& wanted = Wanted()) {
  return test::ErrorOf([&] { ParseLensFile(text, wanted); });
}

// `text` with the first `was` made `is`.
std::string Exchanged(std::string text, const std::string& was, const std::string& is) {
  return text.replace(text.find(was), was.size(), is);
}

void ExpectUsualNumbers(const FileLens& found) {
  EXPECT_EQ(found.lens.fx, 500);
  EXPECT_EQ(found.lens.fy, 501.5);
  EXPECT_EQ(found.lens.cx, 320.5);
  EXPECT_EQ(found.lens.cy, 240.25);
  EXPECT_EQ(found.width, 640);
  EXPECT_EQ(found.height, 480);
}

TEST(LensFile, OpenCvFileStorage) {
  const FileLens found = Parse(kOpenCv);
  ExpectUsualNumbers(found);
  EXPECT_EQ(found.lens.model, Lens::Model::kPinhole);
  EXPECT_THAT(found.lens.distortion, ElementsAre(-0.15, 0.025, 0.001, -0.002, 0.125, 0, 0, 0));
}

TEST(LensFile, PlainYamlOfScripts) {
  const FileLens found = Parse(
      "{\"mtx\": [[500, 0, 320.5], [0, 501.5, 240.25], [0, 0, 1]], \"dist\": [[1, 2, 3, 4, 5]]}");
  EXPECT_EQ(found.lens.cy, 240.25);
  EXPECT_EQ(found.width, 0);
  EXPECT_EQ(found.lens.distortion[4], 5);
  const FileLens block = Parse(
      "cameraMatrix:\n- - 500\n  - 0\n  - 320.5\n- [0, 501.5, 240.25]\n- [0, 0, 1]\n"
      "distCoeffs: []\nimage_size: [640, 480]\n");
  ExpectUsualNumbers(block);
  EXPECT_THAT(block.lens.distortion, ElementsAre(0, 0, 0, 0, 0, 0, 0, 0));
}

TEST(LensFile, RosCameraInfo) {
  const FileLens found = Parse(kCameraInfo);
  ExpectUsualNumbers(found);
  EXPECT_EQ(found.lens.model, Lens::Model::kPinhole);
  EXPECT_THAT(found.lens.distortion, ElementsAre(0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8));
  const std::string fisheye =
      "image_width: 640\nimage_height: 480\ndistortion_model: equidistant\n"
      "camera_matrix:\n  rows: 3\n  cols: 3\n"
      "  data: [500, 0, 320.5, 0, 501.5, 240.25, 0, 0, 1]\n"
      "distortion_coefficients:\n  rows: 1\n  cols: 4\n"
      "  data: [1, 2, 3, 4]\n";
  ExpectUsualNumbers(Parse(fisheye));
  EXPECT_EQ(Parse(fisheye).lens.model, Lens::Model::kFisheye);
  const FileLens plumb_bob = Parse(Exchanged(fisheye, "equidistant", "plumb_bob"));
  EXPECT_EQ(plumb_bob.lens.model, Lens::Model::kPinhole);
  EXPECT_THAT(plumb_bob.lens.distortion, ElementsAre(1, 2, 3, 4, 0, 0, 0, 0));
}

TEST(LensFile, KalibrsCamerasByNamePartTopicAndPlace) {
  LensWanted wanted = Wanted();
  wanted.cameras = 2;
  const FileLens first = ParseLensFile(kCamchain, wanted);
  ExpectUsualNumbers(first);
  EXPECT_EQ(first.where, "lens.yaml:cam0");
  EXPECT_EQ(first.parts, 2);
  EXPECT_THAT(first.lens.distortion, ElementsAre(-0.1, 0.2, 0.001, -0.002, 0, 0, 0, 0));
  wanted.index = 1;
  const FileLens second = ParseLensFile(kCamchain, wanted);
  EXPECT_EQ(second.where, "lens.yaml:cam1");
  EXPECT_EQ(second.lens.model, Lens::Model::kFisheye);
  EXPECT_EQ(second.lens.fy, 301);

  wanted.camera = "thermal";  // its topic counts for more than its place
  wanted.index = 0;
  EXPECT_EQ(ParseLensFile(kCamchain, wanted).where, "lens.yaml:cam1");
  wanted.entry = "cam0";
  EXPECT_EQ(ParseLensFile(kCamchain, wanted).where, "lens.yaml:cam0");
  wanted.entry = "cam2";
  EXPECT_THAT(ErrorOfLens(kCamchain, wanted),
              AllOf(HasSubstr("\"cam2\""), HasSubstr("cam1 (/thermal/image_raw)")));
  EXPECT_THAT(ErrorOfLens(kCamchain),
              AllOf(HasSubstr("2 cameras"), HasSubstr("--lens rgb=lens.yaml:cam0")));
}

TEST(LensFile, KalibrWithoutDistortion) {
  const std::string none =
      "cam0: {camera_model: pinhole, intrinsics: [500, 501.5, 320.5, 240.25], "
      "distortion_model: none, distortion_coeffs: [], resolution: [640, 480]}";
  ExpectUsualNumbers(Parse(none));
  EXPECT_EQ(Parse(none).lens.model, Lens::Model::kPinhole);
}

TEST(LensFile, WhatRgbdtExportWroteComesBack) {
  const Rig rig = test::MakeRig();
  Calibration calibration;
  for (const CameraSpec& camera : rig.cameras) {
    CameraCalibration& out = calibration.cameras.emplace_back();
    out.camera = camera.name;
    out.status = SolveStatus::kConverged;
  }
  const test::TempDir dir;
  ExportOpenCv(dir / "opencv.yaml", rig, calibration);
  ASSERT_GE(rig.cameras.size(), 2u);
  for (const CameraSpec& camera : rig.cameras) {
    LensWanted wanted;
    wanted.file = dir / "opencv.yaml";
    wanted.camera = camera.name;
    const FileLens found = ReadLensFile(wanted);
    EXPECT_EQ(found.lens, camera.lens) << camera.name;
    EXPECT_EQ(found.width, camera.width);
  }
}

TEST(LensFile, FourCoefficientsNeedAModel) {
  const std::string four = Exchanged(kOpenCv, ", 0.125 ]", " ]");
  EXPECT_THAT(ErrorOfLens(four),
              AllOf(HasSubstr("lens.yaml:13: distortion_coefficients"), HasSubstr("--fisheye")));
  LensWanted wanted = Wanted();
  wanted.model = Lens::Model::kFisheye;
  EXPECT_EQ(ParseLensFile(four, wanted).lens.model, Lens::Model::kFisheye);
  wanted.model = Lens::Model::kPinhole;
  EXPECT_EQ(ParseLensFile(four, wanted).lens.model, Lens::Model::kPinhole);
  EXPECT_EQ(Parse(four + "fisheye_model: 1\n").lens.model, Lens::Model::kFisheye);
  EXPECT_THAT(ErrorOfLens(four + "fisheye_model: 1\n", wanted),
              AllOf(HasSubstr("fisheye"), HasSubstr("--pinhole")));
}

TEST(LensFile, WhatOurModelsCannotExpressNamesTheField) {
  const std::string more = "0.125, 0, 0, 0, ";
  ExpectUsualNumbers(Parse(Exchanged(kOpenCv, "0.125", more + "0, 0, 0, 0")));
  EXPECT_THAT(
      ErrorOfLens(Exchanged(kOpenCv, "0.125", more + "0, 0.5, 0, 0")),
      AllOf(HasSubstr("distortion_coefficients has 0.5 as number 10"), HasSubstr("thin prism")));
  EXPECT_THAT(ErrorOfLens(Exchanged(kOpenCv, "0.125", "0.125, 1")), HasSubstr("4, 5 or 8"));
  EXPECT_THAT(ErrorOfLens(Exchanged(kOpenCv, "500., 0.", "500., 0.5")), HasSubstr("skew of 0.5"));
  EXPECT_THAT(ErrorOfLens(Exchanged(kOpenCv, "500., 0., 320.5", "500., 0.")),
              HasSubstr("8 numbers"));
  EXPECT_THAT(ErrorOfLens(Exchanged(kOpenCv, "501.5", "-1")), HasSubstr("positive focal lengths"));
  EXPECT_THAT(ErrorOfLens(Exchanged(kOpenCv, "501.5", "abc")),
              AllOf(HasSubstr("lens.yaml:11: camera_matrix"), HasSubstr("abc")));
  EXPECT_THAT(ErrorOfLens(Exchanged(kCameraInfo, "rational_polynomial", "thin_prism")),
              AllOf(HasSubstr("lens.yaml:6: distortion_model is \"thin_prism\""),
                    HasSubstr("equidistant")));
  EXPECT_THAT(ErrorOfLens(Exchanged(kCameraInfo, "k: [500.0, 0.0, 320.5, 0.0, 501.5, 240.25",
                                    "k: [0, 0, 0, 0, 0, 0")),
              HasSubstr("never calibrated"));
  EXPECT_THAT(ErrorOfLens(Exchanged(kCameraInfo, "x_offset: 0", "x_offset: 8")),
              HasSubstr("roi.x_offset is 8"));
  LensWanted wanted = Wanted();
  wanted.cameras = 2;
  EXPECT_THAT(ErrorOfLens(Exchanged(kCamchain, "pinhole", "omni"), wanted),
              AllOf(HasSubstr("cam0.camera_model is \"omni\""), HasSubstr("--fisheye")));
  EXPECT_THAT(ErrorOfLens(Exchanged(kCamchain, "radtan", "fov"), wanted),
              HasSubstr("cam0.distortion_model is \"fov\""));
}

TEST(LensFile, WhatIsNoLensFileIsSaid) {
  EXPECT_THAT(ErrorOfLens(""), HasSubstr("is empty"));
  EXPECT_THAT(ErrorOfLens("hello"), HasSubstr("expected YAML"));
  EXPECT_THAT(ErrorOfLens("a: [1, 2"), HasSubstr("is not YAML"));
  EXPECT_THAT(ErrorOfLens("a: 1\n"), HasSubstr("holds no lens"));
  EXPECT_THAT(ErrorOfLens("<?xml version=\"1.0\"?>"), HasSubstr("is XML"));
  EXPECT_THAT(ErrorOfLens("K: [500, 0, 320, 0, 500, 240, 0, 0, 1]\n"),
              HasSubstr("no distortion_coefficients"));
  EXPECT_THAT(ErrorOfLens("K: " + std::string(1'000'000, '[')), HasSubstr("brackets"));
  EXPECT_THAT(ErrorOfLens(std::string(5'000'000, '#')), HasSubstr("5000000 bytes"));
  EXPECT_THAT(ErrorOfLens("K: &a [*a, *a]\nD: []\n"), HasSubstr("lens.yaml:1: K"));
}

TEST(LensFile, DamagedFilesNeverCrash) {
  const auto parse = [](const std::string& text) {
    LensWanted wanted = Wanted();
    wanted.cameras = 2;
    ParseLensFile(text, wanted);
  };
  for (const char* text : {kOpenCv, kCameraInfo, kCamchain}) {
    test::ParseTruncations(text, parse);
    test::ParseDamaged(text, parse);
  }
}

TEST(LensFile, TheImagesSizeMustBeTheLenss) {
  FileLens lens = Parse(kOpenCv);
  CheckLensSize(lens, "rgb", 640, 480);
  const auto error = [&](int width, int height) {
    return test::ErrorOf([&] { CheckLensSize(lens, "rgb", width, height); });
  };
  EXPECT_THAT(error(320, 240), AllOf(HasSubstr("640x480"), HasSubstr("320x240, 0.5 times")));
  EXPECT_THAT(error(1280, 960), HasSubstr(", 2 times as large"));
  EXPECT_THAT(error(640, 400), HasSubstr("another camera"));
  lens.width = 0;
  CheckLensSize(lens, "rgb", 640, 480);
  EXPECT_THAT(error(300, 240), HasSubstr("outside"));
}

}  // namespace
}  // namespace rgbdt
