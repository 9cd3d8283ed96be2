#include "calib/solve/internal/view_scatter.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "calib/model/linear_algebra.h"
#include "calib/model/rigid3.h"
#include "calib/solve/internal/evidence.h"

namespace rgbdt {
namespace {

using Index = Eigen::Index;

// The result without every `parts`-th of these views from `part` on.
BoardSolution Without(const BoardProblem& problem, const BoardSolution& all,
                      const std::vector<std::size_t>& views, std::size_t part, std::size_t parts) {
  std::vector<bool> left_out(problem.views.size(), false);
  for (std::size_t i = part; i < views.size(); i += parts) left_out[views[i]] = true;
  std::vector<std::size_t> others;
  for (std::size_t v = 0; v < problem.views.size(); ++v) {
    if (!left_out[v]) others.push_back(v);
  }
  return SolveSome(problem, all, others);
}

// Of the cameras' poses, then the further LIDARs'.
std::vector<Index> PlacesOfPoses(const BoardProblem& problem) {
  const SharedPlaces places(problem);
  std::vector<Index> poses;
  const auto add = [&](Index first) {
    for (Index k = 0; k < 6; ++k) poses.push_back(first + k);
  };
  for (std::size_t c = 0; c < problem.cameras.size(); ++c) add(SharedPlaces::Pose(c));
  for (std::size_t l = 0; l < problem.lidars.size(); ++l) add(places.LidarPose(l));
  return poses;
}

// Their poses, in the same order.
std::vector<Rigid3> PosesOf(const BoardState& state) {
  std::vector<Rigid3> poses = state.camera_from_lidar;
  for (const LidarState& lidar : state.lidars) poses.push_back(lidar.reference_from_lidar);
  return poses;
}

// By how much a small motion of its pose moves the camera's centre, in its axes, or the further
// LIDAR's origin, in the reference's [m].
Eigen::Vector3d MoveOfOrigin(const BoardState& state, const Contradiction& of,
                             const Vector6d& delta) {
  if (!of.lidar) return delta.tail<3>();
  const Eigen::Vector3d& origin = state.lidars[*of.lidar].reference_from_lidar.translation;
  return delta.head<3>().cross(origin) + delta.tail<3>();
}

// A view's images and further clouds, nothing said of them yet.
std::vector<Contradiction> SensorsOf(const BoardProblem& problem, std::size_t view) {
  std::vector<Contradiction> sensors;
  for (std::size_t s = 0; s < problem.views[view].images.size(); ++s) {
    sensors.push_back({view, s, std::nullopt});
  }
  for (std::size_t l = 0; l < problem.lidars.size(); ++l) {
    if (HasCloud(problem, l, view)) sensors.push_back({view, 0, l});
  }
  return sensors;
}

// How these sensors' poses (SensorOf) move when each of these views is left out in turn, of whose
// moves `together` count once.
std::optional<ViewScatter> ScatterOf(const BoardProblem& problem, const BoardSolution& solution,
                                     const std::vector<std::size_t>& views,
                                     const std::vector<std::size_t>& sensors, double together) {
  constexpr std::size_t kMostParts = 10;
  if (views.size() < 4) return std::nullopt;
  const std::size_t parts = std::min(views.size(), kMostParts);
  const std::vector<Index> places = PlacesOfPoses(problem);
  double moved = 0;
  double expected = 0;
  double expected2 = 0;
  for (std::size_t part = 0; part < parts; ++part) {
    const BoardSolution without = Without(problem, solution, views, part, parts);
    const std::vector<Rigid3> poses = PosesOf(solution.state);
    const std::vector<Rigid3> poses_without = PosesOf(without.state);
    for (const std::size_t s : sensors) {
      const Index at = places[6 * s];
      const Matrix6d covariance = solution.covariance.block<6, 6>(at, at);
      const Matrix6d covariance_without = without.covariance.block<6, 6>(at, at);
      const Matrix6d more = SolveSymmetric(covariance, covariance_without) - Matrix6d::Identity();
      const Vector6d move = Log(poses_without[s] * poses[s].Inverse());
      moved += move.dot(SolveSymmetric(covariance, move));
      expected += more.trace();
      expected2 += (more * more).trace();
    }
  }
  if (!(expected > 0) || !std::isfinite(moved)) return std::nullopt;
  const double chance = std::sqrt(2 * expected2 * together) / expected;
  return ViewScatter{moved / expected, 2 / (chance * chance)};
}

}  // namespace

std::size_t SensorOf(const BoardProblem& problem, const Contradiction& contradiction) {
  if (contradiction.lidar) return problem.cameras.size() + *contradiction.lidar;
  return static_cast<std::size_t>(
      problem.views[contradiction.view].images[contradiction.image].camera);
}

std::vector<Contradiction> Contradictions(const BoardProblem& problem,
                                          const BoardSolution& solution) {
  const std::vector<Index> poses = PlacesOfPoses(problem);
  const auto count = static_cast<Index>(poses.size());
  // Nuisances as they are: a view's own and the others' then add up.
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(count, count);
  for (const ViewInformation& view : solution.views) all += view.information(poses, poses);
  std::vector<Contradiction> out;
  for (std::size_t v = 0; v < problem.views.size(); ++v) {
    // The view's sensors only: of others it says nothing.
    const std::vector<Contradiction> sensors = SensorsOf(problem, v);
    std::vector<Index> place;
    for (const Contradiction& sensor : sensors) {
      const auto first = static_cast<Index>(6 * SensorOf(problem, sensor));
      for (Index k = 0; k < 6; ++k) place.push_back(first + k);
    }
    const Eigen::MatrixXd of_view = solution.views[v].information(poses, poses);
    const auto own = Eigen::MatrixXd(of_view(place, place));
    const auto gradient =
        Eigen::VectorXd(Eigen::VectorXd(solution.views[v].gradient(poses))(place));
    const Eigen::MatrixXd others = all - of_view;
    const Eigen::MatrixXd others_covariance = InverseOfSymmetric(others)(place, place);
    const Eigen::MatrixXd covariance = InverseOfSymmetric(own) + others_covariance;
    const Eigen::VectorXd off = covariance * gradient;
    for (std::size_t s = 0; s < sensors.size(); ++s) {
      const auto at = static_cast<Index>(6 * s);
      const Matrix6d block = covariance.block<6, 6>(at, at);
      const Vector6d delta = off.segment<6>(at);
      Contradiction c = sensors[s];
      c.chi2 = delta.dot(SolveSymmetric(block, delta));
      c.rotation_deg = delta.head<3>().norm() * 180 / M_PI;
      c.centre_mm = 1000 * MoveOfOrigin(solution.state, c, delta).norm();
      if (std::isfinite(c.chi2)) out.push_back(c);  // not where no other view has this camera
    }
  }
  return out;
}

double AsStated(const std::vector<Contradiction>& contradictions, std::size_t views) {
  if (contradictions.empty()) return ShareAsStated(1, 0);
  double chi2 = 0;
  for (const Contradiction& c : contradictions) chi2 += c.chi2;
  // Images of one view share its cloud, and count once.
  return ShareAsStated(chi2 / (6 * static_cast<double>(contradictions.size())),
                       6 * (static_cast<double>(views) - 1));
}

std::optional<ViewScatter> ViewScatterOf(const BoardProblem& problem,
                                         const BoardSolution& solution) {
  std::vector<std::size_t> views(problem.views.size());
  std::iota(views.begin(), views.end(), 0);
  std::vector<std::size_t> cameras(problem.cameras.size());
  std::iota(cameras.begin(), cameras.end(), 0);
  // Images of one view share its cloud: their moves are correlated, and count but once.
  std::size_t together = 1;
  for (const BoardView& view : problem.views) together = std::max(together, view.images.size());
  return ScatterOf(problem, solution, views, cameras, static_cast<double>(together));
}

std::optional<ViewScatter> ViewScatterOf(const BoardProblem& problem, const BoardSolution& solution,
                                         std::size_t lidar) {
  std::vector<std::size_t> views;
  for (std::size_t v = 0; v < problem.views.size(); ++v) {
    if (HasCloud(problem, lidar, v)) views.push_back(v);
  }
  return ScatterOf(problem, solution, views, {problem.cameras.size() + lidar}, 1);
}

}  // namespace rgbdt
