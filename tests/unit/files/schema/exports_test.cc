#include "calib/files/schema/exports.h"

#include <algorithm>
#include <opencv2/core.hpp>
#include <sstream>

#include "calib/files/atomic_file.h"
#include "tests/unit/files/test_data.h"
#include "tests/unit/matchers.h"

namespace rgbdt {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class Exports : public ::testing::Test {
 protected:
  Exports() : rig_(test::MakeRig()), calibration_(test::MakeReport().ToCalibration()) {
    calibration_.cameras[1].camera_from_lidar = test::MakePose(0.6, {0.3, 0.1, -0.2});
  }

  test::TempDir dir_;
  Rig rig_;
  Calibration calibration_;
};

// The rows "- [a, b, c, d]" behind `key`.
Rigid3 MatrixIn(const std::string& text, const std::string& key) {
  std::istringstream rows(text.substr(text.find(key) + key.size()));
  Eigen::Matrix4d matrix;
  for (int row = 0; row < 4; ++row) {
    std::string line;
    std::getline(rows, line);
    std::replace_if(
        line.begin(), line.end(), [](char c) { return c == '[' || c == ',' || c == ']'; }, ' ');
    std::istringstream numbers(line.substr(line.find('-') + 1));
    for (int column = 0; column < 4; ++column) numbers >> matrix(row, column);
  }
  return {Eigen::Quaterniond(matrix.topLeftCorner<3, 3>()), matrix.topRightCorner<3, 1>()};
}

TEST_F(Exports, OpenCvReadsItsYaml) {
  ExportOpenCv(dir_ / "opencv.yaml", rig_, calibration_);
  cv::FileStorage file((dir_ / "opencv.yaml").string(), cv::FileStorage::READ);
  cv::Mat camera_matrix, distortion, camera_from_lidar;
  const cv::FileNode rgb = file["rgb"];
  rgb["camera_matrix"] >> camera_matrix;
  rgb["distortion"] >> distortion;
  rgb["camera_from_lidar"] >> camera_from_lidar;
  EXPECT_EQ(static_cast<int>(rgb["image_width"]), 48);
  EXPECT_EQ(static_cast<std::string>(rgb["distortion_model"]), "plumb_bob");
  EXPECT_EQ(camera_matrix.at<double>(0, 2), 23.3);
  EXPECT_EQ(distortion.total(), 5u);
  EXPECT_EQ(distortion.at<double>(4), 0.003);
  Eigen::Matrix3d rotation;
  Eigen::Vector3d translation;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) rotation(r, c) = camera_from_lidar.at<double>(r, c);
    translation[r] = camera_from_lidar.at<double>(r, 3);
  }
  EXPECT_THAT((Rigid3{Eigen::Quaterniond(rotation), translation}),
              Rigid3Near(calibration_.cameras[0].camera_from_lidar, 1e-9, 1e-9));
  file["thermal"]["distortion"] >> distortion;
  EXPECT_EQ(distortion.total(), 4u);
  EXPECT_EQ(static_cast<std::string>(file["thermal"]["distortion_model"]), "fisheye");
  EXPECT_THAT(ReadWholeFile(dir_ / "opencv.yaml"),
              HasSubstr("point_in_camera = camera_from_lidar * point_in_lidar"));
}

TEST_F(Exports, KalibrsChainLeadsFromCameraToCamera) {
  ExportKalibr(dir_ / "camchain.yaml", rig_, calibration_);
  const std::string text = ReadWholeFile(dir_ / "camchain.yaml");
  EXPECT_THAT(text, HasSubstr("point_in_camera = T_cam_lidar * point_in_lidar"));
  EXPECT_THAT(text, HasSubstr("cam0:  # rgb\n"));
  EXPECT_THAT(text, HasSubstr("distortion_model: radtan"));
  EXPECT_THAT(text, HasSubstr("k1 k2 p1 p2 k3 k4 k5 k6: [-0.1, 0.02, 1.0e-04, -2.0e-04, 0.003,"));
  EXPECT_THAT(text, HasSubstr("distortion_coeffs: [-0.1, 0.02, 1.0e-04, -2.0e-04]\n"));
  EXPECT_THAT(text, HasSubstr("cam1:  # thermal\n  camera_model: pinhole\n"));
  EXPECT_THAT(text, HasSubstr("distortion_model: equidistant"));
  EXPECT_THAT(text, HasSubstr("resolution: [24, 18]"));
  const Rigid3& rgb = calibration_.cameras[0].camera_from_lidar;
  const Rigid3& thermal = calibration_.cameras[1].camera_from_lidar;
  const std::string second = text.substr(text.find("cam1:"));
  EXPECT_THAT(MatrixIn(text, "T_cam_lidar:\n"), Rigid3Near(rgb, 1e-9, 1e-9));
  EXPECT_THAT(MatrixIn(second, "T_cam_lidar:\n"), Rigid3Near(thermal, 1e-9, 1e-9));
  EXPECT_THAT(MatrixIn(second, "T_cn_cnm1:\n"), Rigid3Near(thermal * rgb.Inverse(), 1e-9, 1e-9));
}

// What Python's YAML takes for words: numbers with an exponent and no point.
TEST_F(Exports, KalibrsNumbersAreNumbersInPython) {
  calibration_.cameras[0].camera_from_lidar.translation = {1e-7, -2e-20, 3e22};
  ExportKalibr(dir_ / "camchain.yaml", rig_, calibration_);
  const std::string text = ReadWholeFile(dir_ / "camchain.yaml");
  EXPECT_THAT(text, HasSubstr(", 1.0e-07]"));
  EXPECT_THAT(text, HasSubstr(", -2.0e-20]"));
  EXPECT_THAT(text, Not(testing::ContainsRegex("[[ ]-?[0-9]+e")));
}

TEST_F(Exports, NoCommentAboutTermsThatAreNotThere) {
  rig_.cameras[0].lens.distortion[4] = 0;
  ExportKalibr(dir_ / "camchain.yaml", rig_, calibration_);
  EXPECT_THAT(ReadWholeFile(dir_ / "camchain.yaml"), Not(HasSubstr("cut off")));
}

TEST_F(Exports, ACalibrationThatDidNotConvergeIsMarked) {
  calibration_.cameras[0].status = SolveStatus::kNotConverged;
  calibration_.cameras[0].detail = "no\nway";
  for (const ExportedFile& file : ExportAll(dir_.path(), rig_, calibration_)) {
    EXPECT_THAT(ReadWholeFile(file.path),
                HasSubstr("WARNING: rgb did not converge: not converged: no way"))
        << file.path;
  }
}

TEST_F(Exports, MatlabsFunctionSaysWhatALensLacksThere) {
  ExportMatlab(dir_ / "rig_of_ours.m", rig_, calibration_);
  const std::string text = ReadWholeFile(dir_ / "rig_of_ours.m");
  EXPECT_EQ(text.find("function cameras = rig_of_ours()\n% cameras = rig_of_ours() gives "), 0u);
  EXPECT_THAT(text, HasSubstr("% point_in_camera = camera_from_lidar * point_in_lidar"));
  EXPECT_THAT(text, HasSubstr("cameras(1).image_size = [32 48];"));
  EXPECT_THAT(text, HasSubstr("cameras(1).radial = [-0.1 0.02 0.003];"));
  EXPECT_THAT(text, HasSubstr("cameras(1).tangential = [1e-04 -2e-04];"));
  EXPECT_THAT(text, HasSubstr("cameras(2).fisheye = ["));
  EXPECT_THAT(text, Not(HasSubstr("cut off")));
  rig_.cameras[0].lens.distortion[5] = 0.5;
  ExportMatlab(dir_ / "x.m", rig_, calibration_);
  EXPECT_THAT(ReadWholeFile(dir_ / "x.m"),
              HasSubstr("% All of OpenCV's k1 k2 p1 p2 k3 k4 k5 k6: "));
}

TEST_F(Exports, AllFilesAreTheSameEveryTimeAndBadInputIsAnError) {
  std::vector<std::string> first;
  for (const ExportedFile& file : ExportAll(dir_.path(), rig_, calibration_)) {
    first.push_back(ReadWholeFile(file.path));
    EXPECT_THAT(first.back(), testing::ContainsRegex("point_in_(lidar|camera) = ")) << file.path;
  }
  std::size_t i = 0;
  for (const ExportedFile& file : ExportAll(dir_.path(), rig_, calibration_)) {
    EXPECT_EQ(ReadWholeFile(file.path), first[i++]);
  }
  EXPECT_EQ(i, 7u);
  calibration_.cameras[0].camera = "nobody";
  EXPECT_THAT(test::ErrorOf([&] { ExportAll(dir_.path(), rig_, calibration_); }),
              HasSubstr("nobody"));
  test::ErrorOf([&] { ExportAll(dir_.path(), rig_, Calibration{}); });
}

}  // namespace
}  // namespace rgbdt
