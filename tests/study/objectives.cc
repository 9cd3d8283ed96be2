#include "tests/study/objectives.h"

#include <cmath>

#include "calib/methods/paper/internal/paper_cost.h"
#include "calib/simulate/options.h"
#include "calib/solve/first_guess.h"
#include "calib/solve/internal/board_objective.h"

namespace rgbdt::study {
namespace {

using simulate::kDegree;

std::vector<CameraView> FirstViews(const std::vector<ViewDetection>& detections,
                                   const std::string& camera, int views) {
  std::vector<CameraView> all = ViewsOfCamera(detections, camera);
  all.resize(std::min(all.size(), static_cast<std::size_t>(views)));
  return all;
}

BoardView ViewOf(const CameraView& seen, const Rigid3& camera_from_lidar) {
  // Where no board fits the pose, the likeliest is as good as any.
  const int fitting = ChooseCandidate(seen, camera_from_lidar).candidate;
  BoardView view;
  view.name = seen.view;
  view.cloud = *seen.candidates[static_cast<std::size_t>(std::max(0, fitting))];
  const Rigid3 lidar_from_target =
      camera_from_lidar.Inverse() * seen.image->pose->sensor_from_target;
  view.images.push_back({0, seen.image, HalfTurned(lidar_from_target, *view.cloud.pose)});
  return view;
}

}  // namespace

Rigid3 Moved(const Rigid3& camera_from_lidar, const std::array<double, 6>& by) {
  Rigid3 motion = RotationAbout(Eigen::Vector3d::UnitZ(), by[2] * kDegree) *
                  RotationAbout(Eigen::Vector3d::UnitY(), by[1] * kDegree) *
                  RotationAbout(Eigen::Vector3d::UnitX(), by[0] * kDegree);
  motion.translation << by[3], by[4], by[5];
  return camera_from_lidar * motion;
}

BoardProblem ProblemOf(const PairedSession& session, std::size_t camera, int views,
                       const Rigid3& camera_from_lidar) {
  const CameraSpec& spec = session.rig.cameras[camera];
  BoardProblem problem;
  problem.target = session.rig.target;
  problem.cameras = {Camera(spec)};
  for (const CameraView& seen : FirstViews(session.by_boards, spec.name, views)) {
    problem.views.push_back(ViewOf(seen, camera_from_lidar));
  }
  return problem;
}

Objectives::Objectives(const PairedSession& session, std::size_t camera, int views)
    : camera_(session.rig.cameras[camera]),
      truth_(session.camera_from_lidar[camera]),
      by_paper_(FirstViews(session.by_paper, session.rig.cameras[camera].name, views)),
      problem_(ProblemOf(session, camera, views, truth_)),
      state_(SolveBoards(problem_, StartOf(problem_, {truth_})).state) {
  for (const CameraView& view : by_paper_) {
    const ImageEdges& image = *view.image;
    flat_.emplace_back(image.width, image.height, image.edge_pixels);
    smooth_.emplace_back(image.width, image.height, image.edge_pixels, FieldBeyond::kSmooth);
  }
  for (const BoardView& view : problem_.views) {
    boards_residuals_ +=
        view.cloud.scatter(3, 3) + static_cast<double>(view.cloud.crossings.size());
  }
}

double Objectives::Paper(const Rigid3& camera_from_lidar, FieldBeyond beyond) const {
  const auto& fields = beyond == FieldBeyond::kSmooth ? smooth_ : flat_;
  const Vector6d zero = Vector6d::Zero();
  const double* parameters[] = {zero.data()};
  double squares = 0;
  double points = 0;
  for (std::size_t v = 0; v < by_paper_.size(); ++v) {
    const std::vector<Eigen::Vector3d>& boundary = by_paper_[v].cloud->boundary;
    Eigen::VectorXd residuals(static_cast<Eigen::Index>(boundary.size()));
    PaperCost(&camera_, &fields[v], &boundary, camera_from_lidar)
        .Evaluate(parameters, residuals.data(), nullptr);
    squares += residuals.squaredNorm();
    points += static_cast<double>(boundary.size());
  }
  return std::sqrt(squares / points);
}

double Objectives::Auto(const Rigid3& camera_from_lidar) const {
  return std::sqrt(BoardObjective(problem_, state_, {camera_from_lidar}) / boards_residuals_);
}

}  // namespace rgbdt::study
