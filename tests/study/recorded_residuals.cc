#include "tests/study/recorded_residuals.h"

#include <array>
#include <cmath>
#include <fstream>
#include <map>
#include <stdexcept>

#include "calib/detect/cloud/plane_regions.h"
#include "calib/model/linear_algebra.h"
#include "calib/solve/guess_cameras.h"
#include "calib/solve/internal/joint_solve.h"
#include "calib/solve/internal/view_equations.h"
#include "tests/numbers.h"

namespace rgbdt::study {
namespace {

constexpr double kBoardMarginM = 0.05;  // of the board's border, whose points are no plane's
constexpr double kMostOffPlaneM = 0.1;

std::vector<GuessedCamera> Guessed(const Recorded& recorded) {
  CalibrateOptions options;
  options.first_guess.accept = kVotingGate;  // as CalibrateByBoards does
  options.first_guess.range_offset_sigma_m = recorded.rig.lidar.range_offset_sigma_m;
  return GuessCameras(options, {ViewsOf(recorded.rig.cameras.at(0), recorded.views)});
}

// A CSV file that is there and whole, or an exception.
class CsvFile {
 public:
  CsvFile(const std::string& path, const char* head) : path_(path), file_(path) {
    file_ << head << '\n';
  }
  std::ofstream& line() { return file_; }
  void Close() {
    if (!file_.flush()) throw std::runtime_error("cannot write " + path_);
  }

 private:
  std::string path_;
  std::ofstream file_;
};

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

void WriteViews(const JointResult& result, const std::string& path) {
  constexpr const char* kAxes[] = {"about x", "about y", "about z",
                                   "along x", "along y", "along z"};
  CsvFile csv(path, "view,axis,value,sigma");
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
      csv.line() << by_cloud.views[v].name << ',' << kAxes[k] << ',' << 1e3 * off[k] << ','
                 << 1e3 * std::sqrt(cloud.covariance(k, k) + image.covariance(k, k)) << '\n';
    }
  }
  csv.Close();
}

// What the crossings of one side say of its place, the shared unknowns taken off.
struct SideOfView {
  int crossings = 0;
  std::array<int, 4> of_kind{};
  double weight = 0;            // 1 / rad^2
  double shift = 0, range = 0;  // weighted sums
};

SideOfView SideBy(const BoardProblem& problem, const BoardState& state, std::size_t view,
                  int side) {
  SideOfView out;
  const BoardPriors& priors = problem.priors;
  for (const Crossing& crossing : problem.views[view].cloud.crossings) {
    if (crossing.side != side || !(crossing.sigma_m > 0)) continue;
    const CrossingResidual r = ResidualOf(problem.target, priors, crossing,
                                          state.lidar_from_target[view], state.shared, 0);
    if (!(r.per_rad > 0)) continue;
    const double sigma_rad = crossing.sigma_m / r.per_rad;
    const double weight = 1 / (sigma_rad * sigma_rad);
    ++out.crossings;
    ++out.of_kind[static_cast<std::size_t>(crossing.kind)];
    out.weight += weight;
    out.shift += weight * r.beyond_m / r.per_rad;
    out.range += weight * crossing.point.norm();
  }
  return out;
}

void WriteSides(const JointResult& result, const std::string& path) {
  CsvFile csv(path,
              "view,side,kind,crossings,shift_mrad,sigma_mrad,range_m,tilt_deg,incidence_deg");
  const BoardProblem& problem = result.joint.problem;
  const BoardState& state = result.solution.state;
  for (std::size_t v = 0; v < problem.views.size(); ++v) {
    const Rigid3& board = state.lidar_from_target[v];
    const Eigen::Matrix3d axes = board.rotation.toRotationMatrix();
    const double incidence =
        std::acos(std::abs(board.translation.normalized().dot(axes.col(2)))) / kDegree;
    for (int side = 0; side < 4; ++side) {
      const SideOfView of = SideBy(problem, state, v, side);
      if (of.crossings == 0) continue;
      const auto* const kind = std::max_element(of.of_kind.begin(), of.of_kind.end());
      const Eigen::Vector3d along = axes.col(side % 2);  // top and bottom run along the target's x
      csv.line() << problem.views[v].name << ',' << side << ',' << kind - of.of_kind.begin() << ','
                 << of.crossings << ',' << 1e3 * of.shift / of.weight << ','
                 << 1e3 / std::sqrt(of.weight) << ',' << of.range / of.weight << ','
                 << std::asin(std::min(1.0, std::abs(along.z()))) / kDegree << ',' << incidence
                 << '\n';
    }
  }
  csv.Close();
}

}  // namespace

std::optional<double> WriteRings(const Recorded& recorded, const RangeErrors& errors,
                                 const std::string& path) {
  CsvFile csv(path, "view,corrected,ring,points,mean_mm,rms_mm");
  const std::vector<GuessedCamera> cameras = Guessed(recorded);
  double squares[2] = {0, 0};
  for (std::size_t v = 0; v < recorded.views.size(); ++v) {
    const CameraView* view = cameras.at(0).views.Find(recorded.views[v].view);
    if (view == nullptr || !view->cloud->pose) continue;
    for (const int corrected : {0, 1}) {
      const Cloud& measured = recorded.clouds[v];
      const Rings rings = RingsOnBoard(corrected == 1 ? Corrected(measured, errors) : measured,
                                       view->cloud->pose->sensor_from_target, recorded.rig.target);
      for (const auto& [number, ring] : rings) {
        csv.line() << view->view << ',' << corrected << ',' << number << ',' << ring.points << ','
                   << 1e3 * ring.sum / ring.points << ','
                   << 1e3 * std::sqrt(ring.squares / ring.points) << '\n';
        squares[corrected] += ring.squares;
      }
    }
  }
  csv.Close();
  if (!(squares[0] > 0)) return std::nullopt;
  return std::sqrt(squares[1] / squares[0]);
}

void WriteResiduals(const Recorded& recorded, const std::string& views_path,
                    const std::string& sides_path) {
  JointResult result;
  std::vector<GuessedCamera> cameras = Guessed(recorded);
  if (cameras.at(0).guess.camera_from_lidar) {
    result = SolveJointly(MakeJointProblem(recorded.rig.target, std::move(cameras),
                                           recorded.rig.lidar.range_offset_sigma_m));
  }
  WriteViews(result, views_path);
  WriteSides(result, sides_path);
}

}  // namespace rgbdt::study
