#include "calib/methods/gradient_orientation/by_gradient_orientation.h"

#include <cmath>

#include "tests/numbers.h"
#include "tests/unit/methods/scene/scene_world.h"

namespace rgbdt {
namespace {

using testing::HasSubstr;

constexpr int kRows = 9, kColumns = 11;
constexpr double kBeamStep = 0.01;  // [rad]

// A wall of points about x, in lines of equal elevation, seen from the origin.
Cloud Wall() {
  Cloud cloud;
  cloud.lines = kRows;
  cloud.beams = kColumns;
  for (int r = 0; r < kRows; ++r) {
    for (int c = 0; c < kColumns; ++c) {
      const double y = kBeamStep * (c - kColumns / 2);
      const double z = kBeamStep * (r - kRows / 2);
      cloud.points.push_back((5 * Eigen::Vector3d(1, y, z).normalized()).cast<float>());
      cloud.intensity.push_back(0);
    }
  }
  return cloud;
}

TEST(GradientsOf, ASlopeHasItsDirectionAndStrength) {
  Cloud cloud = Wall();
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    cloud.intensity[i] = 3 * cloud.points[i].y() / cloud.points[i].x();
  }
  const std::vector<CloudGradient> gradients = GradientsOf(cloud, CloudFeature::kIntensity);
  ASSERT_EQ(gradients.size(), cloud.size());
  const std::size_t middle = cloud.size() / 2;
  EXPECT_EQ(gradients[middle].point, middle);
  EXPECT_NEAR(gradients[middle].strength, 3, 0.01);
  EXPECT_THAT(gradients[middle].direction, EigenNear(Eigen::Vector3f::UnitY(), 1e-3F));
}

TEST(GradientsOf, OfTheRangePointToWhatIsFarther) {
  Cloud cloud = Wall();
  for (Eigen::Vector3f& p : cloud.points) p *= std::exp(p.z() / p.x());
  const std::vector<CloudGradient> gradients = GradientsOf(cloud, CloudFeature::kRange);
  const CloudGradient& middle = gradients[gradients.size() / 2];
  EXPECT_NEAR(middle.strength, 1, 0.01);
  EXPECT_THAT(middle.direction, EigenNear(Eigen::Vector3f::UnitZ(), 1e-3F));
}

TEST(GradientsOf, EvenSurfacesHaveNone) {
  EXPECT_TRUE(GradientsOf(Wall(), CloudFeature::kIntensity).empty());
}

// A camera at the LIDAR's place, whose image has one straight edge at an angle.
struct Ramp {
  explicit Ramp(double angle) {
    camera.name = "camera";
    camera.width = 101;
    camera.height = 101;
    camera.lens.fx = camera.lens.fy = 500;
    camera.lens.cx = camera.lens.cy = 50;
    camera.format = PixelFormat::kMono8;
    image.format = PixelFormat::kMono8;
    image.pixels.create(101, 101, CV_8UC1);
    for (int y = 0; y < 101; ++y) {
      for (int x = 0; x < 101; ++x) {
        image.pixels.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(
            128 + (x - 50) * std::cos(angle) + (y - 50) * std::sin(angle));
      }
    }
    cloud = Wall();
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      cloud.intensity[i] = cloud.points[i].y() / cloud.points[i].x();
    }
    Eigen::Matrix3d axes;
    axes << 0, -1, 0, 0, 0, -1, 1, 0, 0;
    camera_from_lidar.rotation = Eigen::Quaterniond(axes);
  }

  double Gom() const {
    return GradientAlignment(camera, {{"1", &cloud, &image}}, camera_from_lidar, {})
        .At(camera_from_lidar)
        .Gom();
  }

  CameraSpec camera;
  Image image;
  Cloud cloud;
  Rigid3 camera_from_lidar;
};

// GOM of two slopes is the cosine of the angle between them, whichever way they rise.
TEST(GradientAlignment, IsTheCosineOfTheAngleBetweenTwoSlopes) {
  EXPECT_NEAR(Ramp(0).Gom(), 1, 0.01);
  EXPECT_NEAR(Ramp(M_PI).Gom(), 1, 0.01);
  EXPECT_NEAR(Ramp(M_PI / 2).Gom(), 0, 0.05);
  EXPECT_NEAR(Ramp(M_PI / 3).Gom(), 0.5, 0.05);
}

TEST(GradientAlignment, IsLargestAtTheTruth) {
  const SceneWorld world(2);
  const Rigid3& truth = world.Truth(0);
  const GradientAlignment alignment(world.rig().cameras[0], world.Shots(0), truth, {});
  for (const Rigid3& turned : TurnedTwoDegrees(truth)) {
    EXPECT_LT(alignment.At(turned).Gom(), alignment.At(truth).Gom());
  }
}

TEST(AlignByGradientOrientation, EndsNearerThanItBegan) {
  const SceneWorld world(4);
  const Rigid3& truth = world.Truth(0);
  const Rigid3 start = GuessOff(truth, 1 * kDegree, 0.03, 5);
  GradientOrientationOptions options;
  options.most_points = 16000;  // with 8000 it loses its way
  options.swarm.rounds = 40;
  const SceneFit fit =
      AlignByGradientOrientation(world.rig().cameras[0], world.Shots(0), start, options);
  EXPECT_TRUE(fit.converged) << fit.why_not;
  EXPECT_LT(RotationDistance(fit.camera_from_lidar, truth), 0.5 * kDegree);
}

TEST(AlignByGradientOrientation, SaysThatACameraLooksElsewhere) {
  const SceneWorld world(1);
  const SceneFit fit = AlignByGradientOrientation(world.rig().cameras[0], world.Shots(0),
                                                  LookingAway(world.Truth(0)));
  EXPECT_FALSE(fit.converged);
  EXPECT_THAT(fit.why_not, HasSubstr("points with a gradient lie in the images"));
}

TEST(GradientAlignment, RefusesIntensitiesThatACloudHasNot) {
  SceneWorld world(1);
  world.clouds[0].intensity.clear();
  GradientOrientationOptions options;
  options.feature = CloudFeature::kIntensity;
  const auto make = [&] {
    GradientAlignment(world.rig().cameras[0], world.Shots(0), world.Truth(0), options);
  };
  EXPECT_THAT(InputErrorOf(make), HasSubstr("no intensities"));
  options.feature.reset();
  EXPECT_EQ(InputErrorOf(make), "");
}

}  // namespace
}  // namespace rgbdt
