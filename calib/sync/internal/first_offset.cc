#include "calib/sync/internal/first_offset.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "calib/sync/internal/sweep_motion.h"

namespace rgbdt::sync {
namespace {

constexpr double kSpeedOver = 0.4;  // [s]
constexpr double kCoarse = 0.02;    // [s] steps of the search, kFine of its end
constexpr double kFine = 0.004;
constexpr std::size_t kMostSweeps = 120;  // that take part in the search
constexpr std::size_t kMostPoints = 800;  // of each
constexpr double kFar = 0.15;             // [m] from the board: as far off as can be
constexpr std::size_t kLeastPairs = 10;

double AngleBetween(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

Eigen::Vector3d NormalOf(const Rigid3& pose) { return pose.rotation * Eigen::Vector3d::UnitZ(); }

struct SomePoints {
  std::vector<Eigen::Vector3d> beams;
  std::vector<double> ranges;
  std::vector<Utime> utime;
};

// How badly a sweep's points fit the board where the track has it at that offset, 0 to 1; nothing
// where the track does not tell, or no beam would meet the board.
std::optional<double> MisfitOf(const SomePoints& points, const CameraTrack& track,
                               const Target& target, const Rigid3& lidar_from_camera,
                               double offset_s) {
  const Utime offset = FromSeconds(offset_s);
  // Beams come by the board's middle at the time of the point that is nearest to it.
  Utime when = points.utime[points.utime.size() / 2];
  std::optional<Rigid3> pose;
  for (int round = 0; round < 2; ++round) {
    const auto seen = track.At(when - offset);
    if (!seen) return std::nullopt;
    pose = lidar_from_camera * *seen;
    std::size_t best = 0;
    for (std::size_t i = 1; i < points.beams.size(); ++i) {
      if (points.beams[i].dot(pose->translation) > points.beams[best].dot(pose->translation)) {
        best = i;
      }
    }
    when = points.utime[best];
  }
  double sum = 0;
  int met_count = 0;
  for (std::size_t i = 0; i < points.beams.size(); ++i) {
    const auto met = MeetBoard(*pose, points.beams[i]);
    if (!met || !IsOn(target, met->place, 0.05)) continue;
    const double off = std::min(1.0, std::abs(points.ranges[i] - met->range) / kFar);
    sum += off * off;
    ++met_count;
  }
  if (met_count < 5) return std::nullopt;
  return sum / met_count;
}

// Some points of some sweeps, of those about where the board may be within the search.
std::vector<SomePoints> Choose(const std::vector<WavedSweep>& sweeps, const CameraTrack& track,
                               const Target& target, const Rigid3& lidar_from_camera,
                               double most_offset_s) {
  const double radius = 0.5 * std::hypot(target.width_m, target.height_m) + 0.2;
  std::vector<SomePoints> chosen;
  const std::size_t every = std::max<std::size_t>(1, sweeps.size() / kMostSweeps);
  for (std::size_t s = 0; s < sweeps.size(); s += every) {
    const WavedSweep& sweep = sweeps[s];
    if (sweep.points.empty()) continue;
    // A ball about each place of the board becomes a cone: directions within it, whatever range.
    std::vector<std::pair<Eigen::Vector3d, double>> cones;
    const Utime middle = sweep.utime[sweep.utime.size() / 2];
    for (double t = -most_offset_s; t <= most_offset_s; t += 0.1) {
      const auto pose = track.At(middle - FromSeconds(t));
      if (!pose) continue;
      const Eigen::Vector3d centre = lidar_from_camera * pose->translation;
      const double angle = std::atan2(radius, std::max(0.1, centre.norm()));
      cones.emplace_back(centre.normalized(), std::cos(angle));
    }
    std::vector<std::size_t> within;
    for (std::size_t i = 0; i < sweep.points.size(); ++i) {
      const Eigen::Vector3d beam = sweep.points[i].cast<double>().normalized();
      if (std::any_of(cones.begin(), cones.end(),
                      [&](const auto& cone) { return beam.dot(cone.first) > cone.second; })) {
        within.push_back(i);
      }
    }
    if (within.size() < 20) continue;
    SomePoints some;
    const std::size_t step = std::max<std::size_t>(1, within.size() / kMostPoints);
    for (std::size_t k = 0; k < within.size(); k += step) {
      const Eigen::Vector3d point = sweep.points[within[k]].cast<double>();
      some.ranges.push_back(point.norm());
      some.beams.push_back(point.normalized());
      some.utime.push_back(sweep.utime[within[k]]);
    }
    chosen.push_back(std::move(some));
  }
  return chosen;
}

struct Searched {
  double offset_s = 0, misfit = 1;
  bool at_end = false;                               // the best one is the farthest that was tried
  std::optional<double> elsewhere_s = std::nullopt;  // the best that is more than 0.2 s away
};

// The best of offsets from..to; `misfit` gives nothing where an offset cannot be judged.
template <typename Misfit>
std::optional<Searched> Search(double from, double to, double step, const Misfit& misfit) {
  std::vector<std::pair<double, double>> tried;
  for (double offset = from; offset < to + 0.5 * step; offset += step) {
    const std::optional<double> found = misfit(offset);
    if (found) tried.emplace_back(offset, *found);
  }
  if (tried.size() < 3) return std::nullopt;
  const auto best = std::min_element(
      tried.begin(), tried.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  Searched searched{best->first, best->second, best == tried.begin() || best + 1 == tried.end()};
  double least = std::numeric_limits<double>::infinity();
  for (const auto& [offset, value] : tried) {
    if (std::abs(offset - best->first) < 0.2 || value > least) continue;
    least = value;
    searched.elsewhere_s = offset;
  }
  return searched;
}

std::optional<Searched> SearchByPoints(const std::vector<SomePoints>& sweeps,
                                       const CameraTrack& track, const Target& target,
                                       const Rigid3& camera_from_lidar, double from, double to,
                                       double step) {
  const Rigid3 lidar_from_camera = camera_from_lidar.Inverse();
  return Search(from, to, step, [&](double offset) -> std::optional<double> {
    double sum = 0;
    std::size_t told = 0;
    for (const SomePoints& points : sweeps) {
      const auto misfit = MisfitOf(points, track, target, lidar_from_camera, offset);
      if (!misfit) continue;
      sum += *misfit;
      ++told;
    }
    if (told < kLeastPairs || 3 * told < sweeps.size()) return std::nullopt;
    return sum / static_cast<double>(told);
  });
}

// How far a board has moved and turned from one sweep to another.
struct Moved {
  Utime from = 0, to = 0;
  double way = 0, turn = 0;  // [m, rad]
};

std::vector<Moved> MovesOf(const std::vector<WavedSweep>& sweeps) {
  std::vector<Moved> moves;
  for (std::size_t i = 0; i < sweeps.size(); ++i) {
    for (std::size_t j = i + 1; j < sweeps.size() && j < i + 8; ++j) {
      if (sweeps[i].boards.empty() || sweeps[j].boards.empty()) continue;
      const SweepBoard& a = sweeps[i].boards.front();
      const SweepBoard& b = sweeps[j].boards.front();
      const double seconds = ToSeconds(b.utime - a.utime);
      if (seconds < 0.25 || seconds > 0.6) continue;
      Moved moved{a.utime, b.utime, 0, 0};
      moved.way = (a.lidar_from_target.translation - b.lidar_from_target.translation).norm();
      moved.turn = AngleBetween(NormalOf(a.lidar_from_target), NormalOf(b.lidar_from_target));
      if (moved.way < 4 * seconds) moves.push_back(moved);
      break;
    }
  }
  return moves;
}

std::optional<Searched> SearchByMoves(const std::vector<Moved>& moves, const CameraTrack& track,
                                      double most_offset_s) {
  return Search(-most_offset_s, most_offset_s, kCoarse,
                [&](double offset_s) -> std::optional<double> {
                  const Utime offset = FromSeconds(offset_s);
                  double sum = 0;
                  std::size_t told = 0;
                  for (const Moved& moved : moves) {
                    const auto from = track.At(moved.from - offset);
                    const auto to = track.At(moved.to - offset);
                    if (!from || !to) continue;
                    const double way = (from->translation - to->translation).norm();
                    const double turn = AngleBetween(NormalOf(*from), NormalOf(*to));
                    sum += std::min(0.5, std::abs(way - moved.way) / 0.2);
                    sum += std::min(0.5, std::abs(turn - moved.turn) / 0.4);
                    ++told;
                  }
                  if (told < kLeastPairs || 3 * told < moves.size()) return std::nullopt;
                  return sum / static_cast<double>(told);
                });
}

struct Matched {
  Rigid3 in_camera, in_lidar;
};

// By centres and what lies a metre off them along the normals (Umeyama 1991), without those that
// fit worst.
std::optional<Rigid3> FitPose(const std::vector<Matched>& matched) {
  std::vector<std::size_t> kept(matched.size());
  for (std::size_t i = 0; i < kept.size(); ++i) kept[i] = i;
  Rigid3 pose;
  for (int round = 0; round < 8; ++round) {
    if (kept.size() < kLeastPairs) return std::nullopt;
    Eigen::Matrix3Xd from(3, 2 * kept.size());
    Eigen::Matrix3Xd to(3, 2 * kept.size());
    for (std::size_t k = 0; k < kept.size(); ++k) {
      const Matched& match = matched[kept[k]];
      const auto column = static_cast<Eigen::Index>(2 * k);
      from.col(column) = match.in_lidar.translation;
      from.col(column + 1) = match.in_lidar * Eigen::Vector3d::UnitZ();
      to.col(column) = match.in_camera.translation;
      to.col(column + 1) = match.in_camera * Eigen::Vector3d::UnitZ();
    }
    const Eigen::Matrix4d found = Eigen::umeyama(from, to, false);
    pose = {Eigen::Quaterniond(Eigen::Matrix3d(found.topLeftCorner<3, 3>())).normalized(),
            found.topRightCorner<3, 1>()};
    std::vector<double> off;
    for (const Matched& match : matched) {
      off.push_back(
          (pose * match.in_lidar.translation - match.in_camera.translation).norm() +
          0.5 * (pose.rotation * NormalOf(match.in_lidar) - NormalOf(match.in_camera)).norm());
    }
    std::vector<double> of_kept;
    for (const std::size_t i : kept) of_kept.push_back(off[i]);
    const double most = std::max(0.05, 2.5 * Median(of_kept));
    kept.clear();
    for (std::size_t i = 0; i < off.size(); ++i) {
      if (off[i] < most) kept.push_back(i);
    }
  }
  if (3 * kept.size() < matched.size()) return std::nullopt;
  return pose;
}

std::optional<Rigid3> PoseAtOffset(const CameraTrack& track, const std::vector<WavedSweep>& sweeps,
                                   double offset_s) {
  std::optional<Rigid3> pose;
  for (int round = 0; round < 2; ++round) {
    std::vector<Matched> matched;
    for (const WavedSweep& sweep : sweeps) {
      const SweepBoard* best = nullptr;
      std::optional<Rigid3> seen;
      double nearest = std::numeric_limits<double>::infinity();
      for (const SweepBoard& board : sweep.boards) {
        const auto at = track.At(board.utime - FromSeconds(offset_s));
        if (!at) break;
        // At first the likeliest; then the one that lies where the pose puts the board.
        const double off =
            pose ? (*pose * board.lidar_from_target.translation - at->translation).norm()
                 : (best == nullptr ? 0 : 1);
        if (off >= nearest) continue;
        nearest = off;
        best = &board;
        seen = at;
      }
      if (best != nullptr) matched.push_back({*seen, best->lidar_from_target});
    }
    pose = FitPose(matched);
    if (!pose) return std::nullopt;
  }
  return pose;
}

std::string Milliseconds(double seconds) {
  return std::to_string(static_cast<int>(std::lround(1000 * seconds))) + " ms";
}

}  // namespace

std::optional<Rigid3> CameraTrack::At(Utime utime) const {
  const auto after =
      std::upper_bound(images_->begin(), images_->end(), utime,
                       [](Utime time, const PosedImage& image) { return time < image.utime; });
  if (after == images_->begin() || after == images_->end()) return std::nullopt;
  const PosedImage& to = *after;
  const PosedImage& from = *(after - 1);
  if (to.utime - from.utime > most_gap_) return std::nullopt;
  const double share =
      static_cast<double>(utime - from.utime) / static_cast<double>(to.utime - from.utime);
  const Rigid3& a = from.camera_from_target;
  const Rigid3& b = to.camera_from_target;
  return Rigid3{a.rotation.slerp(share, b.rotation),
                a.translation + share * (b.translation - a.translation)};
}

BoardSpeed SpeedOf(const CameraTrack& track, const std::vector<PosedImage>& images) {
  double way = 0;
  double turn = 0;
  int count = 0;
  for (const PosedImage& image : images) {
    const auto later = track.At(image.utime + FromSeconds(kSpeedOver));
    if (!later) continue;
    way += (later->translation - image.camera_from_target.translation).squaredNorm();
    const double turned = RotationDistance(*later, image.camera_from_target);
    turn += turned * turned;
    ++count;
  }
  if (count == 0) return {};
  return {std::sqrt(way / count) / kSpeedOver, std::sqrt(turn / count) / kSpeedOver};
}

FirstOffset FindFirstOffset(const CameraTrack& track, const std::vector<WavedSweep>& sweeps,
                            const Target& target, const std::optional<Rigid3>& camera_from_lidar,
                            const SyncOptions& options) {
  FirstOffset first;
  std::optional<Rigid3> pose = camera_from_lidar;
  if (!pose) {
    const std::vector<Moved> moves = MovesOf(sweeps);
    const auto by_moves = SearchByMoves(moves, track, options.most_offset_s);
    if (!by_moves) {
      first.why_not = "the board was found in too few sweeps (" + std::to_string(moves.size()) +
                      " moves of it) at the images' times; give a calibration to begin from";
      return first;
    }
    pose = PoseAtOffset(track, sweeps, by_moves->offset_s);
    if (!pose) {
      first.why_not =
          "boards in sweeps and in images do not fit one pose of the camera; is the target's size "
          "right?";
      return first;
    }
  }
  const std::vector<SomePoints> points =
      Choose(sweeps, track, target, pose->Inverse(), options.most_offset_s);
  auto best = SearchByPoints(points, track, target, *pose, -options.most_offset_s,
                             options.most_offset_s, kCoarse);
  if (!best) {
    first.why_not = "too few sweeps (" + std::to_string(points.size()) + " of " +
                    std::to_string(sweeps.size()) +
                    ") see the board at the images' times; wave it where both see it";
    return first;
  }
  const bool at_end =
      best->at_end && std::abs(best->offset_s) > options.most_offset_s - 0.5 * kCoarse;
  if (at_end || best->misfit > 0.5) {
    first.why_not = "at no offset within " + Milliseconds(options.most_offset_s) +
                    " the sweeps' points lie on the board where the images have it" +
                    (camera_from_lidar ? "; is the calibration this rig's?" : "");
    return first;
  }
  const auto finely = [&](double about) {
    return SearchByPoints(points, track, target, *pose, about - kCoarse, about + kCoarse, kFine);
  };
  const auto fine = finely(best->offset_s);
  const auto rival = best->elsewhere_s ? finely(*best->elsewhere_s) : std::nullopt;
  if (rival && rival->misfit < 1.1 * (fine ? fine->misfit : best->misfit)) {
    first.why_not = "more than one offset fits alike; wave the board faster, and not evenly";
    return first;
  }
  first.offset_s = fine ? fine->offset_s : best->offset_s;
  first.camera_from_lidar = *pose;
  return first;
}

}  // namespace rgbdt::sync
