#include "calib/solve/internal/given_wrong.h"

#include "calib/camera/target_pose.h"
#include "tests/unit/solve/joint_reports.h"

namespace rgbdt {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

SolveWorldOptions Drawn(std::uint32_t seed) {
  SolveWorldOptions options = Views(10);
  options.seed = seed;
  options.draw_nuisances = true;
  return options;
}

// Boards as a detector has them that believes the rig.
Report Believed(SolveWorld world) {
  for (std::size_t c = 0; c < 2; ++c) {
    for (std::size_t v = 0; v < world.detections.size(); ++v) {
      ImageEdges& image = world.ImageAt(v, c);
      const auto found =
          PoseFromCorners(Camera(world.rig.cameras[c]), world.rig.target, image.corners);
      image.pose->sensor_from_target = found->pose.sensor_from_target;
      image.pose->covariance = found->pose.covariance;
    }
  }
  return Calibrate(world.rig, world.detections, Brief());
}

const Cause* Find(const CameraReport& camera, const std::string& name) {
  for (const Cause& cause : camera.causes) {
    if (cause.name == name) return &cause;
  }
  return nullptr;
}

TEST(GivenWrong, NothingIsWhereAllIsAsStated) {
  int alarms = 0;
  double focal = 0;
  constexpr int kWorlds = 40;
  for (int i = 0; i < kWorlds; ++i) {
    const SolveWorld world(Drawn(static_cast<std::uint32_t>(100 + i)));
    for (const CameraReport& camera : Calibrate(world.rig, world.detections, Brief()).cameras) {
      for (const Cause& cause : camera.causes) alarms += cause.Sigmas() >= kGivenWrongSigmas;
      const Cause* const found = Find(camera, "focal length");
      ASSERT_NE(found, nullptr);
      focal += found->chi2 / (2 * kWorlds * camera.variance_factor);
    }
  }
  EXPECT_LE(alarms, 3);
  EXPECT_NEAR(focal, 1, 0.5);
}

// A lens that is taken for exact, so that nothing heals it.
TEST(GivenWrong, AFocalLengthIsNamedAndWhatItMovesForetold) {
  SolveWorld world(Drawn(1));
  Lens& lens = world.rig.cameras[0].lens;
  lens.fx *= 1.003;
  lens.fy *= 1.003;
  const Report report = Believed(world);
  const Cause& cause = report.cameras[0].causes.at(0);
  EXPECT_EQ(cause.name, "focal length");
  EXPECT_GT(cause.Sigmas(), kGivenWrongSigmas);
  EXPECT_THAT(cause.words, AllOf(HasSubstr("too long"), HasSubstr("rgbdt intrinsics")));
  const double moved = std::sqrt(Chi2(world, report, 0));
  EXPECT_NEAR(cause.moves_sigma.value_or(0), moved, 0.3 * moved);
}

TEST(GivenWrong, TheImagesCentreIsNamed) {
  SolveWorld world(Drawn(2));
  world.rig.cameras[0].lens.cx += 0.02 * world.rig.cameras[0].width;
  const Cause cause = Believed(world).cameras[0].causes.at(0);
  EXPECT_EQ(cause.name, "image centre");
  EXPECT_GT(cause.Sigmas(), kGivenWrongSigmas);
  EXPECT_THAT(cause.words, HasSubstr("px away"));
}

// They share boards, and with them its mistakes.
TEST(GivenWrong, AnotherCamerasLensIsNamedToo) {
  SolveWorld world(Drawn(2));
  world.rig.cameras[0].lens.distortion = {};
  for (const CameraReport& camera : Believed(world).cameras) {
    const Cause* const distortion = Find(camera, "distortion");
    ASSERT_NE(distortion, nullptr);
    EXPECT_GT(distortion->Sigmas(), kGivenWrongSigmas);
    EXPECT_THAT(distortion->words, HasSubstr(world.rig.cameras[0].name));
  }
}

TEST(GivenWrong, SquaresAreNamedWithTheirSize) {
  SolveWorld world(Drawn(3));
  const double truth = world.rig.target.square_m;
  world.rig.target.square_m *= 1.03;
  for (const CameraReport& camera : Believed(world).cameras) {
    const Cause* const squares = Find(camera, "squares");
    ASSERT_NE(squares, nullptr);
    EXPECT_GT(squares->Sigmas(), kGivenWrongSigmas);
    EXPECT_THAT(squares->words, HasSubstr("smaller than given"));
    double found_mm = 0;
    std::sscanf(squares->words.substr(squares->words.find(": ")).c_str(), ": %lf mm", &found_mm);
    EXPECT_NEAR(found_mm, 1000 * truth, 0.005 * 1000 * truth);
  }
}

TEST(GivenWrong, ABoardThatIsWiderThanGivenIsNamed) {
  SolveWorld world(Drawn(4));
  world.rig.target.width_m -= 0.03;
  for (const CameraReport& camera : Believed(world).cameras) {
    const Cause* const size = Find(camera, "board's size");
    ASSERT_NE(size, nullptr);
    EXPECT_GT(size->Sigmas(), kGivenWrongSigmas);
    EXPECT_THAT(size->words, HasSubstr("wider"));
  }
}

TEST(GivenWrong, APatternThatLiesElsewhereOnTheBoardIsNamed) {
  SolveWorld world(Drawn(5));
  world.rig.target.pattern_offset_m.x() -= 0.02;
  for (const CameraReport& camera : Believed(world).cameras) {
    const Cause* const place = Find(camera, "pattern's place");
    ASSERT_NE(place, nullptr);
    EXPECT_GT(place->Sigmas(), kGivenWrongSigmas);
    EXPECT_THAT(place->words, HasSubstr("+20 +- "));
  }
}

// As a cloud in which all is 3% too large looks to a rig that has its board right.
TEST(GivenWrong, ACloudOfAnotherScaleIsNamed) {
  SolveWorldOptions options = Drawn(6);
  options.views = 20;
  SolveWorld world(options);
  world.rig.target.square_m /= 1.03;
  world.rig.target.width_m /= 1.03;
  world.rig.target.height_m /= 1.03;
  for (const CameraReport& camera : Believed(world).cameras) {
    ASSERT_GE(camera.causes.size(), 2U);
    EXPECT_TRUE(camera.causes[0].name == "cloud's scale" ||
                camera.causes[1].name == "cloud's scale");
    const Cause* const scale = Find(camera, "cloud's scale");
    EXPECT_GT(scale->Sigmas(), kGivenWrongSigmas);
    EXPECT_THAT(scale->words, HasSubstr("too large"));
  }
}

// Its lens is stated with an uncertainty: the one that is found is used.
TEST(BeyondPriors, ABeamThatIsWiderThanAnyIsNamed) {
  SolveWorldOptions options = Views(10);
  options.shared[kFarShift] = 0.012;
  const SolveWorld world(options);
  const Report report = Calibrate(world.rig, world.detections, Brief());
  const Cause* const found = Find(report.cameras[0], "beams or board");
  ASSERT_NE(found, nullptr);
  EXPECT_GT(found->Sigmas(), kGivenWrongSigmas);
  EXPECT_THAT(found->words, AllOf(HasSubstr("beam edge, far background"), HasSubstr("data sheet")));
}

// The data tell its shape far better than its prior does: it is told, and the result is as good.
TEST(BeyondPriors, ABoardThatIsTwistedFarIsToldAndMovesLittle) {
  SolveWorldOptions options = Views(10);
  options.print_sigma = kUsualPrintSigma;
  options.shared[kTwist] = 0.006;
  const SolveWorld world(options);
  const Report report = Calibrate(world.rig, world.detections, Brief());
  for (std::size_t c = 0; c < 2; ++c) {
    EXPECT_LT(Chi2(world, report, c), kMostChi2);
    const Cause* const found = Find(report.cameras[c], "board's shape");
    ASSERT_NE(found, nullptr);
    EXPECT_THAT(found->words, AllOf(HasSubstr("twist: "), HasSubstr("where 0.0 +- 1.0 mm")));
    EXPECT_GT(found->Sigmas(), kGivenWrongSigmas);
    ASSERT_TRUE(found->moves_sigma);
    EXPECT_LT(*found->moves_sigma, 1);
  }
}

// Stated as exact, which it cannot be: the images alone say so, and what it should be.
TEST(OpenExactLenses, ALensThatImagesRefuteIsFound) {
  SolveWorld world(Drawn(4));
  Lens& lens = world.rig.cameras[0].lens;
  lens.fx *= 1.05;
  lens.fy *= 1.05;
  ASSERT_TRUE(world.rig.cameras[0].LensUncertaintyOrUsual().exact());
  const Report report = Believed(world);
  EXPECT_LT(Chi2(world, report, 0), kMostChi2);
  const Cause& cause = report.cameras[0].causes.at(0);
  EXPECT_EQ(cause.name, "focal length");
  EXPECT_GT(cause.Sigmas(), kGivenWrongSigmas);
}

TEST(GivenWrong, ALensThatWasRefutedIsNamedAndMovesNothingMore) {
  SolveWorld world(Drawn(7));
  for (CameraSpec& camera : world.rig.cameras) {
    camera.lens_uncertainty.reset();
    camera.lens.fx *= 1.05;
    camera.lens.fy *= 1.05;
  }
  const Report report = Believed(world);
  for (std::size_t c = 0; c < 2; ++c) {
    EXPECT_LT(Chi2(world, report, c), kMostChi2);
    const Cause* const focal = Find(report.cameras[c], "focal length");
    ASSERT_NE(focal, nullptr);
    EXPECT_GT(focal->Sigmas(), kGivenWrongSigmas);
    EXPECT_EQ(focal->moves_sigma, 0);
  }
}

TEST(WhyViewsDisagree, ImagesBesideTheNextViewsCloudsAreNamed) {
  for (const int apart : {-2, 1}) {
    SolveWorld world(Views(12));
    const std::vector<ViewDetection> right = world.detections;
    for (int v = 0; v < 12; ++v) {
      const auto other = static_cast<std::size_t>(std::min(11, std::max(0, v + apart)));
      world.detections[static_cast<std::size_t>(v)].cloud = right[other].cloud;
    }
    for (const CameraReport& camera : Calibrate(world.rig, world.detections, Brief()).cameras) {
      EXPECT_THAT(camera.contradiction,
                  HasSubstr("Images and clouds are " + std::to_string(std::abs(apart)) + " apart"));
    }
  }
}

// Six pairs are left that may agree, two of them held out.
TEST(WhyViewsDisagree, OfFewViewsThoseHeldOutTellThePairsToo) {
  SolveWorld world(Views(8));
  const std::vector<ViewDetection> right = world.detections;
  world.detections.resize(7);
  for (std::size_t v = 0; v < 7; ++v) world.detections[v].cloud = right[v + 1].cloud;
  world.detections[2].heldout = world.detections[5].heldout = true;
  for (const CameraReport& camera : Calibrate(world.rig, world.detections, Brief()).cameras) {
    EXPECT_THAT(camera.contradiction, HasSubstr("Images and clouds are 1 apart"));
  }
}

// So large a mistake that no two views agree: the distances between boards tell it.
TEST(WhyViewsDisagree, ACloudOrSquaresOfAnotherScaleAreNamed) {
  for (const bool cloud : {true, false}) {
    SolveWorld world(Views(10));
    Target& target = world.rig.target;
    for (std::size_t v = 0; v < world.detections.size(); ++v) {
      if (cloud) {
        CloudEdges& edges = world.CloudAt(v);
        edges.centre *= 1.2;
        edges.pose->sensor_from_target.translation *= 1.2;
        for (Eigen::Vector3d& point : edges.boundary) point *= 1.2;
        edges.width_m = 1.2 * target.width_m;
        edges.height_m = 1.2 * target.height_m;
      } else {
        world.CloudAt(v).width_m = target.width_m;
      }
    }
    if (!cloud) target.square_m /= 1.2;
    for (const CameraReport& camera : Believed(world).cameras) {
      EXPECT_FALSE(camera.calibration.solved());
      ASSERT_EQ(camera.causes.size(), 2U);
      EXPECT_EQ(camera.causes[0].name, cloud ? "cloud's scale" : "squares");
      EXPECT_EQ(camera.causes[1].name, cloud ? "squares" : "focal length");
      EXPECT_THAT(camera.causes[0].words, HasSubstr("farther apart in the clouds"));
    }
  }
}

TEST(WhyViewsDisagree, ALensThatIsFarOffIsFoundByTheViewsThemselves) {
  SolveWorld world(Views(14));
  CameraSpec& camera = world.rig.cameras[0];
  camera.lens_uncertainty.reset();
  camera.lens.fx *= 1.3;
  camera.lens.fy *= 1.3;
  const Report report = Believed(world);
  ASSERT_TRUE(report.cameras[0].calibration.converged());
  EXPECT_LT(Chi2(world, report, 0), kMostChi2);
  EXPECT_GT(report.cameras[0].causes.at(0).Sigmas(), kGivenWrongSigmas);
  EXPECT_THAT(report.cameras[0].contradiction, "");
}

// With the right model, a wrong focal length is not taken for a wrong model.
TEST(GivenWrong, ALensOfTheRightModelIsNotSaidToBeOfTheOther) {
  SolveWorld world(Views(12));
  for (CameraSpec& camera : world.rig.cameras) {
    camera.lens_uncertainty.reset();
    camera.lens.fx *= 1.1;
    camera.lens.fy *= 1.1;
  }
  for (const CameraReport& camera : Believed(world).cameras) {
    ASSERT_NE(Find(camera, "focal length"), nullptr);
    EXPECT_EQ(Find(camera, "lens model"), nullptr);
  }
}

// Clouds without rings, whose boards alone tell: x right, y down, z forward.
TEST(GuessCameras, CloudsInACamerasAxesAreNamed) {
  SolveWorld world(Views(8));
  for (const CameraReport& camera : Calibrate(world.rig, world.detections, Brief()).cameras) {
    EXPECT_THAT(camera.warnings, Not(testing::Contains(HasSubstr("a camera's (x right"))));
  }
  Rigid3 turned;
  turned.rotation = Eigen::Matrix3d((Eigen::Matrix3d() << 0, -1, 0, 0, 0, -1, 1, 0, 0).finished());
  Eigen::Matrix4d q = Eigen::Matrix4d::Identity();
  q.topLeftCorner<3, 3>() = turned.rotation.toRotationMatrix();
  for (std::size_t v = 0; v < world.detections.size(); ++v) {
    CloudEdges& cloud = world.CloudAt(v);
    cloud.centre = turned * cloud.centre;
    cloud.normal = turned * cloud.normal;
    cloud.pose->sensor_from_target = turned * cloud.pose->sensor_from_target;
    for (Eigen::Vector3d& point : cloud.boundary) point = turned * point;
    for (Crossing& crossing : cloud.crossings) crossing.point = turned * crossing.point;
    cloud.scatter = q * cloud.scatter * q.transpose();
    cloud.raw_scatter = q * cloud.raw_scatter * q.transpose();
  }
  for (const CameraReport& camera : Calibrate(world.rig, world.detections, Brief()).cameras) {
    EXPECT_THAT(camera.warnings, testing::Contains(HasSubstr("a camera's (x right")));
  }
}

}  // namespace
}  // namespace rgbdt
