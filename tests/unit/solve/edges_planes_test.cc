#include "calib/solve/internal/edges_planes.h"

#include "calib/methods/calibrate.h"
#include "tests/unit/solve/solve_world.h"

namespace rgbdt {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;

// Planes turned about the LIDAR while edges stay.
TEST(HoldEdgesAgainstPlanes, WhereTheyContradictEachOtherTheSigmaHasTheirDistanceInIt) {
  SolveWorldOptions options;
  options.views = 10;
  SolveWorld world(options);
  CalibrateOptions brief;
  brief.diagnostics = false;  // it is part of the result, not of what is told about it
  const auto solved = [&] { return Calibrate(world.rig, world.detections, brief).cameras; };
  for (const CameraReport& camera : solved()) {
    EXPECT_LT(camera.edges_planes.value().chi2, 22.5);
    EXPECT_THAT(camera.warnings, Not(Contains(HasSubstr("was enlarged"))));
  }
  Rigid3 turn;
  turn.rotation = Eigen::AngleAxisd(0.02, Eigen::Vector3d::UnitZ());
  Eigen::Matrix4d q = Eigen::Matrix4d::Identity();
  q.topLeftCorner<3, 3>() = turn.rotation.toRotationMatrix();
  for (std::size_t v = 0; v < world.detections.size(); ++v) {
    CloudEdges& cloud = world.CloudAt(v);
    cloud.centre = turn * cloud.centre;
    cloud.scatter = q * cloud.scatter * q.transpose();
    cloud.raw_scatter = q * cloud.raw_scatter * q.transpose();
    for (PointGroup& group : cloud.groups) group.scatter = q * group.scatter * q.transpose();
  }
  for (const CameraReport& camera : solved()) {
    EXPECT_TRUE(camera.edges_planes.value().sigma_enlarged);
    EXPECT_THAT(camera.warnings, Contains(HasSubstr("was enlarged")));
  }
  const JointResult held = HoldEdgesAgainstPlanes(SolveJointly(SolveSession(world).Joint()));
  for (std::size_t c = 0; c < held.joint.cameras.size(); ++c) {
    CameraReport report = held.joint.cameras[c].views.report;
    const Matrix6d stated = CovarianceOf(held, c).topLeftCorner<6, 6>();
    report.calibration.covariance = stated;
    report = EnlargedWhereTheyDiffer(std::move(report));
    const Halves& apart = report.edges_planes.value();
    EXPECT_GT(apart.chi2, 22.5);
    EXPECT_GT(apart.difference.rotation_deg, 0.3);
    EXPECT_NEAR(apart.sigma_enlarged.value(), std::sqrt(apart.chi2 / 6), 1e-9);
    EXPECT_TRUE(report.calibration.covariance->isApprox(apart.chi2 / 6 * stated));
  }
}

}  // namespace
}  // namespace rgbdt
