#include <cctype>
#include <cmath>
#include <set>

#include "calib/files/atomic_file.h"
#include "calib/files/schema/exports.h"
#include "calib/files/schema/internal/export_parts.h"
#include "calib/files/schema/proto_convert.h"
#include "calib/model/errors.h"
#include "calib/model/printable.h"
#include "calib/model/text.h"

namespace rgbdt {
namespace {

using exports::Exported;
using exports::HashComment;
using exports::kFrames;
using exports::List;
using exports::StatusWarning;
using exports::YamlNumber;

constexpr char kDirection[] =
    "ROS takes the pose of the child in the parent: what follows is the camera's pose in the\n"
    "LIDAR frame, point_in_lidar = lidar_from_camera * point_in_camera, the inverse of\n"
    "calibration.textproto.";

constexpr char kFurtherDirection[] =
    "Of a LIDAR beside the first: its pose in the first one's frame, reference_from_lidar as in\n"
    "calibration.textproto.";

// One camera, or one LIDAR beside the reference, as ROS sees it.
struct Joint {
  std::string sensor, name, parent, child;
  Eigen::Vector3d xyz;      // of parent_from_child [m]
  Eigen::Quaterniond xyzw;  // its rotation
  std::string warning;      // empty: none
  bool is_camera = false;
};

bool IsFrameLetter(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-';
}

// Names of the rig come from a file: only what a frame may be called goes on a command line.
std::string Cleaned(const std::string& name, const std::string& otherwise) {
  std::string cleaned;
  for (const char c : name) cleaned += IsFrameLetter(c) ? c : '_';
  return cleaned.empty() || cleaned[0] == '-' ? otherwise : cleaned;
}

// What a user asks for is taken as it is or refused. "robot1/lidar" is one name.
std::string Checked(const std::string& name) {
  bool good = !name.empty() && name.front() != '-' && name.front() != '/' && name.back() != '/';
  for (const char c : name) good = good && (IsFrameLetter(c) || c == '.' || c == '/');
  if (good) return name;
  throw InputError("\"" + PrintableText(name) +
                   "\" is no name of a frame; expected letters, digits, _ - . and / in the middle");
}

std::string LidarFrame(const Rig& rig, const FrameNames& frames) {
  return frames.lidar.empty() ? Cleaned(rig.lidar.name, "lidar") : Checked(frames.lidar);
}

std::string CameraFrame(const std::string& camera, const FrameNames& frames) {
  const auto named = frames.cameras.find(camera);
  return named == frames.cameras.end() ? camera + "_optical_frame" : Checked(named->second);
}

std::string WarningOf(const LidarCalibration& lidar) {
  if (lidar.converged()) return {};
  std::string text = "WARNING: " + lidar.lidar + " did not converge: " + lidar.StatusText();
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < ' ') c = ' ';
  }
  return PrintableText(text);
}

Joint JointOf(const LidarCalibration& lidar, const std::string& reference) {
  const std::string child = Cleaned(lidar.lidar, "lidar2");
  return {child,
          child + "_joint",
          reference,
          child,
          lidar.reference_from_lidar.translation,
          text::Normalised(lidar.reference_from_lidar.rotation),
          WarningOf(lidar)};
}

// What the frames are, and which way the transforms go.
std::string DirectionOf(const Calibration& calibration) {
  std::string text = std::string(kFrames) + "\n" + kDirection;
  if (!calibration.lidars.empty()) text += std::string("\n") + kFurtherDirection;
  return text;
}

std::vector<Joint> JointsOf(const Rig& rig, const Calibration& calibration,
                            const FrameNames& frames) {
  for (const auto& named : frames.cameras) rig.Camera(named.first);
  const std::string lidar = LidarFrame(rig, frames);
  std::set<std::string> taken{lidar};
  std::vector<Joint> joints;
  const auto take = [&](const std::string& child) {
    if (!taken.insert(child).second) {
      throw InputError("the frame \"" + child +
                       "\" twice; give each camera and the LIDAR its own (a further LIDAR's "
                       "is its name in the rig file)");
    }
  };
  for (const Exported& camera : exports::Match(rig, calibration)) {
    const Rigid3 lidar_from_camera = camera.calibration.camera_from_lidar.Inverse();
    const std::string child = CameraFrame(camera.spec.name, frames);
    take(child);
    joints.push_back({camera.spec.name, camera.spec.name + "_optical_joint", lidar, child,
                      lidar_from_camera.translation, text::Normalised(lidar_from_camera.rotation),
                      StatusWarning(camera), true});
  }
  for (const LidarCalibration& further : calibration.lidars) {
    joints.push_back(JointOf(further, lidar));
    take(joints.back().child);
  }
  return joints;
}

// The options of ROS 2's static_transform_publisher.
std::string Ros2Options(const Joint& joint) {
  const Eigen::Vector3d& t = joint.xyz;
  const Eigen::Quaterniond& q = joint.xyzw;
  return "--x " + Exact(t.x()) + " --y " + Exact(t.y()) + " --z " + Exact(t.z()) + " --qx " +
         Exact(q.x()) + " --qy " + Exact(q.y()) + " --qz " + Exact(q.z()) + " --qw " +
         Exact(q.w()) + " --frame-id " + joint.parent + " --child-frame-id " + joint.child;
}

std::string CommandLines(const Joint& joint) {
  return "\n" + HashComment(joint.sensor) +
         (joint.warning.empty() ? "" : HashComment(joint.warning)) +
         "# ROS 2\nros2 run tf2_ros static_transform_publisher " + Ros2Options(joint) +
         "\n# ROS 1 (x y z qx qy qz qw parent child)\n"
         "rosrun tf2_ros static_transform_publisher " +
         List(joint.xyz.data(), 3) + " " + List(joint.xyzw.coeffs().data(), 4) + " " +
         joint.parent + " " + joint.child + "\n";
}

std::string LaunchNode(const Joint& joint) {
  return (joint.warning.empty() ? "" : "  # " + joint.warning + "\n") +
         "  - node:\n"
         "      pkg: \"tf2_ros\"\n"
         "      exec: \"static_transform_publisher\"\n"
         "      name: \"publish_pose_of_" +
         joint.sensor + "\"\n      args: \"" + Ros2Options(joint) + "\"\n";
}

// rotation = Rz(yaw) * Ry(pitch) * Rx(roll), as roll, pitch, yaw [rad]. Roll is what is left once
// yaw and pitch are undone, so a pitch of 90 degrees, which leaves yaw free, costs no digits.
Eigen::Vector3d RollPitchYaw(const Eigen::Quaterniond& rotation) {
  const Eigen::Matrix3d m = rotation.toRotationMatrix();
  const double yaw = std::atan2(m(1, 0), m(0, 0));
  const double pitch = std::atan2(-m(2, 0), std::hypot(m(0, 0), m(1, 0)));
  const Eigen::Matrix3d rest = Eigen::AngleAxisd(-pitch, Eigen::Vector3d::UnitY()) *
                               Eigen::AngleAxisd(-yaw, Eigen::Vector3d::UnitZ()) * m;
  return {std::atan2(rest(2, 1), rest(2, 2)), pitch, yaw};
}

// XML ends a comment at two dashes.
std::string XmlComment(std::string text) {
  for (std::size_t at = text.find("--"); at != std::string::npos; at = text.find("--", at)) {
    text.insert(at + 1, " ");
  }
  return "<!-- " + text + " -->\n";
}

std::string UrdfJoint(const Joint& joint) {
  const Eigen::Vector3d rpy = RollPitchYaw(joint.xyzw);
  return "\n" + (joint.warning.empty() ? "" : "  " + XmlComment(joint.warning)) +
         "  <link name=\"" + joint.child + "\"/>\n  <joint name=\"" + joint.name +
         "\" type=\"fixed\">\n    <parent link=\"" + joint.parent + "\"/>\n    <child link=\"" +
         joint.child + "\"/>\n    <origin xyz=\"" + List(joint.xyz.data(), 3) + "\" rpy=\"" +
         List(rpy.data(), 3) + "\"/>\n  </joint>\n";
}

// Autoware's own description turns a camera_link (x forward, y left, z up) into its optical frame
// by rpy -90, 0, -90 degrees: exactly these axes.
Rigid3 OpticalFromLink() {
  Eigen::Matrix3d rotation;
  rotation << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  return {Eigen::Quaterniond(rotation), Eigen::Vector3d::Zero()};
}

std::string LinkName(const std::string& camera, const FrameNames& frames) {
  if (frames.cameras.count(camera) == 0) return camera + "/camera_link";
  const std::string optical = "_optical", frame = CameraFrame(camera, frames);
  const std::size_t at = frame.find(optical);
  if (at == std::string::npos || at == 0) return frame + "_link";
  return std::string(frame).erase(at, optical.size());
}

std::string AutowareEntry(const std::string& name, const Rigid3& parent_from_link,
                          const std::string& warning) {
  const Eigen::Vector3d& t = parent_from_link.translation;
  const Eigen::Vector3d rpy = RollPitchYaw(text::Normalised(parent_from_link.rotation));
  return (warning.empty() ? "" : "  # " + warning + "\n") + "  " + name +
         ":\n    x: " + YamlNumber(t.x()) + "\n    y: " + YamlNumber(t.y()) +
         "\n    z: " + YamlNumber(t.z()) + "\n    roll: " + YamlNumber(rpy.x()) +
         "\n    pitch: " + YamlNumber(rpy.y()) + "\n    yaw: " + YamlNumber(rpy.z()) + "\n";
}

}  // namespace

void ExportRosStaticTransform(const std::filesystem::path& path, const Rig& rig,
                              const Calibration& calibration, const FrameNames& frames) {
  std::string text = HashComment(DirectionOf(calibration));
  for (const Joint& joint : JointsOf(rig, calibration, frames)) text += CommandLines(joint);
  WriteFileAtomically(path, text);
}

void ExportRosLaunch(const std::filesystem::path& path, const Rig& rig,
                     const Calibration& calibration, const FrameNames& frames) {
  std::string text =
      HashComment("For `ros2 launch FILE`. " + DirectionOf(calibration)) + "launch:\n";
  for (const Joint& joint : JointsOf(rig, calibration, frames)) text += LaunchNode(joint);
  WriteFileAtomically(path, text);
}

void ExportUrdf(const std::filesystem::path& path, const Rig& rig, const Calibration& calibration,
                const FrameNames& frames) {
  const std::vector<Joint> joints = JointsOf(rig, calibration, frames);
  std::string text =
      "<?xml version=\"1.0\"?>\n" +
      XmlComment(DirectionOf(calibration) +
                 "\nrpy is roll, pitch, yaw [rad]: rotation = Rz(yaw) * Ry(pitch) * Rx(roll).\n"
                 "Where a robot's own URDF has the LIDAR's link, leave it out here.") +
      "<robot name=\"" + Cleaned(rig.name, "rig") + "\">\n  <link name=\"" + joints[0].parent +
      "\"/>\n";
  for (const Joint& joint : joints) text += UrdfJoint(joint);
  WriteFileAtomically(path, text + "</robot>\n");
}

void ExportAutoware(const std::filesystem::path& path, const Rig& rig,
                    const Calibration& calibration, const FrameNames& frames) {
  std::set<std::string> names{LidarFrame(rig, frames)};
  std::string entries;
  for (const Joint& joint : JointsOf(rig, calibration, frames)) {
    Rigid3 parent_from_link{joint.xyzw, joint.xyz};
    std::string name = joint.child;
    if (joint.is_camera) {
      parent_from_link = parent_from_link * OpticalFromLink();
      name = LinkName(joint.sensor, frames);
    }
    if (!names.insert(name).second) {
      throw InputError("the frame \"" + name +
                       "\" twice: Autoware's camera_link is called as the optical frame without "
                       "\"_optical\"; name the cameras' frames otherwise");
    }
    entries += AutowareEntry(name, parent_from_link, joint.warning);
  }
  std::string text = HashComment(
      "Autoware's sensor_kit_calibration.yaml, in metres and radians: the pose of the child in "
      "the\n"
      "parent, point_in_lidar = Rz(yaw) * Ry(pitch) * Rx(roll) * point_in_child + (x, y, z), the\n"
      "inverse of calibration.textproto. The parent is the LIDAR's frame: x forward, y left, z "
      "up.\n"
      "A camera's child is its camera_link, x forward, y left, z up: Autoware's own description\n"
      "makes the optical frame of it.");
  if (!calibration.lidars.empty()) text += HashComment(kFurtherDirection);
  WriteFileAtomically(path, text + LidarFrame(rig, frames) + ":\n" + entries);
}

}  // namespace rgbdt
