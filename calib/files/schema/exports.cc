#include "calib/files/schema/exports.h"

#include <cstdio>
#include <opencv2/core.hpp>

#include "calib/files/atomic_file.h"
#include "calib/files/schema/proto_convert.h"
#include "calib/model/errors.h"

namespace rgbdt {
namespace {

constexpr char kFrames[] =
    "LIDAR frame: x forward, y left, z up. Camera frame: x right, y down, z forward. Metres.";

// A camera's spec beside its calibration.
struct Exported {
  CameraSpec spec;  // with the lens that belongs to the pose
  const CameraCalibration& calibration;
};

std::vector<Exported> Match(const Rig& rig, const Calibration& calibration) {
  std::vector<Exported> cameras;
  for (const CameraCalibration& camera : calibration.cameras) {
    cameras.push_back({camera.WithSolvedLens(rig.Camera(camera.camera)), camera});
  }
  if (cameras.empty()) throw InputError("the calibration holds no camera: nothing to export");
  return cameras;
}

// Digits enough to give back the same double.
std::string Number(double value) {
  char text[40];
  for (const int digits : {15, 16, 17}) {
    std::snprintf(text, sizeof text, "%.*g", digits, value);
    if (std::stod(text) == value) break;
  }
  return text;
}

std::string List(const double* values, int count, const char* separator = ", ") {
  std::string text;
  for (int i = 0; i < count; ++i) text += (i > 0 ? separator : "") + Number(values[i]);
  return text;
}

Eigen::Matrix4d Matrix(const Rigid3& pose) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.topLeftCorner<3, 3>() = text::Normalised(pose.rotation).toRotationMatrix();
  matrix.topRightCorner<3, 1>() = pose.translation;
  return matrix;
}

// The higher of OpenCV's pinhole coefficients, which not every tool has.
bool HasTerms(const Lens& lens, std::size_t from) {
  for (std::size_t i = from; i < lens.distortion.size(); ++i) {
    if (lens.distortion[i] != 0) return true;
  }
  return false;
}

std::string StatusComment(const Exported& camera) {
  if (camera.calibration.converged()) return {};
  std::string status = camera.calibration.StatusText();
  for (char& c : status) {
    if (static_cast<unsigned char>(c) < ' ') c = ' ';
  }
  return "WARNING: " + camera.spec.name + " did not converge: " + status;
}

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
  const Eigen::Matrix4d pose = Matrix(camera.calibration.camera_from_lidar);
  cv::Mat camera_from_lidar(4, 4, CV_64F);
  for (int i = 0; i < 16; ++i) camera_from_lidar.at<double>(i / 4, i % 4) = pose(i / 4, i % 4);

  const std::string warning = StatusComment(camera);
  if (!warning.empty()) file->writeComment(warning);
  *file << camera.spec.name << "{";
  *file << "image_width" << camera.spec.width << "image_height" << camera.spec.height;
  *file << "camera_matrix" << camera_matrix;
  *file << "distortion_model" << DistortionModel(lens);
  *file << "distortion" << distortion;
  *file << "camera_from_lidar" << camera_from_lidar;
  *file << "}";
}

std::string RosLines(const Exported& camera, const std::string& lidar) {
  const Rigid3 lidar_from_camera = camera.calibration.camera_from_lidar.Inverse();
  const Eigen::Vector3d& t = lidar_from_camera.translation;
  const Eigen::Quaterniond q = text::Normalised(lidar_from_camera.rotation);
  const std::string child = camera.spec.name + "_optical_frame";
  const std::string warning = StatusComment(camera);
  return "\n# " + camera.spec.name + "\n" + (warning.empty() ? "" : "# " + warning + "\n") +
         "# ROS 2\nros2 run tf2_ros static_transform_publisher --x " + Number(t.x()) + " --y " +
         Number(t.y()) + " --z " + Number(t.z()) + " --qx " + Number(q.x()) + " --qy " +
         Number(q.y()) + " --qz " + Number(q.z()) + " --qw " + Number(q.w()) + " --frame-id " +
         lidar + " --child-frame-id " + child +
         "\n# ROS 1 (x y z qx qy qz qw parent child)\n"
         "rosrun tf2_ros static_transform_publisher " +
         List(t.data(), 3, " ") + " " + Number(q.x()) + " " + Number(q.y()) + " " + Number(q.z()) +
         " " + Number(q.w()) + " " + lidar + " " + child + "\n";
}

std::string KalibrMatrix(const std::string& name, const Rigid3& pose) {
  const Eigen::Matrix4d matrix = Matrix(pose);
  std::string text = "  " + name + ":\n";
  for (int row = 0; row < 4; ++row) {
    const Eigen::RowVector4d numbers = matrix.row(row);
    text += "  - [" + List(numbers.data(), 4) + "]\n";
  }
  return text;
}

std::string KalibrLens(const Lens& lens) {
  const bool fisheye = lens.model == Lens::Model::kFisheye;
  std::string text = "  camera_model: pinhole\n";
  const double intrinsics[] = {lens.fx, lens.fy, lens.cx, lens.cy};
  text += "  intrinsics: [" + List(intrinsics, 4) + "]\n";
  text += std::string("  distortion_model: ") + (fisheye ? "equidistant" : "radtan") + "\n";
  if (!fisheye && HasTerms(lens, 4)) {
    text +=
        "  # radtan holds k1 k2 p1 p2 only; this lens has more, so what stands here is cut off.\n"
        "  # All of OpenCV's k1 k2 p1 p2 k3 k4 k5 k6: [" +
        List(lens.distortion.data(), 8) + "]\n";
  }
  return text + "  distortion_coeffs: [" + List(lens.distortion.data(), 4) + "]\n";
}

std::string KalibrCamera(const std::vector<Exported>& cameras, std::size_t index) {
  const Exported& camera = cameras[index];
  const Rigid3& camera_from_lidar = camera.calibration.camera_from_lidar;
  const std::string warning = StatusComment(camera);
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

// Names of the LIDAR come from a file: only what a frame may be called goes on a command line.
std::string FrameName(const std::string& name) {
  std::string frame;
  for (const char c : name) {
    const bool good = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-';
    frame += good ? c : '_';
  }
  return frame.empty() ? "lidar" : frame;
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

void ExportRosStaticTransform(const std::filesystem::path& path, const Rig& rig,
                              const Calibration& calibration) {
  std::string text = std::string("# ") + kFrames +
                     "\n# ROS takes the pose of the child in the parent: what follows is the "
                     "camera's pose in the\n# LIDAR frame, point_in_lidar = lidar_from_camera * "
                     "point_in_camera, the inverse of\n# calibration.textproto.\n";
  for (const Exported& camera : Match(rig, calibration)) {
    text += RosLines(camera, FrameName(rig.lidar.name));
  }
  WriteFileAtomically(path, text);
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

std::vector<std::filesystem::path> ExportAll(const std::filesystem::path& dir, const Rig& rig,
                                             const Calibration& calibration) {
  const std::filesystem::path opencv = dir / "opencv.yaml";
  const std::filesystem::path ros = dir / "ros_static_transform.txt";
  const std::filesystem::path kalibr = dir / "kalibr_camchain.yaml";
  ExportOpenCv(opencv, rig, calibration);
  ExportRosStaticTransform(ros, rig, calibration);
  ExportKalibr(kalibr, rig, calibration);
  return {opencv, ros, kalibr};
}

}  // namespace rgbdt
