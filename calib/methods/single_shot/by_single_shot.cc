#include "calib/methods/single_shot/by_single_shot.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "calib/methods/plane/by_planes.h"
#include "calib/model/check.h"
#include "calib/model/stopwatch.h"
#include "calib/model/text.h"

namespace rgbdt {
namespace {

// All views of a camera laid over each other.
struct Shot {
  struct Piece {
    const CameraView* view;
    const CloudEdges* cloud;
  };
  std::vector<const CameraView*> board_views;
  std::vector<FlatPiece> boards;
  std::vector<Piece> piece_of;  // as `pieces`
  std::vector<FlatPiece> pieces;

  void Add(const CameraView& view) {
    const Rigid3& board = view.image->pose->sensor_from_target;
    board_views.push_back(&view);
    boards.push_back({board.translation, -(board.rotation * Eigen::Vector3d::UnitZ())});
    for (const CloudEdges* candidate : view.candidates) {
      piece_of.push_back({&view, candidate});
      pieces.push_back({candidate->centre, candidate->normal});
    }
  }
};

// A pose, what lies on what there, and the pose refined from that.
struct Pose {
  Rigid3 start;  // camera_from_lidar, by a triple
  PlaneMatch match;
  CameraCalibration calibration;
};

// Boards with the pieces that they lie on, whoever's these are.
std::vector<CameraView> Matched(const Shot& shot, const PlaneMatch& match) {
  std::vector<CameraView> views;
  views.reserve(shot.boards.size());
  for (std::size_t b = 0; b < shot.boards.size(); ++b) {
    if (match.piece[b] < 0) continue;
    views.push_back(*shot.board_views[b]);
    views.back().cloud = *shot.piece_of[static_cast<std::size_t>(match.piece[b])].cloud;
  }
  return views;
}

CameraCalibration SolveMatched(const Shot& shot, const PlaneMatch& match) {
  const std::vector<CameraView> views = Matched(shot, match);
  std::vector<const CameraView*> used;
  used.reserve(views.size());
  for (const CameraView& view : views) used.push_back(&view);
  return SolvePlanes(used, match.camera_from_lidar);
}

// Pieces matched anew from where points on planes lead, until they stay.
Pose RefinedFrom(const Shot& shot, PlaneMatch match, const SingleShotOptions& options) {
  Pose pose{match.camera_from_lidar, std::move(match), {}};
  for (int round = 0; round < options.rounds; ++round) {
    pose.calibration = SolveMatched(shot, pose.match);
    if (!pose.calibration.converged()) break;
    PlaneMatch next =
        MatchAt(pose.calibration.camera_from_lidar, shot.boards, shot.pieces, options.matching);
    const bool stays = next.piece == pose.match.piece;
    pose.match = std::move(next);
    if (stays) break;
  }
  return pose;
}

std::vector<Pose> PosesOf(const Shot& shot, const SingleShotOptions& options) {
  std::vector<Pose> poses;
  for (PlaneMatch& match : MatchPlanes(shot.boards, shot.pieces, options.matching)) {
    Pose pose = RefinedFrom(shot, std::move(match), options);
    if (pose.calibration.converged()) poses.push_back(std::move(pose));
  }
  std::stable_sort(poses.begin(), poses.end(),
                   [](const Pose& a, const Pose& b) { return a.match.score > b.match.score; });
  return poses;
}

// The best of those that lead elsewhere than the first; null: there is none.
const Pose* RivalOf(const std::vector<Pose>& poses, const PlaneMatchingOptions& options) {
  const Rigid3& best = poses[0].calibration.camera_from_lidar;
  for (const Pose& pose : poses) {
    const Rigid3& other = pose.calibration.camera_from_lidar;
    if (RotationDistance(best, other) > options.apart_rad ||
        CentreDistance(best, other) > options.apart_m) {
      return &pose;
    }
  }
  return nullptr;
}

std::size_t BoardsOn(const PlaneMatch& match) {
  return static_cast<std::size_t>(
      std::count_if(match.piece.begin(), match.piece.end(), [](int piece) { return piece >= 0; }));
}

CameraCalibration Failed(const CameraViews& views, SolveStatus status, std::string why) {
  CameraCalibration calibration = views.report.calibration;
  calibration.status = status;
  calibration.detail = std::move(why);
  return calibration;
}

// The view's own piece that its board lies on, seen from a pose; null: none is near.
const CloudEdges* OwnPiece(const CameraView& view, const Rigid3& camera_from_lidar,
                           const PlaneMatchingOptions& options) {
  Shot alone;
  alone.Add(view);
  const int piece = MatchAt(camera_from_lidar, alone.boards, alone.pieces, options).piece[0];
  return piece < 0 ? nullptr : alone.piece_of[static_cast<std::size_t>(piece)].cloud;
}

// Every view takes the piece that its board lies on, or is rejected.
void TakePieces(const Shot& shot, const Pose& pose, const PlaneMatchingOptions& options,
                CameraViews* views) {
  const Rigid3& found = pose.calibration.camera_from_lidar;
  for (CameraView& view : views->all) {
    if (!view.usable()) continue;
    const CloudEdges* own = OwnPiece(view, found, options);
    for (std::size_t b = 0; b < shot.boards.size(); ++b) {
      if (shot.board_views[b] != &view || pose.match.piece[b] < 0) continue;
      const auto& taken = shot.piece_of[static_cast<std::size_t>(pose.match.piece[b])];
      if (taken.view == &view) continue;
      view.Reject("its board lies on a plane of view " + taken.view->view);
      own = nullptr;
    }
    if (own == nullptr) {
      view.Reject("its board lies on no plane of the cloud");
      continue;
    }
    view.cloud = *own;
    view.cloud->pose = TargetPose{found.Inverse() * view.image->pose->sensor_from_target,
                                  view.image->pose->covariance, view.image->pose->half_turn_known};
  }
}

}  // namespace

void SingleShotOptions::Check() const {
  const OptionCheck check("single shot");
  matching.Check();
  check.AtLeast(rounds, 1, "rounds");
  check.Between(least_share, 0, 1, "least_share");
  check.Between(rival_share, 0, 1, "rival_share");
}

CameraCalibration SolveSingleShot(CameraViews* views, int min_views,
                                  const SingleShotOptions& options) {
  options.Check();
  Shot shot;
  for (const CameraView* view : views->Used()) {
    if (view->image->pose) shot.Add(*view);
  }
  const auto least = static_cast<std::size_t>(std::max(3, min_views));
  if (shot.boards.size() < least) {
    return Failed(*views, SolveStatus::kNotSolved,
                  Format("%zu boards are seen by camera and LIDAR; %zu are needed",
                         shot.boards.size(), least));
  }
  const std::vector<Pose> poses = PosesOf(shot, options);
  const double share = options.least_share * static_cast<double>(shot.boards.size());
  if (poses.empty() || BoardsOn(poses[0].match) < least ||
      static_cast<double>(BoardsOn(poses[0].match)) < share) {
    return Failed(*views, SolveStatus::kNotSolved,
                  Format("from no pose do more than %zu of %zu boards lie on planes of the cloud",
                         poses.empty() ? 0 : BoardsOn(poses[0].match), shot.boards.size()));
  }
  const Pose* rival = RivalOf(poses, options.matching);
  if (rival != nullptr && rival->match.score > options.rival_share * poses[0].match.score) {
    return Failed(
        *views, SolveStatus::kUndetermined,
        Format("two poses fit alike: %zu and %zu of %zu boards lie on planes of the cloud",
               BoardsOn(poses[0].match), BoardsOn(rival->match), shot.boards.size()));
  }
  views->report.first_guess = poses[0].start;
  TakePieces(shot, poses[0], options.matching, views);
  const std::vector<const CameraView*> used = views->Used();
  if (used.size() < least) {
    return Failed(
        *views, SolveStatus::kNotSolved,
        Format("%zu boards lie on a plane of their own view; %zu are needed", used.size(), least));
  }
  return SolvePlanes(used, poses[0].calibration.camera_from_lidar);
}

CalibratedCameras CalibrateBySingleShot(const Target& target, const CalibrateOptions& options,
                                        std::vector<CameraViews> cameras) {
  const EdgeModel edges{target, BoardPriors().Means(), {}};
  CalibratedCameras out;
  for (CameraViews& views : cameras) {
    const Stopwatch watch;
    views.report.calibration = SolveSingleShot(&views, options.min_views);
    views.report.calibration.camera = views.spec->name;
    views.report.solve_s += watch.Seconds();
    if (views.report.calibration.solved()) {
      views.report.calibration = WithDegeneracy(views);
      views.report = JudgeViews(edges, views);
    }
    out.cameras.push_back(std::move(views));
  }
  return out;
}

}  // namespace rgbdt
