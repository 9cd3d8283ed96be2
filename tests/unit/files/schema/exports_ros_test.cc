#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

#include "calib/files/atomic_file.h"
#include "calib/files/schema/exports.h"
#include "tests/unit/files/test_data.h"
#include "tests/unit/matchers.h"

namespace rgbdt {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr double kPi = 3.14159265358979323846;

class RosExports : public ::testing::Test {
 protected:
  RosExports() : rig_(test::MakeRig()), calibration_(test::MakeReport().ToCalibration()) {
    calibration_.cameras[1].camera_from_lidar = test::MakePose(0.6, {0.3, 0.1, -0.2});
  }

  const Rigid3& Pose(std::size_t camera) const {
    return calibration_.cameras[camera].camera_from_lidar;
  }
  std::string Lines(const FrameNames& frames = {}) const {
    ExportRosStaticTransform(dir_ / "ros.txt", rig_, calibration_, frames);
    return ReadWholeFile(dir_ / "ros.txt");
  }
  std::string Launch(const FrameNames& frames = {}) const {
    ExportRosLaunch(dir_ / "launch.yaml", rig_, calibration_, frames);
    return ReadWholeFile(dir_ / "launch.yaml");
  }
  std::string Urdf(const FrameNames& frames = {}) const {
    ExportUrdf(dir_ / "rig.urdf", rig_, calibration_, frames);
    return ReadWholeFile(dir_ / "rig.urdf");
  }

  std::string Autoware(const FrameNames& frames = {}) const {
    ExportAutoware(dir_ / "kit.yaml", rig_, calibration_, frames);
    return ReadWholeFile(dir_ / "kit.yaml");
  }

  test::TempDir dir_;
  Rig rig_;
  Calibration calibration_;
};

struct Published {
  Rigid3 parent_from_child;
  std::string parent, child;
};

std::string Behind(const std::string& text, const std::string& word) {
  const std::size_t at = text.find(word);
  EXPECT_NE(at, std::string::npos) << word << " is not in: " << text;
  return at == std::string::npos ? "" : text.substr(at + word.size());
}

// "--name value --name value ...", as ROS 2's static_transform_publisher takes it.
Published FromOptions(const std::string& line) {
  std::istringstream words(line);
  std::map<std::string, std::string> values;
  std::string name, value;
  while (words >> name >> value) values[name] = value;
  EXPECT_EQ(values.size(), 9u) << line;
  const auto number = [&](const char* key) { return std::stod(values.at(key)); };
  const Eigen::Quaterniond q(number("--qw"), number("--qx"), number("--qy"), number("--qz"));
  return {{q, {number("--x"), number("--y"), number("--z")}},
          values.at("--frame-id"),
          values.at("--child-frame-id")};
}

// As URDF defines it: rolled about x, then pitched about y, then yawed about z, all axes fixed.
Published FromUrdf(const std::string& joint) {
  const auto attribute = [&](const std::string& element, const std::string& name) {
    const std::string value = Behind(Behind(joint, "<" + element), name + "=\"");
    return value.substr(0, value.find('"'));
  };
  Published out;
  out.parent = attribute("parent", "link");
  out.child = attribute("child", "link");
  Eigen::Vector3d rpy;
  std::istringstream origin(attribute("origin", "xyz") + " " + attribute("origin", "rpy"));
  Eigen::Vector3d& t = out.parent_from_child.translation;
  origin >> t.x() >> t.y() >> t.z() >> rpy[0] >> rpy[1] >> rpy[2];
  EXPECT_FALSE(origin.fail()) << joint;
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  for (int axis = 0; axis < 3; ++axis) {
    rotation = Eigen::AngleAxisd(rpy[axis], Eigen::Vector3d::Unit(axis)) * rotation;
  }
  out.parent_from_child.rotation = Eigen::Quaterniond(rotation);
  return out;
}

TEST_F(RosExports, CommandLinesHoldTheCamerasPoseInTheLidarFrame) {
  const std::string text = Lines();
  EXPECT_THAT(text, HasSubstr("point_in_lidar = lidar_from_camera * point_in_camera"));
  const std::string ros2 = Behind(text, "ros2 run tf2_ros static_transform_publisher ");
  const Published published = FromOptions(ros2.substr(0, ros2.find('\n')));
  EXPECT_EQ(published.parent, "scanner");
  EXPECT_EQ(published.child, "rgb_optical_frame");
  EXPECT_THAT(published.parent_from_child.Inverse(), Rigid3Near(Pose(0), 1e-9, 1e-9));

  std::istringstream ros1(Behind(text, "rosrun tf2_ros static_transform_publisher "));
  Rigid3 lidar_from_camera;
  Eigen::Vector3d& t = lidar_from_camera.translation;
  Eigen::Quaterniond& q = lidar_from_camera.rotation;
  std::string parent, child;
  ros1 >> t.x() >> t.y() >> t.z() >> q.x() >> q.y() >> q.z() >> q.w() >> parent >> child;
  EXPECT_EQ(parent, "scanner");
  EXPECT_EQ(child, "rgb_optical_frame");
  EXPECT_THAT(lidar_from_camera.Inverse(), Rigid3Near(Pose(0), 1e-9, 1e-9));
}

TEST_F(RosExports, TheLaunchFilePublishesEachCamera) {
  const std::string text = Launch();
  EXPECT_THAT(text, HasSubstr("point_in_lidar = lidar_from_camera * point_in_camera"));
  EXPECT_THAT(text, HasSubstr("\nlaunch:\n  - node:\n      pkg: \"tf2_ros\"\n"
                              "      exec: \"static_transform_publisher\"\n"
                              "      name: \"publish_pose_of_rgb\"\n      args: \"--x "));
  std::string rest = text;
  for (std::size_t i = 0; i < 2; ++i) {
    rest = Behind(rest, "args: \"");
    const Published published = FromOptions(rest.substr(0, rest.find('"')));
    EXPECT_EQ(published.parent, "scanner");
    EXPECT_EQ(published.child, calibration_.cameras[i].camera + "_optical_frame");
    EXPECT_THAT(published.parent_from_child.Inverse(), Rigid3Near(Pose(i), 1e-9, 1e-9));
  }
  EXPECT_THAT(rest, Not(HasSubstr("args")));
}

TEST_F(RosExports, TheUrdfHasAFixedJointForEachCamera) {
  const std::string text = Urdf();
  EXPECT_THAT(text, HasSubstr("point_in_lidar = lidar_from_camera * point_in_camera"));
  EXPECT_THAT(text, HasSubstr("  <link name=\"scanner\"/>\n"));
  std::string rest = text;
  for (std::size_t i = 0; i < 2; ++i) {
    const std::string& camera = calibration_.cameras[i].camera;
    EXPECT_THAT(text, HasSubstr("  <link name=\"" + camera + "_optical_frame\"/>\n"));
    std::string joint = "<joint name=\"";
    joint.append(camera).append("_optical_joint\" type=\"fixed\">");
    rest = Behind(rest, joint);
    const Published published = FromUrdf(rest);
    EXPECT_EQ(published.parent, "scanner");
    EXPECT_EQ(published.child, camera + "_optical_frame");
    EXPECT_THAT(published.parent_from_child.Inverse(), Rigid3Near(Pose(i), 1e-9, 1e-9));
  }
}

// A camera on its side has a pitch of 90 degrees: roll and yaw turn about one axis there.
TEST_F(RosExports, RollPitchYawHoldsForEveryPose) {
  Random random(5);
  for (int i = 0; i < 200; ++i) {
    Rigid3 lidar_from_camera = random.Pose();
    if (i % 2 == 0) {
      const double off = std::pow(10.0, -random.Uniform(2, 18));
      const double pitch = (i % 4 == 0 ? 1 : -1) * (kPi / 2 - off);
      lidar_from_camera.rotation =
          Eigen::AngleAxisd(random.Uniform(-3, 3), Eigen::Vector3d::UnitZ()) *
          Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(random.Uniform(-3, 3), Eigen::Vector3d::UnitX());
    }
    calibration_.cameras[0].camera_from_lidar = lidar_from_camera.Inverse();
    EXPECT_THAT(FromUrdf(Behind(Urdf(), "<joint")).parent_from_child.Inverse(),
                Rigid3Near(Pose(0), 1e-9, 1e-9));
  }
}

TEST_F(RosExports, FramesAreCalledAsTheUserSays) {
  const FrameNames frames{"robot1/velodyne", {{"thermal", "flir_optical"}}};
  for (const std::string& text : {Lines(frames), Launch(frames)}) {
    EXPECT_THAT(text, HasSubstr("--frame-id robot1/velodyne --child-frame-id rgb_optical_frame"));
    EXPECT_THAT(text, HasSubstr("--frame-id robot1/velodyne --child-frame-id flir_optical"));
  }
  const std::string urdf = Urdf(frames);
  EXPECT_THAT(urdf, HasSubstr("<link name=\"robot1/velodyne\"/>"));
  EXPECT_THAT(urdf, HasSubstr("<link name=\"flir_optical\"/>"));
  EXPECT_THAT(urdf, HasSubstr("<child link=\"flir_optical\"/>"));
}

// Its camera_link looks along x; Autoware turns it by rpy -90, 0, -90 degrees to the optical frame.
TEST_F(RosExports, AutowaresKitHoldsTheCameraLinksPose) {
  const std::string text = Autoware({"kit", {{"thermal", "flir/camera_optical_link"}}});
  EXPECT_THAT(text, HasSubstr("\nkit:\n  rgb/camera_link:\n    x: "));
  EXPECT_THAT(text, HasSubstr("\n  flir/camera_link:\n    x: "));
  std::string rest = text;
  for (std::size_t i = 0; i < 2; ++i) {
    rest = Behind(rest, "/camera_link:\n");
    std::map<std::string, double> values;
    std::istringstream words(rest);
    for (int line = 0; line < 6; ++line) {
      std::string name;
      words >> name >> values[name];
    }
    const auto turn = [](double roll, double pitch, double yaw) {
      return Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) *
             Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitY()) *
             Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitX());
    };
    const Rigid3 lidar_from_link{turn(values["roll:"], values["pitch:"], values["yaw:"]),
                                 {values["x:"], values["y:"], values["z:"]}};
    const Rigid3 link_from_optical{turn(-kPi / 2, 0, -kPi / 2), {0, 0, 0}};
    EXPECT_THAT((lidar_from_link * link_from_optical).Inverse(), Rigid3Near(Pose(i), 1e-9, 1e-9));
  }
}

TEST_F(RosExports, AutowaresNamesAreToldApart) {
  EXPECT_THAT(test::ErrorOf([&] {
                Autoware({"", {{"rgb", "cam_optical_a"}, {"thermal", "cam_a_optical"}}});
              }),
              HasSubstr("\"cam_a\" twice"));
  EXPECT_THAT(test::ErrorOf([&] {
                Autoware({"cam", {{"rgb", "cam_optical"}}});
              }),
              HasSubstr("\"cam\" twice"));
  EXPECT_THAT(Autoware({"", {{"rgb", "_optical"}, {"thermal", "eye"}}}),
              testing::AllOf(HasSubstr("  _optical_link:\n"), HasSubstr("  eye_link:\n")));
}

TEST_F(RosExports, WhatIsNoNameOfAFrameIsRefusedBeforeAnythingIsWritten) {
  const auto refused = [&](const FrameNames& frames) {
    return test::ErrorOf([&] { ExportAll(dir_ / "out", rig_, calibration_, frames); });
  };
  for (const std::string name : {"a b", "/lidar", "lidar/", "-lidar", "x;y", "\"", "a\nb"}) {
    std::string shown = name;
    std::replace(shown.begin(), shown.end(), '\n', '?');
    EXPECT_THAT(refused({name, {}}), HasSubstr("no name of a frame")) << shown;
    EXPECT_THAT(refused({"", {{"rgb", name}}}), HasSubstr("no name of a frame")) << shown;
  }
  EXPECT_THAT(refused({"", {{"rgb", ""}}}), HasSubstr("no name of a frame"));
  EXPECT_THAT(refused({"rgb_optical_frame", {}}), HasSubstr("\"rgb_optical_frame\" twice"));
  EXPECT_THAT(refused({"", {{"rgb", "cam"}, {"thermal", "cam"}}}), HasSubstr("\"cam\" twice"));
  EXPECT_THAT(refused({"", {{"front", "cam"}}}), HasSubstr("front"));
  EXPECT_FALSE(std::filesystem::exists(dir_ / "out"));
}

TEST_F(RosExports, NamesOfTheRigCannotLeaveTheirPlace) {
  rig_.lidar.name = "x; rm -rf $HOME\n\"><";
  rig_.name = "\"><robot name=\"";
  EXPECT_THAT(Lines(), HasSubstr("--frame-id x__rm_-rf__HOME____ "));
  EXPECT_THAT(Urdf(), HasSubstr("<robot name=\"___robot_name__\">"));
  EXPECT_THAT(Urdf(), HasSubstr("<link name=\"x__rm_-rf__HOME____\"/>"));
  rig_.lidar.name = "";
  EXPECT_THAT(Launch(), HasSubstr("--frame-id lidar "));
}

TEST_F(RosExports, ADetailCannotEndAComment) {
  calibration_.cameras[0].status = SolveStatus::kNotConverged;
  calibration_.cameras[0].detail = "--> 1 --- 2 --";
  EXPECT_THAT(Urdf(), HasSubstr("not converged: - -> 1 - - - 2 - - -->"));
}

}  // namespace
}  // namespace rgbdt
