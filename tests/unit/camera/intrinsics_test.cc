#include "calib/camera/intrinsics.h"

#include <algorithm>
#include <opencv2/calib3d.hpp>

#include "tests/unit/camera/intrinsics_testing.h"
#include "tests/unit/camera/lenses.h"

namespace rgbdt {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class IntrinsicsOf : public testing::TestWithParam<NamedLens> {};

TEST_P(IntrinsicsOf, TwentyViewsGiveTheFocalLengthsWithinATenthOfAPercent) {
  const CameraSpec& spec = GetParam().spec;
  for (const std::uint32_t seed : {1U, 2U, 3U}) {
    const IntrinsicsResult result = CalibrateIntrinsics(InputOf(spec, 20, 0.1, seed));
    EXPECT_TRUE(result.converged) << result.detail;
    EXPECT_EQ(result.ViewsUsed(), 20);
    EXPECT_NEAR(result.lens.fx / spec.lens.fx, 1, 1e-3);
    EXPECT_NEAR(result.lens.fy / spec.lens.fy, 1, 1e-3);
    // 4 sigma: a chance of 1 in 16,000.
    EXPECT_NEAR(result.lens.cx, spec.lens.cx, 4 * result.Sigma(2));
    EXPECT_NEAR(result.lens.cy, spec.lens.cy, 4 * result.Sigma(3));
    EXPECT_LT(result.Sigma(0) / spec.lens.fx, 1e-3);
    EXPECT_NEAR(result.rms_px, 0.1 * std::sqrt(2), 0.007);  // 0.1 px along x and along y
  }
}

TEST_P(IntrinsicsOf, PerfectCornersGiveTheLensItself) {
  const CameraSpec& spec = GetParam().spec;
  const IntrinsicsResult result = CalibrateIntrinsics(InputOf(spec, 12, 0, 4));
  EXPECT_TRUE(result.converged) << result.detail;
  EXPECT_NEAR(result.lens.fx / spec.lens.fx, 1, 1e-5);
  EXPECT_NEAR(result.lens.fy / spec.lens.fy, 1, 1e-5);
  EXPECT_NEAR(result.lens.cx, spec.lens.cx, 0.01);
  EXPECT_NEAR(result.lens.cy, spec.lens.cy, 0.01);
  EXPECT_LT(result.rms_px, 1e-3);
}

INSTANTIATE_TEST_SUITE_P(Lenses, IntrinsicsOf, testing::ValuesIn(Lenses()), NameOf);

// The same views again and again, with new noise: what scatters is what the covariance says.
void ExpectHonestSigmas(const std::string& name) {
  const CameraSpec& spec = SpecNamed(name);
  // A sigma from 400 runs is itself good to 3.5%: 0.2 is more than five times that.
  constexpr int kRuns = 400;
  Target coarse = PaperTarget();  // 30 corners rather than 70: the test takes half the time
  coarse.squares_x = 7;
  coarse.squares_y = 6;
  coarse.square_m = 0.15;
  IntrinsicsInput input{ChoiceOf(spec.lens), spec.width, spec.height, coarse, {}};
  BoardViews boards(spec, input.target, 11);
  std::vector<Rigid3> poses;
  for (int i = 0; i < 8; ++i) poses.push_back(boards.Pose(0.35, 0.85));
  Eigen::MatrixXd values;
  Eigen::VectorXd stated;
  for (int run = 0; run < kRuns; ++run) {
    input.views.clear();
    for (const Rigid3& pose : poses) input.views.push_back(boards.Corners(pose, 0.15));
    const IntrinsicsResult result = CalibrateIntrinsics(input);
    ASSERT_TRUE(result.converged) << result.detail;
    const auto count = static_cast<Eigen::Index>(result.values.size());
    if (run == 0) {
      values.resize(kRuns, count);
      stated = Eigen::VectorXd::Zero(count);
    }
    values.row(run) = Eigen::Map<const Eigen::RowVectorXd>(result.values.data(), count);
    stated += result.covariance.diagonal() / kRuns;
  }
  const Eigen::MatrixXd centred = values.rowwise() - values.colwise().mean();
  const Eigen::VectorXd scatter = centred.colwise().squaredNorm().transpose() / (kRuns - 1);
  for (Eigen::Index i = 0; i < stated.size(); ++i) {
    EXPECT_NEAR(std::sqrt(stated[i] / scatter[i]), 1, 0.2) << "parameter " << i;
  }
}

TEST(Intrinsics, APinholesSigmasAgreeWithTheScatter) { ExpectHonestSigmas("five_coefficients"); }
TEST(Intrinsics, AFisheyesSigmasAgreeWithTheScatter) { ExpectHonestSigmas("acfr_fisheye"); }

// By how many sigmas the worst of fx, fy, cx and cy is off.
double WorstSigmas(const IntrinsicsResult& result, const Lens& lens) {
  const LensNumbers truth = NumbersOf(lens);
  double sigmas = 0;
  for (int i = 0; i < 4; ++i) {
    const double off = result.values[static_cast<std::size_t>(i)] - truth[i];
    sigmas = std::max(sigmas, std::abs(off) / result.Sigma(i));
  }
  return sigmas;
}

// Paper that the printer stretched, boards turned one way and the other: a lens that had to explain
// it would be off by many sigmas.
TEST(Intrinsics, AStretchedPrintIsToldFromTheLens) {
  for (const char* name : {"five_coefficients", "acfr_fisheye"}) {
    const CameraSpec& spec = SpecNamed(name);
    IntrinsicsInput input = InputOf(spec, 0, 0, 1);
    Target stretched = input.target;
    stretched.print_scale = {1, 0.996};
    BoardViews boards(spec, stretched, 3);
    for (int i = 0; i < 20; ++i) {
      input.views.push_back(boards.Corners(boards.Pose(0.35, 0.85), 0.07));
    }
    const IntrinsicsResult exact = CalibrateIntrinsics(input);
    EXPECT_FALSE(exact.board);
    EXPECT_GT(WorstSigmas(exact, spec.lens), 4) << name;
    input.target.print_sigma = kUsualPrintSigma;
    const IntrinsicsResult result = CalibrateIntrinsics(input);
    ASSERT_TRUE(result.board);
    EXPECT_NEAR(result.board->aspect.value, -0.004, 4 * result.board->aspect.sigma);
    EXPECT_LT(result.board->aspect.sigma, 0.0005);
    EXPECT_LT(WorstSigmas(result, spec.lens), 4) << name;
  }
}

// A board that bulges by a millimetre and is twisted by half of one.
TEST(Intrinsics, ABentBoardIsToldFromTheLens) {
  for (const char* name : {"five_coefficients", "acfr_fisheye"}) {
    const CameraSpec& spec = SpecNamed(name);
    IntrinsicsInput input = InputOf(spec, 0, 0, 1);
    BoardViews boards(spec, input.target, 3, {0.001, -0.0004, 0.0005});
    for (int i = 0; i < 25; ++i) {
      input.views.push_back(boards.Corners(boards.Pose(0.35, 0.85), 0.05));
    }
    EXPECT_GT(WorstSigmas(CalibrateIntrinsics(input), spec.lens), 4) << name;
    input.target.print_sigma = kUsualPrintSigma;
    const IntrinsicsResult result = CalibrateIntrinsics(input);
    ASSERT_TRUE(result.board);
    EXPECT_NEAR(result.board->bow_x.value, 0.001, 4 * result.board->bow_x.sigma);
    EXPECT_NEAR(result.board->bow_y.value, -0.0004, 4 * result.board->bow_y.sigma);
    EXPECT_NEAR(result.board->twist.value, 0.0005, 4 * result.board->twist.sigma);
    EXPECT_LT(result.board->bow_x.sigma, 0.0003);
    EXPECT_LT(WorstSigmas(result, spec.lens), 4) << name;
  }
}

void ExpectLens(const IntrinsicsResult& result, const Lens& lens) {
  EXPECT_TRUE(result.converged) << result.detail;
  EXPECT_NEAR(result.lens.fx / lens.fx, 1, 1e-3);
  EXPECT_NEAR(result.lens.fy / lens.fy, 1, 1e-3);
}

TEST(Intrinsics, WrongCornersAndViewsAreLeftOutWithAReason) {
  for (const char* name : {"five_coefficients", "eight_coefficients", "acfr_fisheye"}) {
    const CameraSpec& spec = SpecNamed(name);
    IntrinsicsInput input = InputOf(spec, 20, 0.1, 5);
    Random random(9);
    int wrong = 0;
    for (IntrinsicsView& view : input.views) {
      for (Eigen::Vector2d& corner : view.corners) {
        if (random.Uniform(0, 1) > 0.03) continue;
        const double angle = random.Uniform(0, 2 * M_PI);
        corner += random.Uniform(3, 60) * Eigen::Vector2d(std::cos(angle), std::sin(angle));
        ++wrong;
      }
    }
    // One view of something else, one in a wrong order, one slightly off: a bent board.
    for (Eigen::Vector2d& corner : input.views[3].corners) {
      corner = {random.Uniform(0, spec.width), random.Uniform(0, spec.height)};
    }
    std::reverse(input.views[8].corners.begin(), input.views[8].corners.begin() + 30);
    for (Eigen::Vector2d& corner : input.views[12].corners) {
      corner += Eigen::Vector2d(random.Uniform(-2, 2), random.Uniform(-2, 2));
    }
    const IntrinsicsResult result = CalibrateIntrinsics(input);
    ExpectLens(result, spec.lens);
    EXPECT_EQ(result.ViewsUsed(), 17) << name;
    int left_out = 0;
    for (std::size_t i = 0; i < result.views.size(); ++i) {
      const bool spoiled = i == 3 || i == 8 || i == 12;
      EXPECT_EQ(!result.views[i].rejected.empty(), spoiled) << name << ": " << i;
      if (!spoiled) left_out += result.views[i].corners_left_out;
    }
    EXPECT_THAT(result.views[12].rejected, AllOf(HasSubstr("RMS "), HasSubstr("times the median")));
    EXPECT_GT(left_out, 0.7 * wrong);
    EXPECT_LE(left_out, wrong);
    EXPECT_NEAR(result.rms_px, 0.1414, 0.01);
  }
}

TEST(Intrinsics, HalfATurnDoesNotMatter) {
  const CameraSpec& spec = SpecNamed("five_coefficients");
  IntrinsicsInput input = InputOf(spec, 20, 0.1, 6);
  const IntrinsicsResult straight = CalibrateIntrinsics(input);
  for (std::size_t i = 0; i < input.views.size(); i += 2) {
    std::reverse(input.views[i].corners.begin(), input.views[i].corners.end());
  }
  const IntrinsicsResult turned = CalibrateIntrinsics(input);
  ExpectLens(turned, spec.lens);
  EXPECT_NEAR(turned.lens.fx, straight.lens.fx, 1e-4 * straight.lens.fx);
  EXPECT_EQ(turned.ViewsUsed(), 20);
  const Rigid3 half_turn = RotationAbout(Eigen::Vector3d::UnitZ(), M_PI);
  EXPECT_THAT(turned.views[0].camera_from_target * half_turn,
              Rigid3Near(straight.views[0].camera_from_target, 1e-4, 1e-3));
}

TEST(Intrinsics, AMirroredViewIsRejected) {
  IntrinsicsInput input = InputOf(SpecNamed("five_coefficients"), 10, 0.1, 6);
  std::vector<Eigen::Vector2d>& corners = input.views[4].corners;
  for (std::size_t row = 0; row < 7; ++row) {
    std::reverse(corners.begin() + static_cast<std::ptrdiff_t>(10 * row),
                 corners.begin() + static_cast<std::ptrdiff_t>(10 * row + 10));
  }
  const IntrinsicsResult result = CalibrateIntrinsics(input);
  EXPECT_TRUE(result.converged);
  EXPECT_EQ(result.ViewsUsed(), 9);
  EXPECT_THAT(result.views[4].rejected, HasSubstr("mirrored"));
}

// Near or far, long or short lens: it all looks the same.
TEST(Intrinsics, BoardsParallelToTheImageDetermineNothing) {
  for (const char* name : {"five_coefficients", "ideal_pinhole", "acfr_fisheye"}) {
    const CameraSpec& spec = SpecNamed(name);
    for (const double sigma : {0.02, 0.2}) {
      IntrinsicsInput input{ChoiceOf(spec.lens), spec.width, spec.height, PaperTarget(), {}};
      BoardViews boards(spec, input.target, 7);
      for (int i = 0; i < 12; ++i) input.views.push_back(boards.Corners(boards.Pose(0, 0), sigma));
      const IntrinsicsResult result = CalibrateIntrinsics(input);
      EXPECT_FALSE(result.converged)
          << name << ", " << sigma << " px: f " << result.lens.fx << " +- " << result.Sigma(0);
      EXPECT_THAT(result.detail, HasSubstr("tilt the board more"));
    }
  }
}

TEST(Intrinsics, TooFewViewsAreSaid) {
  const CameraSpec& spec = SpecNamed("five_coefficients");
  for (const int views : {0, 1, 2}) {
    const IntrinsicsResult result = CalibrateIntrinsics(InputOf(spec, views, 0.1, 8));
    EXPECT_FALSE(result.converged);
    EXPECT_THAT(result.detail, HasSubstr(std::to_string(views) + " usable views; expected"));
  }
}

TEST(Intrinsics, ALensOfAnotherModelIsSaid) {
  IntrinsicsInput input = InputOf(SpecNamed("ideal_fisheye"), 20, 0.1, 9);
  input.choice = LensChoice::kPinhole5;  // of a lens that sees 90 degrees off its axis
  EXPECT_FALSE(CalibrateIntrinsics(input).converged);
}

TEST(Intrinsics, CoverageTellsWhichCellsHeldCorners) {
  const CameraSpec& spec = SpecNamed("five_coefficients");
  IntrinsicsInput input = InputOf(spec, 20, 0.1, 10);
  auto& views = input.views;
  views.erase(std::remove_if(views.begin(), views.end(),
                             [](const IntrinsicsView& view) {
                               return std::any_of(view.corners.begin(), view.corners.end(),
                                                  [](const Eigen::Vector2d& c) {
                                                    return c.x() > 479.5;  // the last two columns
                                                  });
                             }),
              views.end());
  const ImageCoverage coverage = CalibrateIntrinsics(input).coverage;
  int held = 0;
  for (int row = 0; row < 6; ++row) {
    EXPECT_FALSE(coverage.Holds(6, row) || coverage.Holds(7, row));
    for (int column = 0; column < 8; ++column) held += coverage.Holds(column, row) ? 1 : 0;
  }
  EXPECT_TRUE(coverage.Holds(3, 3));
  EXPECT_DOUBLE_EQ(coverage.fraction, held / 48.0);
}

TEST(Intrinsics, TheSameInputGivesTheSameBits) {
  const IntrinsicsInput input = InputOf(SpecNamed("acfr_fisheye"), 8, 0.2, 12);
  const IntrinsicsResult a = CalibrateIntrinsics(input);
  const IntrinsicsResult b = CalibrateIntrinsics(input);
  EXPECT_EQ(a.values, b.values);
  EXPECT_EQ(a.covariance, b.covariance);
}

TEST(Intrinsics, BadInputIsNamed) {
  IntrinsicsInput input = InputOf(SpecNamed("five_coefficients"), 3, 0.1, 1);
  input.views[1].corners.pop_back();
  EXPECT_THAT(InputErrorOf([&] { CalibrateIntrinsics(input); }),
              AllOf(HasSubstr("view 2"), HasSubstr("69"), HasSubstr("70")));
  input = InputOf(SpecNamed("five_coefficients"), 3, 0.1, 1);
  input.views[2].corners[5].x() = std::nan("");
  EXPECT_THAT(InputErrorOf([&] { CalibrateIntrinsics(input); }), HasSubstr("view 3"));
  input.width = 0;
  EXPECT_THAT(InputErrorOf([&] { CalibrateIntrinsics(input); }), HasSubstr("0x480"));
  IntrinsicsOptions options;
  options.max_view_ratio = 0.5;
  EXPECT_THAT(InputErrorOf([&] { options.Check(); }),
              AllOf(HasSubstr("max_view_ratio"), HasSubstr("0.5")));
}

// OpenCV as the oracle: the same least squares, written by somebody else.
TEST(Intrinsics, APinholeIsWhatOpenCvFinds) {
  for (const char* name : {"five_coefficients", "eight_coefficients"}) {
    const CameraSpec& spec = SpecNamed(name);
    const IntrinsicsInput input = InputOf(spec, 15, 0.1, 13);
    std::vector<std::vector<cv::Point3f>> points;
    std::vector<std::vector<cv::Point2f>> pixels;
    for (const IntrinsicsView& view : input.views) {
      points.emplace_back();
      pixels.emplace_back();
      for (const Eigen::Vector3d& p : input.target.InnerCorners()) {
        points.back().emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()), 0.F);
      }
      for (const Eigen::Vector2d& c : view.corners) {
        pixels.back().emplace_back(static_cast<float>(c.x()), static_cast<float>(c.y()));
      }
    }
    cv::Mat matrix;
    cv::Mat k;
    std::vector<cv::Mat> r, t;
    const bool rational = input.choice == LensChoice::kPinhole8;
    const double rms =
        cv::calibrateCamera(points, pixels, {spec.width, spec.height}, matrix, k, r, t,
                            rational ? cv::CALIB_RATIONAL_MODEL : 0,
                            {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 300, 1e-12});
    const IntrinsicsResult result = CalibrateIntrinsics(input);
    EXPECT_EQ(result.corners_used, 15 * 70);
    EXPECT_LE(result.rms_px, rms * 1.0001) << name;
    // OpenCV creeps along the rational model's valley and stops on its way: a third of a sigma.
    const double part = rational ? 0.33 : 0.02;
    EXPECT_NEAR(result.lens.fx, matrix.at<double>(0, 0), part * result.Sigma(0)) << name;
    EXPECT_NEAR(result.lens.fy, matrix.at<double>(1, 1), part * result.Sigma(1)) << name;
    EXPECT_NEAR(result.lens.cx, matrix.at<double>(0, 2), part * result.Sigma(2)) << name;
    EXPECT_NEAR(result.lens.cy, matrix.at<double>(1, 2), part * result.Sigma(3)) << name;
  }
}

TEST(Intrinsics, AFisheyeIsWhatOpenCvFinds) {
  const CameraSpec& spec = SpecNamed("acfr_fisheye");
  const IntrinsicsInput input = InputOf(spec, 15, 0.1, 14);
  std::vector<std::vector<cv::Point3d>> points;
  std::vector<std::vector<cv::Point2d>> pixels;
  for (const IntrinsicsView& view : input.views) {
    points.emplace_back();
    pixels.emplace_back();
    for (const Eigen::Vector3d& p : input.target.InnerCorners()) {
      points.back().emplace_back(p.x(), p.y(), 0);
    }
    for (const Eigen::Vector2d& c : view.corners) pixels.back().emplace_back(c.x(), c.y());
  }
  cv::Matx33d matrix(1000, 0, 959.5, 0, 1000, 603.5, 0, 0, 1);  // it needs a guess
  cv::Vec4d k;
  std::vector<cv::Mat> r, t;
  const double rms =
      cv::fisheye::calibrate(points, pixels, {spec.width, spec.height}, matrix, k, r, t,
                             cv::fisheye::CALIB_USE_INTRINSIC_GUESS | cv::fisheye::CALIB_FIX_SKEW |
                                 cv::fisheye::CALIB_RECOMPUTE_EXTRINSIC,
                             {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 200, 1e-12});
  const IntrinsicsResult result = CalibrateIntrinsics(input);
  EXPECT_LE(result.rms_px, rms * 1.0001);
  EXPECT_NEAR(result.lens.fx, matrix(0, 0), 0.02 * result.Sigma(0));
  EXPECT_NEAR(result.lens.fy, matrix(1, 1), 0.02 * result.Sigma(1));
  EXPECT_NEAR(result.lens.cx, matrix(0, 2), 0.02 * result.Sigma(2));
  EXPECT_NEAR(result.lens.cy, matrix(1, 2), 0.02 * result.Sigma(3));
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(result.values[4 + i], k[i], 0.02 * result.Sigma(4 + i));
}

}  // namespace
}  // namespace rgbdt
