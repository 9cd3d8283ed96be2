// How a recorded session agrees with itself: there is no truth.
//   study_real SESSION SPLITS SEED SPLITS_CSV FACTS_CSV RINGS_CSV VIEWS_CSV
// SESSION: a session directory of one camera; each view is detected once, held out or not.
// SPLITS_CSV: random halves of the views, solved apart, a line each, with the lens as the rig file
// has it, with it taken for exact, and with the one that all views' images give, as it is with
// `rgbdt intrinsics` run first (both halves then have its error in common); and the first half of
// the recording against the last
// ("in_order"), as two sessions. FACTS_CSV: name, value, unit. Edges alone against planes alone, as
// the report has it. The given lens against the session's own: found from
// the same images as `rgbdt intrinsics` does. RINGS_CSV: how far each ring's points on a board lie
// behind its plane, along their beams, before and after the cloud is corrected by what the solve
// found; range_sd_ratio: the RMS of all of them after over before. VIEWS_CSV: by how much the board
// in each view's cloud is displaced from where its image and the result put it, about and along the
// target's axes, with the sigma that image and cloud state.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <numeric>
#include <optional>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "calib/camera/intrinsics.h"
#include "calib/detect/cloud/plane_regions.h"
#include "calib/files/session/session_dir.h"
#include "calib/methods/calibrate.h"
#include "calib/methods/detect_view.h"
#include "calib/model/linear_algebra.h"
#include "calib/model/range_errors.h"
#include "calib/present/report/verdict.h"
#include "calib/solve/compare.h"
#include "calib/solve/guess_cameras.h"
#include "calib/solve/internal/joint_solve.h"
#include "calib/solve/internal/view_equations.h"
#include "tests/study/study_main.h"

namespace rgbdt::study {
namespace {

constexpr double kDegree = M_PI / 180;
constexpr double kInside95 = 12.592;    // chi-square of six degrees of freedom: 95% lie below
constexpr double kBoardMarginM = 0.05;  // of the board's border, whose points are no plane's
constexpr double kMostOffPlaneM = 0.1;

using Detections = std::vector<ViewDetection>;

/// What was recorded, and what detection makes of it.
struct Recorded {
  Rig rig;
  std::vector<Cloud> clouds;  ///< one a view
  Detections views;
};

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

std::vector<GuessedCamera> Guessed(const Rig& rig, const Detections& views) {
  CalibrateOptions options;
  options.first_guess.accept = kVotingGate;  // as CalibrateByBoards does
  options.first_guess.range_offset_sigma_m = rig.lidar.range_offset_sigma_m;
  return GuessCameras(options, {ViewsOf(rig.cameras.at(0), views)});
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

/// Distances behind the board's plane along the beam [m], of one ring.
struct Ring {
  int points = 0;
  double sum = 0, squares = 0;
};
using Rings = std::map<int, Ring>;

// Of the points on a board, the plane fitted to these very points.
Rings RingsOnBoard(const Cloud& cloud, const Rigid3& lidar_from_target, const Target& target) {
  Rings rings;
  if (cloud.ring.size() != cloud.size()) return rings;
  const Rigid3 target_from_lidar = lidar_from_target.Inverse();
  std::vector<std::size_t> on;
  PlaneSums sums;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!cloud.IsHit(i)) continue;
    const Eigen::Vector3d point = cloud.points[i].cast<double>();
    const Eigen::Vector3d on_target = target_from_lidar * point;
    if (std::abs(on_target.x()) > target.width_m / 2 - kBoardMarginM ||
        std::abs(on_target.y()) > target.height_m / 2 - kBoardMarginM ||
        std::abs(on_target.z()) > kMostOffPlaneM) {
      continue;
    }
    on.push_back(i);
    sums.Add(point);
  }
  if (on.size() < 10) return rings;
  const Plane plane = sums.Fit();
  for (const std::size_t i : on) {
    const Eigen::Vector3d point = cloud.points[i].cast<double>();
    const double behind = plane.Signed(point) / plane.normal.dot(point.normalized());
    Ring& ring = rings[cloud.ring[i]];
    ++ring.points;
    ring.sum += behind;
    ring.squares += behind * behind;
  }
  return rings;
}

// Of the boards that the views chose, as measured and corrected by what the solve found.
bool WriteRings(const Recorded& recorded, const RangeErrors& errors, const std::string& path,
                Facts* facts) {
  std::ofstream csv(path);
  csv << "view,corrected,ring,points,mean_mm,rms_mm\n";
  const std::vector<GuessedCamera> cameras = Guessed(recorded.rig, recorded.views);
  double squares[2] = {0, 0};
  for (std::size_t v = 0; v < recorded.views.size(); ++v) {
    const CameraView* view = cameras.at(0).views.Find(recorded.views[v].view);
    if (view == nullptr || !view->cloud->pose) continue;
    for (const int corrected : {0, 1}) {
      const Cloud& measured = recorded.clouds[v];
      const Rings rings = RingsOnBoard(corrected == 1 ? Corrected(measured, errors) : measured,
                                       view->cloud->pose->sensor_from_target, recorded.rig.target);
      for (const auto& [number, ring] : rings) {
        csv << view->view << ',' << corrected << ',' << number << ',' << ring.points << ','
            << 1e3 * ring.sum / ring.points << ',' << 1e3 * std::sqrt(ring.squares / ring.points)
            << '\n';
        squares[corrected] += ring.squares;
      }
    }
  }
  if (squares[0] > 0) facts->Add("range_sd_ratio", std::sqrt(squares[1] / squares[0]));
  return static_cast<bool>(csv.flush());
}

// A board's pose by what a view has of it in this problem, all that views share as the solution has
// it.
struct BoardPose {
  Rigid3 lidar_from_target;
  Matrix6d covariance;  // of a right delta
};

BoardPose BoardBy(const BoardProblem& problem, BoardState state, std::size_t view) {
  constexpr int kRounds = 20;
  Matrix6d covariance;
  for (int round = 0; round < kRounds; ++round) {
    const ViewEquations equations(problem, state, view);
    const ViewEquations::OwnMatrix h = equations.h().topLeftCorner<kOwnUnknowns, kOwnUnknowns>();
    const Eigen::VectorXd step =
        SolveSymmetric(Eigen::MatrixXd(h), Eigen::VectorXd(equations.g().head<kOwnUnknowns>()));
    Rigid3& board = state.lidar_from_target[view];
    board = board * Exp(Vector6d(step.head<6>()));
    for (std::size_t side = 0; side < 4; ++side) {
      state.side_shift[view][side] += step[6 + static_cast<Eigen::Index>(side)];
    }
    covariance = InverseOfSymmetric(Eigen::MatrixXd(h)).topLeftCorner<6, 6>();
  }
  return {state.lidar_from_target[view], covariance};
}

// The board as each view's cloud alone has it against how its image alone has it.
bool WriteViews(const Recorded& recorded, const std::string& path) {
  constexpr const char* kAxes[] = {"about x", "about y", "about z",
                                   "along x", "along y", "along z"};
  std::ofstream csv(path);
  csv << "view,axis,value,sigma\n";
  std::vector<GuessedCamera> cameras = Guessed(recorded.rig, recorded.views);
  if (!cameras.at(0).guess.camera_from_lidar) return static_cast<bool>(csv.flush());
  const JointResult result = SolveJointly(MakeJointProblem(
      recorded.rig.target, std::move(cameras), recorded.rig.lidar.range_offset_sigma_m));
  BoardProblem by_cloud = result.joint.problem;
  BoardProblem by_image = result.joint.problem;
  for (BoardView& view : by_cloud.views) view.images.clear();
  for (BoardView& view : by_image.views) {
    view.cloud.crossings.clear();
    view.cloud.scatter_sigma_m = 0;
  }
  for (std::size_t v = 0; v < by_cloud.views.size(); ++v) {
    const BoardPose cloud = BoardBy(by_cloud, result.solution.state, v);
    const BoardPose image = BoardBy(by_image, result.solution.state, v);
    const Vector6d off = Log(image.lidar_from_target.Inverse() * cloud.lidar_from_target);
    for (int k = 0; k < 6; ++k) {
      csv << by_cloud.views[v].name << ',' << kAxes[k] << ',' << 1e3 * off[k] << ','
          << 1e3 * std::sqrt(cloud.covariance(k, k) + image.covariance(k, k)) << '\n';
    }
  }
  return static_cast<bool>(csv.flush());
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
  const bool written =
      WriteRings(recorded, errors, arguments[5], &facts) && WriteViews(recorded, arguments[6]);
  if (!written || !splits.Close() || !facts.Close()) {
    throw std::runtime_error("cannot write " + arguments[3]);
  }
}

}  // namespace
}  // namespace rgbdt::study

int main(int argc, char** argv) {
  return rgbdt::study::StudyMain(
      {"study_real", "SESSION SPLITS SEED SPLITS_CSV FACTS_CSV RINGS_CSV VIEWS_CSV", 7, 7,
       rgbdt::study::Run},
      argc, argv);
}
