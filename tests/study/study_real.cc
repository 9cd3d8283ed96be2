// How a recorded session agrees with itself: there is no truth.
//   study_real SESSION SPLITS SEED SPLITS_CSV FACTS_CSV RINGS_CSV VIEWS_CSV SIDES_CSV
// SESSION: a session directory of one camera; each view is detected once, held out or not.
// SPLITS_CSV: random halves of the views, solved apart, a line each, with the lens as the rig file
// has it, with it taken for exact, and with the one that all views' images give, as it is with
// `rgbdt intrinsics` run first (both halves then have its error in common); and the first half of
// the recording against the last
// ("in_order"), as two sessions. FACTS_CSV: name, value, unit. Edges alone against planes alone, as
// the report has it. The given lens against the session's own: found from
// the same images as `rgbdt intrinsics` does. RINGS_CSV: how far each ring's points on a board lie
// behind its plane, along their beams, before and after the cloud is corrected by what the solve
// found; range_sd_ratio: the RMS of all of them after over before. VIEWS_CSV, SIDES_CSV: what the
// solve leaves of each view and of each side of its board (recorded_residuals.h).
#include <algorithm>
#include <cmath>
#include <fstream>
#include <numeric>
#include <optional>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "calib/camera/intrinsics.h"
#include "calib/files/session/session_dir.h"
#include "calib/methods/calibrate.h"
#include "calib/methods/detect_view.h"
#include "calib/model/linear_algebra.h"
#include "calib/model/range_errors.h"
#include "calib/present/report/verdict.h"
#include "calib/solve/compare.h"
#include "tests/numbers.h"
#include "tests/study/recorded_residuals.h"
#include "tests/study/study_main.h"

namespace rgbdt::study {
namespace {

constexpr double kInside95 = 12.592;  // chi-square of six degrees of freedom: 95% lie below

using Detections = std::vector<ViewDetection>;

Recorded Record(const std::string& dir) {
  const Session session = OpenSession(dir);
  Recorded out{session.rig, {}, {}};
  if (out.rig.cameras.size() != 1) throw std::runtime_error(dir + ": expected one camera");
  for (const std::string& name : session.views) {
    View view = ReadView(session, name);
    out.views.push_back(DetectView(out.rig, view, kAutoMethod));
    out.views.back().heldout = false;
    out.clouds.push_back(std::move(view.cloud));
  }
  return out;
}

bool IsFound(const ViewDetection& view) {
  return view.images.at(0).usable() && !view.cloud.candidates.empty();
}

CameraReport Solve(const Rig& rig, const Detections& views) {
  CalibrateOptions options;
  options.diagnostics = false;
  return Calibrate(rig, views, options).cameras.at(0);
}

/// A pose and the covariance of its delta.
struct Pose {
  Rigid3 camera_from_lidar;
  Matrix6d covariance;
};

std::optional<Pose> PoseOf(const CameraReport& report) {
  const CameraCalibration& found = report.calibration;
  if (!found.covariance) return std::nullopt;
  return Pose{found.camera_from_lidar, *found.covariance};
}

double Chi2(const Pose& a, const Rigid3& b, const Matrix6d& covariance) {
  const Vector6d delta = Log(a.camera_from_lidar * b.Inverse());
  return delta.dot(SolveSymmetric(covariance, delta));
}

/// The rig with the lens that the session's own images give; nothing where that failed, or where
/// the board has no pattern to find a lens by.
std::optional<Rig> WithOwnLens(Rig rig, const Detections& views) {
  if (!rig.target.HasPattern()) return std::nullopt;
  CameraSpec& camera = rig.cameras.at(0);
  IntrinsicsInput images{
      camera.lens.model == Lens::Model::kFisheye ? LensChoice::kFisheye : LensChoice::kPinhole5,
      camera.width,
      camera.height,
      rig.target,
      {}};
  for (const ViewDetection& view : views) {
    if (!view.images.at(0).usable()) continue;
    images.views.push_back({view.view, view.images.at(0).edges->corners});
  }
  const IntrinsicsResult own = CalibrateIntrinsics(images);
  if (!own.converged) return std::nullopt;
  camera.lens = own.lens;
  camera.lens_uncertainty = UncertaintyOf(own, images.views);
  return rig;
}

/// Random halves, and the recording's own.
class Splits {
 public:
  Splits(const std::string& path, const Detections& views) : csv_(path), views_(views) {
    csv_ << "case,split,rotation_deg,translation_mm,chi2,inside95,sigma_rotation_deg,"
            "sigma_translation_mm,px,sigma_px,pitch_deg,yaw_deg,lens_pitch_deg,lens_yaw_deg,"
            "doubtful\n";
  }

  void Random(const std::string& name, const Rig& rig, int count, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::vector<std::size_t> order = InOrder();
    for (int i = 0; i < count; ++i) {
      // Not std::shuffle, whose result is the library's own.
      for (std::size_t k = order.size(); k > 1; --k) std::swap(order[k - 1], order[random() % k]);
      Add(name, rig, i, order);
    }
  }

  void Recorded(const Rig& rig) { Add("in_order", rig, 0, InOrder()); }

  bool Close() { return static_cast<bool>(csv_.flush()); }

 private:
  std::vector<std::size_t> InOrder() const {
    std::vector<std::size_t> order(views_.size());
    std::iota(order.begin(), order.end(), 0U);
    return order;
  }

  void Add(const std::string& name, const Rig& rig, int split,
           const std::vector<std::size_t>& order) {
    Detections halves[2];
    for (std::size_t k = 0; k < order.size(); ++k) {
      halves[2 * k < order.size() ? 0 : 1].push_back(views_[order[k]]);
    }
    const CameraReport a = Solve(rig, halves[0]);
    const CameraReport b = Solve(rig, halves[1]);
    const auto pose_a = PoseOf(a);
    const auto pose_b = PoseOf(b);
    csv_ << name << ',' << split;
    if (pose_a && pose_b) {
      const PoseError apart = ErrorOf(pose_a->camera_from_lidar, pose_b->camera_from_lidar);
      const Matrix6d covariance = pose_a->covariance + pose_b->covariance;
      const double chi2 = Chi2(*pose_a, pose_b->camera_from_lidar, covariance);
      csv_ << ',' << apart.rotation_deg << ',' << apart.translation_mm << ',' << chi2 << ','
           << (chi2 <= kInside95) << ','
           << std::sqrt(covariance.topLeftCorner<3, 3>().trace()) / kDegree << ','
           << 1e3 * std::sqrt(covariance.bottomRightCorner<3, 3>().trace());
      AddPixels(rig.cameras.at(0), a.calibration, b.calibration);
    } else {
      csv_ << ",,,,,,,,,,,,";
    }
    csv_ << ',' << (std::max(Judge(a).grade, Judge(b).grade) > Grade::kUsable) << '\n';
  }

  // Where the two, each with its lens, project what is 5 m away; about the camera's x and y, how
  // far they are turned, and how far their lenses' centres lie apart, as an angle.
  void AddPixels(const CameraSpec& spec, const CameraCalibration& a, const CameraCalibration& b) {
    const PoseComparison apart = Compare(a, b, &spec);
    const PixelShift& at_5m = apart.pixels.at(1);
    const Lens of_a = a.WithSolvedLens(spec).lens;
    const Lens of_b = b.WithSolvedLens(spec).lens;
    csv_ << ',' << at_5m.rms_px << ',' << at_5m.sigma_px.value_or(NAN) << ','
         << apart.rotation_deg[0].value << ',' << apart.rotation_deg[1].value << ','
         << (of_b.cy - of_a.cy) / of_a.fy / kDegree << ','
         << (of_a.cx - of_b.cx) / of_a.fx / kDegree;
  }

  std::ofstream csv_;
  const Detections& views_;
};

/// Single figures: name, value, unit.
class Facts {
 public:
  explicit Facts(const std::string& path) : csv_(path) { csv_ << "fact,value,unit\n"; }

  void Add(const std::string& name, double value, const std::string& unit = "1") {
    csv_ << '"' << name << "\"," << value << ',' << unit << '\n';
  }

  // How far two results lie apart.
  void AddApart(const std::string& name, const Pose& a, const Pose& b, const Matrix6d& covariance) {
    const PoseError apart = ErrorOf(a.camera_from_lidar, b.camera_from_lidar);
    Add(name + "_deg", apart.rotation_deg, "deg");
    Add(name + "_mm", apart.translation_mm, "mm");
    Add(name + "_chi2", Chi2(a, b.camera_from_lidar, covariance));
  }

  void AddEstimate(const std::string& name, const std::string& unit, double scale,
                   const Estimate& estimate) {
    Add(name, scale * estimate.value, unit);
    Add(name + ", sigma", scale * estimate.sigma, unit);
  }

  bool Close() { return static_cast<bool>(csv_.flush()); }

 private:
  std::ofstream csv_;
};

void AddWhole(const Recorded& recorded, const CameraReport& whole, Facts* facts) {
  facts->Add("found", static_cast<double>(recorded.views.size()));
  facts->Add("used", static_cast<double>(whole.used.size()));
  facts->Add("converged", whole.calibration.converged() ? 1 : 0);
  facts->Add("doubtful", Judge(whole).grade > Grade::kUsable ? 1 : 0);
  facts->Add("variance_factor", whole.variance_factor);
  if (const auto pose = PoseOf(whole)) {
    const Vector6d sigma = pose->covariance.diagonal().cwiseSqrt();
    facts->Add("sigma_deg", sigma.head<3>().maxCoeff() / kDegree, "deg");
    facts->Add("sigma_mm", 1e3 * sigma.tail<3>().maxCoeff(), "mm");
  }
  for (const Nuisance& n : whole.nuisance) facts->AddEstimate(n.name, n.unit, 1, n.estimate);
}

void AddComparisons(const Recorded& recorded, const CameraReport& whole, Facts* facts) {
  if (const auto& apart = whole.edges_planes) {
    facts->Add("edge_plane_deg", apart->difference.rotation_deg, "deg");
    facts->Add("edge_plane_mm", apart->difference.translation_mm, "mm");
    facts->Add("edge_plane_chi2", apart->chi2);
    facts->Add("edge_plane_sigma_enlarged", apart->sigma_enlarged.value_or(1));
  }
  const auto rig = WithOwnLens(recorded.rig, recorded.views);
  const auto given = PoseOf(whole);
  const auto own = rig ? PoseOf(Solve(*rig, recorded.views)) : std::nullopt;
  // All but the lens is common to both: the difference is judged by one covariance, not by the sum.
  if (given && own) facts->AddApart("lens", *given, *own, own->covariance);
}

// Only what was found; all views are counted.
Recorded FoundOf(Recorded recorded, Facts* facts) {
  facts->Add("recorded", static_cast<double>(recorded.views.size()));
  Recorded found{recorded.rig, {}, {}};
  for (std::size_t v = 0; v < recorded.views.size(); ++v) {
    if (!IsFound(recorded.views[v])) continue;
    found.views.push_back(std::move(recorded.views[v]));
    found.clouds.push_back(std::move(recorded.clouds[v]));
  }
  return found;
}

void Run(const std::vector<std::string>& arguments) {
  Facts facts(arguments[4]);
  const Recorded recorded = FoundOf(Record(arguments[0]), &facts);
  const CameraReport whole = Solve(recorded.rig, recorded.views);
  AddWhole(recorded, whole, &facts);
  AddComparisons(recorded, whole, &facts);
  const int count = std::stoi(arguments[1]);
  const std::uint64_t seed = std::stoull(arguments[2]);
  Rig exact = recorded.rig;
  exact.cameras.at(0).lens_uncertainty = LensUncertainty{};
  Splits splits(arguments[3], recorded.views);
  splits.Random("random", recorded.rig, count, seed);
  splits.Random("random_exact_lens", exact, count, seed);
  if (const auto own = WithOwnLens(recorded.rig, recorded.views)) {
    splits.Random("random_own_lens", *own, count, seed);
  }
  splits.Recorded(recorded.rig);
  const RangeErrors errors = whole.calibration.range_errors.value_or(RangeErrors{});
  if (const auto ratio = WriteRings(recorded, errors, arguments[5])) {
    facts.Add("range_sd_ratio", *ratio);
  }
  WriteResiduals(recorded, arguments[6], arguments[7]);
  if (!splits.Close() || !facts.Close()) throw std::runtime_error("cannot write " + arguments[3]);
}

}  // namespace
}  // namespace rgbdt::study

int main(int argc, char** argv) {
  return rgbdt::study::StudyMain(
      {"study_real", "SESSION SPLITS SEED SPLITS_CSV FACTS_CSV RINGS_CSV VIEWS_CSV SIDES_CSV", 8, 8,
       rgbdt::study::Run},
      argc, argv);
}
