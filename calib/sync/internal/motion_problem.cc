#include "calib/sync/internal/motion_problem.h"

#include <algorithm>
#include <cmath>

#include "calib/sync/internal/motion_equations.h"

namespace rgbdt::sync {
namespace {

constexpr int kMostRounds = 25;
constexpr double kAtRest = 2e-6;  // [s] that offsets and read-outs move by
// Likewise of a changing clock's places, about a jump of which nothing fits: less than is known.
constexpr double kChangesAtRest = 2e-4;

double Interpolated(const std::vector<double>& changes, int from, double share) {
  if (changes.empty()) return 0;
  const auto i = static_cast<std::size_t>(from);
  return (1 - share) * changes[i] + share * changes[i + 1];
}

}  // namespace

std::pair<int, double> ClockPlace(double seconds, double step_s, std::size_t places) {
  const int from = static_cast<int>(std::clamp(std::floor(seconds / step_s), 0.0,
                                               std::max(0.0, static_cast<double>(places) - 2)));
  return {from, std::clamp(seconds / step_s - from, 0.0, 1.0)};
}

double MotionState::ByClock(std::size_t camera, const PosedImage& image) const {
  const CameraState& state = cameras[camera];
  return ToSeconds(image.utime - way.start) + state.offset_s + state.rolling_s * image.middle_row;
}

double MotionState::SecondsOf(std::size_t camera, const PosedImage& image,
                              double clock_step_s) const {
  const CameraState& state = cameras[camera];
  const double by_clock = ByClock(camera, image);
  if (state.changes_s.empty()) return by_clock;
  const auto [place, share] = ClockPlace(by_clock, clock_step_s, state.changes_s.size());
  return by_clock + Interpolated(state.changes_s, place, share);
}

Trajectory FirstWay(const std::vector<PosedImage>& images, const CameraState& camera, Utime start,
                    double step_s, double to) {
  Trajectory way{start, step_s, {}};
  const Rigid3 lidar_from_camera = camera.camera_from_lidar.Inverse();
  const auto count = static_cast<int>(std::ceil(to / step_s)) + 4;
  std::size_t next = 0;
  for (int i = 0; i < count; ++i) {
    const double seconds = (i - 1) * step_s - camera.offset_s;
    const auto at = [&](std::size_t k) { return ToSeconds(images[k].utime - start); };
    while (next < images.size() && at(next) <= seconds) ++next;
    const std::size_t b = std::min(next, images.size() - 1);
    const std::size_t a = b == 0 || next == images.size() ? b : b - 1;
    const double gap = at(b) - at(a);
    const double share = gap > 0 ? std::clamp((seconds - at(a)) / gap, 0.0, 1.0) : 0;
    const Rigid3& from = images[a].camera_from_target;
    const Rigid3& to_pose = images[b].camera_from_target;
    way.knots.push_back(lidar_from_camera * Rigid3{from.rotation.slerp(share, to_pose.rotation),
                                                   from.translation + share * (to_pose.translation -
                                                                               from.translation)});
  }
  return way;
}

bool SolveMotion(const MotionData& data, MotionState* state) {
  MotionData narrowing = data;
  double gate = 0.15;
  for (int round = 0; round < kMostRounds; ++round) {
    narrowing.on_board.gate_m = std::max(gate, data.on_board.gate_m);
    const bool narrow = gate <= data.on_board.gate_m;
    gate *= 0.6;
    const MotionState before = *state;
    double moved_s = 0;
    if (!MotionEquations(narrowing, before).Step(state, &moved_s)) return false;
    if (narrow && moved_s < (data.clocks_change ? kChangesAtRest : kAtRest)) return true;
  }
  return false;
}

std::optional<MotionCovariance> CovarianceOf(const MotionData& data, const MotionState& state) {
  return MotionEquations(data, state).Covariance();
}

}  // namespace rgbdt::sync
