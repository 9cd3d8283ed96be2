#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>

#include "calib/camera/pixels.h"
#include "calib/camera/target_pose.h"
#include "calib/detect/image/image_edges.h"
#include "calib/detect/image/internal/board_sides.h"
#include "calib/detect/image/internal/clipped.h"
#include "calib/simulate/simulator.h"
#include "tests/unit/matchers.h"

namespace rgbdt {
namespace {

constexpr Utime kUtime = 1'433'160'000'000'000;

struct SideFigures {
  int sides = 0, seen = 0, beyond_3_sigma = 0;
  double squares = 0, normalised = 0, largest = 0;

  double rms() const { return std::sqrt(squares / (2 * seen)); }
  double z() const { return std::sqrt(normalised / (2 * seen)); }
};

// How far outwards of the truth a fitted side's end lies [px]: across the true side there.
double Off(const Camera& camera, const Rigid3& camera_from_target, const Eigen::Vector3d& from,
           const Eigen::Vector3d& to, double t, const Eigen::Vector2d& fitted) {
  const auto at = [&](double u) {
    return *camera.Project(camera_from_target * (from + u * (to - from)));
  };
  const Eigen::Vector2d along = (at(t + 1e-3) - at(t - 1e-3)).normalized();
  return (fitted - at(t)).dot(Eigen::Vector2d(along.y(), -along.x()));
}

void Add(const Camera& camera, const Target& target, const Rigid3& truth,
         const std::array<ImageSide, 4>& sides, SideFigures* figures) {
  const auto corners = target.OutlineCorners();
  for (std::size_t i = 0; i < 4; ++i) {
    ++figures->sides;
    EXPECT_NE(sides[i].seen, sides[i].curve.empty());
    EXPECT_EQ(sides[i].seen, sides[i].why.empty());
    if (!sides[i].seen) continue;
    ++figures->seen;
    const Eigen::Vector2d off(
        Off(camera, truth, corners[i], corners[(i + 1) % 4], 0, sides[i].curve.front()),
        Off(camera, truth, corners[i], corners[(i + 1) % 4], 1, sides[i].curve.back()));
    const Eigen::Vector2d ratio = off.cwiseQuotient(sides[i].covariance.diagonal().cwiseSqrt());
    figures->squares += off.squaredNorm();
    figures->normalised += ratio.squaredNorm();
    figures->largest = std::max(figures->largest, off.cwiseAbs().maxCoeff());
    figures->beyond_3_sigma += static_cast<int>((ratio.array().abs() > 3).count());
  }
}

// The pose as corners of 0.05 px give it: what is tested here is what comes after.
TargetPose PoseNear(const Camera& camera, const Target& target, const Rigid3& truth,
                    Random* random) {
  std::vector<Eigen::Vector2d> corners;
  for (const Eigen::Vector3d& point : target.InnerCorners()) {
    // Evenly within 0.087 px of it: sigma 0.05 px.
    corners.emplace_back(
        *camera.Project(truth * point) +
        Eigen::Vector2d(random->Uniform(-0.087, 0.087), random->Uniform(-0.087, 0.087)));
  }
  return PoseFromCorners(camera, target, corners)->pose;
}

TEST(RenderedSides, LieWhereTheTruthProjectsWithinTheirSigma) {
  std::map<std::string, SideFigures> figures;
  Random random(1);
  for (const simulate::Scene scene : {simulate::Scene::kOutdoor, simulate::Scene::kIndoor}) {
    simulate::Options options;
    options.scene = scene;
    simulate::Simulator simulator(options);
    for (int view = 0; view < 3; ++view) {
      const std::string name = std::to_string(view);
      simulator.ShowView(view, name);
      for (const CameraSpec& spec : simulator.rig().cameras) {
        const Camera camera(spec);
        const Image image = simulator.TakeImage(spec.name, kUtime);
        const Target& target = simulator.rig().target;
        const Rigid3 truth = simulator.truth().camera_from_lidar.at(spec.name) *
                             simulator.truth().lidar_from_target.at(name);
        Add(camera, target, truth,
            FitBoardSides(ToGrey(image), Clipped(image), camera, target,
                          PoseNear(camera, target, truth, &random)),
            &figures[spec.name]);
      }
    }
  }
  // Over 60 and more views of three scenes and six seeds: RMS 0.03 to 0.09 px in colour, 0.05 px
  // thermal, largest 0.51 px (a side with clouds and a roof behind it), two of three sides seen.
  for (const auto& [name, f] : figures) {
    RecordProperty(name + "_rms_px", std::to_string(f.rms()));
    RecordProperty(name + "_largest_px", std::to_string(f.largest));
    RecordProperty(name + "_normalised_error", std::to_string(f.z()));
    RecordProperty(name + "_seen", f.seen);
    EXPECT_GT(2 * f.seen, f.sides) << name;
    EXPECT_LT(f.rms(), 0.15) << name;
    EXPECT_LT(f.largest, 1.0) << name;
    EXPECT_GT(f.z(), 0.3) << name;
    EXPECT_LT(f.z(), 1.6) << name;
    EXPECT_LE(f.beyond_3_sigma, f.seen / 10) << name;
  }
}

TEST(RenderedSides, DetectionGivesPoseSigmaAndSides) {
  simulate::Simulator simulator{simulate::Options()};
  simulator.ShowView(1, "1");
  const CameraSpec& spec = simulator.rig().Camera("rgb");
  const Camera camera(spec);
  const Target& target = simulator.rig().target;
  const Rigid3 truth =
      simulator.truth().camera_from_lidar.at("rgb") * simulator.truth().lidar_from_target.at("1");
  const Image image = simulator.TakeImage("rgb", kUtime);
  const auto result = DetectImageEdges(image, camera, target, nullptr, CameraKind::kColor);
  ASSERT_TRUE(result.edges && result.edges->pose) << result.why;
  const ImageEdges& edges = *result.edges;
  EXPECT_TRUE(edges.pose->half_turn_known);
  const Vector6d delta = Log(truth * edges.pose->sensor_from_target.Inverse());
  EXPECT_LT(delta.dot(edges.pose->covariance.ldlt().solve(delta)), 22.5);  // 0.1% lie beyond
  EXPECT_GT(edges.corner_sigma_px, 0.01);
  EXPECT_LT(edges.corner_sigma_px, 0.1);
  EXPECT_THAT(edges.outline_corners[0],
              EigenNear(*camera.Project(truth * target.OutlineCorners()[0]), 0.5));
  EXPECT_THAT(edges.corners[0], EigenNear(*camera.Project(truth * target.InnerCorners()[0]), 0.3));
  SideFigures figures;
  Add(camera, target, truth, edges.sides, &figures);
  EXPECT_GE(figures.seen, 2);
  EXPECT_LT(figures.largest, 0.3);

  // Of a thermal image nobody knows which squares are the warmer ones.
  const auto thermal = DetectImageEdges(image, camera, target, nullptr, CameraKind::kThermal);
  ASSERT_TRUE(thermal.edges && thermal.edges->pose);
  EXPECT_FALSE(thermal.edges->pose->half_turn_known);

  // A person's four picks give the paper's edges and nothing else.
  const CornerSelection picks = simulator.PickCorners("rgb", kUtime);
  const auto picked = DetectImageEdges(image, camera, target, &picks, CameraKind::kColor);
  ASSERT_TRUE(picked.edges.has_value()) << picked.why;
  EXPECT_FALSE(picked.edges->pose.has_value());
  EXPECT_FALSE(picked.edges->sides[0].seen);
}

}  // namespace
}  // namespace rgbdt
