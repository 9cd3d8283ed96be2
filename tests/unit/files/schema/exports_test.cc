#include "calib/files/schema/exports.h"

#include <opencv2/core.hpp>
#include <sstream>

#include "calib/files/atomic_file.h"
#include "tests/unit/files/test_data.h"

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
  const Rigid3& pose = calibration_.cameras[0].camera_from_lidar;
  for (int r = 0; r < 3; ++r) {
    EXPECT_EQ(camera_from_lidar.at<double>(r, 3), pose.translation[r]);
    EXPECT_EQ(camera_from_lidar.at<double>(r, 1), pose.rotation.toRotationMatrix()(r, 1));
  }
  file["thermal"]["distortion"] >> distortion;
  EXPECT_EQ(distortion.total(), 4u);
  EXPECT_EQ(static_cast<std::string>(file["thermal"]["distortion_model"]), "fisheye");
  EXPECT_THAT(ReadWholeFile(dir_ / "opencv.yaml"),
              HasSubstr("point_in_camera = camera_from_lidar * point_in_lidar"));
}

TEST_F(Exports, RosGetsTheCamerasPoseInTheLidarFrame) {
  ExportRosStaticTransform(dir_ / "ros.txt", rig_, calibration_);
  const std::string text = ReadWholeFile(dir_ / "ros.txt");
  EXPECT_THAT(text, HasSubstr("point_in_lidar = lidar_from_camera"));
  EXPECT_THAT(text, HasSubstr("--frame-id scanner --child-frame-id rgb_optical_frame"));
  const std::string ros1 = "rosrun tf2_ros static_transform_publisher ";
  std::istringstream line(text.substr(text.find(ros1) + ros1.size()));
  Rigid3 lidar_from_camera;
  Eigen::Vector3d& t = lidar_from_camera.translation;
  Eigen::Quaterniond& q = lidar_from_camera.rotation;
  std::string parent, child;
  line >> t.x() >> t.y() >> t.z() >> q.x() >> q.y() >> q.z() >> q.w() >> parent >> child;
  EXPECT_EQ(parent, "scanner");
  EXPECT_EQ(child, "rgb_optical_frame");
  const Eigen::Vector3d in_camera(1, 2, 3);
  EXPECT_LT(
      (calibration_.cameras[0].camera_from_lidar * (lidar_from_camera * in_camera) - in_camera)
          .norm(),
      1e-12);
}

TEST_F(Exports, KalibrsChainLeadsFromCameraToCamera) {
  ExportKalibr(dir_ / "camchain.yaml", rig_, calibration_);
  const std::string text = ReadWholeFile(dir_ / "camchain.yaml");
  EXPECT_THAT(text, HasSubstr("cam0:  # rgb\n"));
  EXPECT_THAT(text, HasSubstr("distortion_model: radtan"));
  EXPECT_THAT(text, HasSubstr("k1 k2 p1 p2 k3 k4 k5 k6: [-0.1, 0.02, 0.0001, -0.0002, 0.003,"));
  EXPECT_THAT(text, HasSubstr("distortion_coeffs: [-0.1, 0.02, 0.0001, -0.0002]\n"));
  EXPECT_THAT(text, HasSubstr("cam1:  # thermal\n  camera_model: pinhole\n"));
  EXPECT_THAT(text, HasSubstr("distortion_model: equidistant"));
  EXPECT_THAT(text, HasSubstr("resolution: [24, 18]"));
  std::istringstream rows(text.substr(text.find("T_cn_cnm1:\n") + 11));
  Eigen::Matrix4d matrix;
  for (int row = 0; row < 4; ++row) {
    std::string line;
    std::getline(rows, line);
    std::replace_if(
        line.begin(), line.end(), [](char c) { return c == '[' || c == ',' || c == ']'; }, ' ');
    std::istringstream numbers(line.substr(line.find('-') + 1));
    for (int column = 0; column < 4; ++column) numbers >> matrix(row, column);
  }
  const Eigen::Vector3d point(0.5, -0.7, 4);
  const Eigen::Vector3d expected = calibration_.cameras[1].camera_from_lidar * point;
  const Eigen::Vector3d first = calibration_.cameras[0].camera_from_lidar * point;
  EXPECT_LT(((matrix * first.homogeneous()).head<3>() - expected).norm(), 1e-12);
}

TEST_F(Exports, NoCommentAboutTermsThatAreNotThere) {
  rig_.cameras[0].lens.distortion[4] = 0;
  ExportKalibr(dir_ / "camchain.yaml", rig_, calibration_);
  EXPECT_THAT(ReadWholeFile(dir_ / "camchain.yaml"), Not(HasSubstr("cut off")));
}

TEST_F(Exports, ACalibrationThatDidNotConvergeIsMarked) {
  calibration_.cameras[0].status = SolveStatus::kNotConverged;
  calibration_.cameras[0].detail = "no\nway";
  for (const std::filesystem::path& file : ExportAll(dir_.path(), rig_, calibration_)) {
    EXPECT_THAT(ReadWholeFile(file),
                HasSubstr("WARNING: rgb did not converge: not converged: no way"))
        << file;
  }
}

TEST_F(Exports, AllFilesAreTheSameEveryTimeAndBadInputIsAnError) {
  std::vector<std::string> first;
  for (const auto& file : ExportAll(dir_.path(), rig_, calibration_)) {
    first.push_back(ReadWholeFile(file));
  }
  std::size_t i = 0;
  for (const auto& file : ExportAll(dir_.path(), rig_, calibration_)) {
    EXPECT_EQ(ReadWholeFile(file), first[i++]);
  }
  EXPECT_EQ(i, 3u);
  calibration_.cameras[0].camera = "nobody";
  EXPECT_THAT(test::ErrorOf([&] { ExportAll(dir_.path(), rig_, calibration_); }),
              HasSubstr("nobody"));
  test::ErrorOf([&] { ExportAll(dir_.path(), rig_, Calibration{}); });
}

TEST_F(Exports, ALidarsNameCannotLeaveItsPlaceOnTheCommandLine) {
  rig_.lidar.name = "x; rm -rf $HOME\n";
  ExportRosStaticTransform(dir_ / "ros.txt", rig_, calibration_);
  EXPECT_THAT(ReadWholeFile(dir_ / "ros.txt"), HasSubstr("--frame-id x__rm_-rf__HOME_ "));
}

}  // namespace
}  // namespace rgbdt
