#include "calib/files/schema/exports.h"

#include <opencv2/core.hpp>

#include "calib/files/atomic_file.h"
#include "calib/files/schema/internal/export_parts.h"
#include "calib/files/schema/proto_convert.h"
#include "calib/model/text.h"

namespace rgbdt {
namespace {

using exports::Exported;
using exports::HasTerms;
using exports::kFrames;
using exports::Match;
using exports::MatrixOf;
using exports::StatusWarning;
using exports::YamlList;

int DistortionCount(const Lens& lens) {
  if (lens.model == Lens::Model::kFisheye) return 4;
  return HasTerms(lens, 5) ? 8 : 5;
}

std::string DistortionModel(const Lens& lens) {
  if (lens.model == Lens::Model::kFisheye) return "fisheye";
  return HasTerms(lens, 5) ? "rational_polynomial" : "plumb_bob";
}

void WriteOpenCvCamera(const Exported& camera, cv::FileStorage* file) {
  const Lens& lens = camera.spec.lens;
  const cv::Mat camera_matrix =
      (cv::Mat_<double>(3, 3) << lens.fx, 0, lens.cx, 0, lens.fy, lens.cy, 0, 0, 1);
  const cv::Mat distortion =
      cv::Mat(1, DistortionCount(lens), CV_64F, const_cast<double*>(lens.distortion.data()));
  const Eigen::Matrix4d pose = MatrixOf(camera.calibration.camera_from_lidar);
  cv::Mat camera_from_lidar(4, 4, CV_64F);
  for (int i = 0; i < 16; ++i) camera_from_lidar.at<double>(i / 4, i % 4) = pose(i / 4, i % 4);

  const std::string warning = StatusWarning(camera);
  if (!warning.empty()) file->writeComment(warning);
  *file << camera.spec.name << "{";
  *file << "image_width" << camera.spec.width << "image_height" << camera.spec.height;
  *file << "camera_matrix" << camera_matrix;
  *file << "distortion_model" << DistortionModel(lens);
  *file << "distortion" << distortion;
  *file << "camera_from_lidar" << camera_from_lidar;
  *file << "}";
}

std::string KalibrMatrix(const std::string& name, const Rigid3& pose) {
  const Eigen::Matrix4d matrix = MatrixOf(pose);
  std::string text = "  " + name + ":\n";
  for (int row = 0; row < 4; ++row) {
    const Eigen::RowVector4d numbers = matrix.row(row);
    text += "  - " + YamlList(numbers.data(), 4) + "\n";
  }
  return text;
}

std::string KalibrLens(const Lens& lens) {
  const bool fisheye = lens.model == Lens::Model::kFisheye;
  std::string text = "  camera_model: pinhole\n";
  const double intrinsics[] = {lens.fx, lens.fy, lens.cx, lens.cy};
  text += "  intrinsics: " + YamlList(intrinsics, 4) + "\n";
  text += std::string("  distortion_model: ") + (fisheye ? "equidistant" : "radtan") + "\n";
  if (!fisheye && HasTerms(lens, 4)) {
    text +=
        "  # radtan holds k1 k2 p1 p2 only; this lens has more, so what stands here is cut off.\n"
        "  # All of OpenCV's k1 k2 p1 p2 k3 k4 k5 k6: " +
        YamlList(lens.distortion.data(), 8) + "\n";
  }
  return text + "  distortion_coeffs: " + YamlList(lens.distortion.data(), 4) + "\n";
}

std::string KalibrCamera(const std::vector<Exported>& cameras, std::size_t index) {
  const Exported& camera = cameras[index];
  const Rigid3& camera_from_lidar = camera.calibration.camera_from_lidar;
  const std::string warning = StatusWarning(camera);
  std::string text = "cam" + std::to_string(index) + ":  # " + camera.spec.name + "\n";
  if (!warning.empty()) text += "  # " + warning + "\n";
  text += KalibrLens(camera.spec.lens);
  text += "  resolution: [" + std::to_string(camera.spec.width) + ", " +
          std::to_string(camera.spec.height) + "]\n";
  text += "  rostopic: /" + camera.spec.name + "/image_raw\n";
  if (index > 0) {
    const Rigid3& previous = cameras[index - 1].calibration.camera_from_lidar;
    text += KalibrMatrix("T_cn_cnm1", camera_from_lidar * previous.Inverse());
  }
  return text + KalibrMatrix("T_cam_lidar", camera_from_lidar);
}

}  // namespace

void ExportOpenCv(const std::filesystem::path& path, const Rig& rig,
                  const Calibration& calibration) {
  const std::vector<Exported> cameras = Match(rig, calibration);
  cv::FileStorage file("opencv.yaml", cv::FileStorage::WRITE | cv::FileStorage::MEMORY |
                                          cv::FileStorage::FORMAT_YAML);
  file.writeComment(
      "point_in_camera = camera_from_lidar * point_in_lidar (homogeneous, metres), then\n"
      "cv::projectPoints or, where distortion_model is fisheye, cv::fisheye::projectPoints\n"
      "with rotation and translation zero.");
  file.writeComment(kFrames);
  for (const Exported& camera : cameras) WriteOpenCvCamera(camera, &file);
  WriteFileAtomically(path, file.releaseAndGetString());
}

void ExportKalibr(const std::filesystem::path& path, const Rig& rig,
                  const Calibration& calibration) {
  const std::vector<Exported> cameras = Match(rig, calibration);
  std::string text = std::string("# Kalibr's camchain. ") + kFrames +
                     "\n# T_cam_lidar: point_in_camera = T_cam_lidar * point_in_lidar.\n"
                     "# T_cn_cnm1: point_in_camera_n = T_cn_cnm1 * point_in_camera_n_minus_1.\n";
  for (std::size_t i = 0; i < cameras.size(); ++i) text += KalibrCamera(cameras, i);
  WriteFileAtomically(path, text);
}

std::vector<ExportedFile> ExportAll(const std::filesystem::path& dir, const Rig& rig,
                                    const Calibration& calibration, const FrameNames& frames) {
  const ExportedFile lines{
      dir / "ros_static_transform.txt",
      "command lines of ROS 1 and ROS 2: each camera's pose in the LIDAR frame"};
  const ExportedFile launch{dir / "ros2_static_transform.launch.yaml",
                            "for `ros2 launch`: publishes each camera's pose in the LIDAR frame"};
  const ExportedFile urdf{dir / "cameras.urdf",
                          "for a robot's description: a fixed joint from the LIDAR to each camera"};
  const ExportedFile opencv{dir / "opencv.yaml",
                            "for cv::FileStorage: lenses and camera_from_lidar"};
  const ExportedFile kalibr{dir / "kalibr_camchain.yaml",
                            "for Kalibr's tools: lenses, camera to camera, camera_from_lidar"};
  const ExportedFile autoware{
      dir / "sensor_kit_calibration.yaml",
      "for Autoware: each camera_link's pose in the LIDAR frame, x y z roll pitch yaw"};
  const ExportedFile matlab{dir / "matlab_calibration.m",
                            "for MATLAB: lenses and camera_from_lidar, as rigidtform3d takes it"};
  // ROS first: what is wrong with the frames' names is found before anything is written.
  ExportRosStaticTransform(lines.path, rig, calibration, frames);
  ExportRosLaunch(launch.path, rig, calibration, frames);
  ExportUrdf(urdf.path, rig, calibration, frames);
  ExportAutoware(autoware.path, rig, calibration, frames);
  ExportOpenCv(opencv.path, rig, calibration);
  ExportKalibr(kalibr.path, rig, calibration);
  ExportMatlab(matlab.path, rig, calibration);
  return {lines, launch, urdf, autoware, opencv, kalibr, matlab};
}

}  // namespace rgbdt
