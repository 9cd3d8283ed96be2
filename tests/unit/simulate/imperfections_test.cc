#include "calib/simulate/imperfections.h"

#include <gtest/gtest.h>

#include <cmath>

#include "calib/simulate/internal/spinning.h"
#include "tests/unit/simulate/simulate_testing.h"

namespace rgbdt::simulate {
namespace {

constexpr int kSeeds = 200;

Options Imperfect(std::uint64_t seed, int rings) {
  Options options;
  options.seed = seed;
  UseLidar(rings, &options);
  MakeImperfect(&options);
  return options;
}

TEST(Imperfections, AreGoodOptionsAndTheSeedsOwn) {
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    for (const int rings : {0, 16}) ASSERT_NO_THROW(Imperfect(seed, rings).Check()) << seed;
  }
  EXPECT_EQ(ImperfectionsText(Imperfect(7, 16)), ImperfectionsText(Imperfect(7, 16)));
  EXPECT_NE(ImperfectionsText(Imperfect(7, 16)), ImperfectionsText(Imperfect(8, 16)));
  EXPECT_EQ(ImperfectionsText(Options()), "");
}

TEST(Imperfections, AreAsLargeAsTheRigFileStates) {
  double focal = 0, k1 = 0, print = 0, offset = 0;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    const Options o = Imperfect(seed, 0);
    const CameraOptions& rgb = o.cameras[0];
    EXPECT_NEAR(rgb.lens_sigma[0], 5.5, 1e-9);     // 0.5% of 1100 px
    EXPECT_NEAR(rgb.lens_sigma[2], 11.616, 1e-9);  // 0.6% of 1936 px
    focal += std::pow(rgb.lens_error[0] / rgb.lens_sigma[0], 2) / kSeeds;
    k1 += std::pow(o.cameras[1].lens_error[4] / 0.02, 2) / kSeeds;
    print += std::pow((o.board.print_scale.x() - 1) / o.board.print_sigma, 2) / kSeeds;
    offset += std::pow(o.scanner.range_offset_m / 0.02, 2) / kSeeds;
  }
  // Of 200 draws, cut at 2.5 sigma: 0.95 on average, sigma 0.09.
  for (const double mean : {focal, k1, print, offset}) EXPECT_NEAR(mean, 0.95, 0.35);
}

TEST(Imperfections, AreSpreadOverTheirRanges) {
  double least_dark = 1, most_dark = 0, least_meet = 1, most_meet = 0;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    const SpinningOptions o = *Imperfect(seed, 32).spinning;
    EXPECT_GE(o.ring_bias_sigma_m, 0.003);
    EXPECT_LE(o.ring_bias_sigma_m, 0.010);
    EXPECT_GE(o.divergence_rad, 1.5e-3);
    EXPECT_LE(o.divergence_rad, 4e-3);
    EXPECT_GE(o.dark_noise, 1);
    EXPECT_LE(o.dark_noise, 3.5);
    least_dark = std::min(least_dark, o.dark_range_m);
    most_dark = std::max(most_dark, o.dark_range_m);
    least_meet = std::min(least_meet, o.beams_meet_m);
    most_meet = std::max(most_meet, o.beams_meet_m);
  }
  EXPECT_LT(least_dark, 0.001);
  EXPECT_GT(most_dark, 0.019);
  EXPECT_LE(most_dark, 0.020);
  EXPECT_LT(least_meet, 0.002);
  EXPECT_GT(most_meet, 0.043);
  EXPECT_LE(most_meet, 0.045);
}

TEST(Imperfections, OnlyTheRigFileHasTheOtherLens) {
  Options options = SmallOptions();
  const Simulator exact(options);
  options.cameras[0].lens_error << 1.5, -1, 3, 2, 0.02, 0, 0, 0, 0;
  options.cameras[0].lens_sigma << 1, 2, 3, 4, 0.01, 0, 0, 0, 0;
  const Simulator off(options);
  const CameraSpec& camera = off.rig().Camera("rgb");
  EXPECT_DOUBLE_EQ(camera.lens.fx, options.cameras[0].lens.fx + 1.5);
  EXPECT_DOUBLE_EQ(camera.lens.cy, options.cameras[0].lens.cy + 2);
  EXPECT_DOUBLE_EQ(camera.lens.distortion[0], options.cameras[0].lens.distortion[0] + 0.02);
  EXPECT_DOUBLE_EQ(camera.lens_uncertainty->covariance(1, 1), 4);
  EXPECT_DOUBLE_EQ(camera.lens_uncertainty->covariance(4, 4), 1e-4);
  EXPECT_EQ(off.rig().Camera("thermal").lens, exact.rig().Camera("thermal").lens);
  EXPECT_TRUE(off.rig().Camera("thermal").lens_uncertainty->exact());
  EXPECT_EQ(
      cv::norm(exact.TakeImage("rgb", 1).pixels, off.TakeImage("rgb", 1).pixels, cv::NORM_INF), 0);
}

TEST(Imperfections, OnlyTheRigFileHasTheOtherPrint) {
  Options options;
  options.board.print_scale = {1.01, 0.98};
  options.board.print_sigma = 0.015;
  const Board board(options.board, Rigid3(), HeatMap());
  // The outermost squares' far sides: 5.5 and 4 squares of 0.1 m from the middle.
  EXPECT_GT(board.Patch({-0.5554, 0}), 0);
  EXPECT_EQ(board.Patch({-0.5556, 0}), 0);  // the border
  EXPECT_GT(board.Patch({0, 0.3919}), 0);
  EXPECT_EQ(board.Patch({0, 0.3921}), 0);
  const Target target = MakeTarget(options.board);
  EXPECT_EQ(target.print_scale, Eigen::Vector2d(1, 1));
  EXPECT_DOUBLE_EQ(target.print_sigma, 0.015);
  EXPECT_DOUBLE_EQ(target.square_m, 0.1);
}

TEST(Imperfections, ScannersRangesAreOffToo) {
  Options options;
  options.scanner.range_sigma_m = 1e-9;
  options.scanner.range_offset_m = -0.02;
  options.scanner.dark_range_m = 0.01;
  const Mesh wall = MakeQuad({5, -50, -50}, {5, 50, -50}, {5, 50, 50}, {5, -50, 50});
  const World dark = SheetWorld({wall}, 0.1, options);
  const World white = SheetWorld({wall}, 0.9, options);
  const Scanner scanner(options.scanner, 1);
  const float on_dark = scanner.Line(dark, 0, 150).range[200];
  const float on_white = scanner.Line(white, 0, 150).range[200];
  EXPECT_NEAR(on_dark - on_white, 0.01 * std::exp(-1.0 / 9), 2e-6);
  options.scanner.range_offset_m = options.scanner.dark_range_m = 0;
  const float exact = Scanner(options.scanner, 1).Line(white, 0, 150).range[200];
  EXPECT_NEAR(on_white - exact, -0.02, 4e-6);  // and some of the dark's: e to the minus 9
}

}  // namespace
}  // namespace rgbdt::simulate
