// Sixteen real views of a plain white square (a colour camera and 64 rings); no pattern, no truth.
#include <gtest/gtest.h>

#include <cstdio>
#include <numeric>
#include <random>

#include "calib/methods/calibrate.h"
#include "calib/model/statistics.h"
#include "calib/present/report/verdict.h"
#include "tests/real/acfr.h"

namespace rgbdt {
namespace {

constexpr const char* kNoPlain = "RGBDT_REAL_DATA is not set, or has no basler_os64_plain";

struct Halves {
  std::vector<double> rotation_deg, translation_mm, chi2;
};

// Fifty ways to halve the views.
Halves HalvesOf(const Rig& rig, const std::vector<ViewDetection>& views) {
  CalibrateOptions options;
  options.diagnostics = false;
  std::mt19937 random(1);
  std::vector<std::size_t> order(views.size());
  std::iota(order.begin(), order.end(), 0U);
  Halves out;
  for (int i = 0; i < 50; ++i) {
    std::shuffle(order.begin(), order.end(), random);
    std::array<std::vector<ViewDetection>, 2> halves;
    for (std::size_t k = 0; k < order.size(); ++k) halves[k % 2].push_back(views[order[k]]);
    const auto a = Calibrate(rig, halves[0], options).cameras.at(0).calibration;
    const auto b = Calibrate(rig, halves[1], options).cameras.at(0).calibration;
    if (!a.covariance || !b.covariance) continue;
    const PoseError error = ErrorOf(a.camera_from_lidar, b.camera_from_lidar);
    const Vector6d delta = Log(a.camera_from_lidar * b.camera_from_lidar.Inverse());
    out.rotation_deg.push_back(error.rotation_deg);
    out.translation_mm.push_back(error.translation_mm);
    out.chi2.push_back(delta.dot((*a.covariance + *b.covariance).ldlt().solve(delta)));
  }
  return out;
}

TEST(Plain, TheViewsTogetherTellEachBoardsTurn) {
  auto detected = DetectReal(kAutoMethod, "basler_os64_plain");
  if (!detected) GTEST_SKIP() << kNoPlain;
  for (ViewDetection& view : detected->views) view.heldout = false;
  Rig& rig = detected->session.rig;
  const CameraReport camera = Calibrate(rig, detected->views).cameras.at(0);
  ASSERT_TRUE(camera.calibration.converged()) << camera.calibration.StatusText();
  const Verdict verdict = Judge(camera);
  EXPECT_LE(verdict.grade, Grade::kUsable) << verdict.reasons.front();
  const Halves open = HalvesOf(rig, detected->views);
  rig.cameras.at(0).lens_uncertainty = LensUncertainty{};
  const Halves exact = HalvesOf(rig, detected->views);
  ASSERT_GE(open.chi2.size(), 45U);
  ASSERT_GE(exact.chi2.size(), 45U);
  for (const Halves* halves : {&open, &exact}) {
    std::printf(
        "%zu views used; halves differ by a median of %.3f deg, %.1f mm, chi-square %.1f of 6\n",
        camera.used.size(), Median(halves->rotation_deg), Median(halves->translation_mm),
        Median(halves->chi2));
    EXPECT_LE(Median(halves->chi2), 9);
  }
  EXPECT_GE(camera.used.size(), 14U);
}

}  // namespace
}  // namespace rgbdt
