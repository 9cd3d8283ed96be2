#include "calib/solve/internal/encoder_delay.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <set>
#include <string>
#include <utility>

#include "calib/model/linear_algebra.h"
#include "calib/model/statistics.h"
#include "calib/model/text.h"

namespace rgbdt {
namespace {

using Index = Eigen::Index;

constexpr double kDegrees = 180 / M_PI;
// How late an encoder may be stamped where nothing tells (1 sigma): motors and scanners are stamped
// as they are heard, and a serial adapter of USB holds bytes for up to 16 ms. Motors that turn so
// fast that this would be more than an angle are stamped better.
constexpr double kUsualSigmaS = 0.005;
constexpr double kMostCountedRad = 0.005;
constexpr double kMostLateS = 1;       // as a rig file may have it
constexpr double kStandsStill = 1e-4;  // [rad/s] and less: no motor
constexpr double kLooksLate = 2;       // sigmas, from which on it is tried
constexpr double kRoughlyLate = 4;     // the same, of the rough estimate
constexpr double kDelaySettled = 0.5;  // sigmas that may be left
constexpr double kMostTurned = 0.2;    // [rad] of a view beside the first guess
constexpr int kMostTries = 4;
// By what factor of variance views may still scatter beyond what they state once it is taken off,
// unless that is less than a tenth of what it was.
constexpr double kMostLeft = 6, kMostOfBefore = 0.1;

bool Turns(const BoardView& view) { return std::abs(view.cloud.turn_rad_s) > kStandsStill; }

// How the motor turned; nothing where no cloud tells that it did.
std::optional<EncoderDelay> RatesOf(const std::vector<BoardView>& views) {
  std::size_t forward = 0, back = 0;
  EncoderDelay delay;
  for (const BoardView& view : views) {
    if (!Turns(view)) continue;
    ++(view.cloud.turn_rad_s > 0 ? forward : back);
    delay.turn_rad_s += std::abs(view.cloud.turn_rad_s);
  }
  if (forward + back == 0) return std::nullopt;
  delay.turn_rad_s /= static_cast<double>(forward + back);
  delay.views_of_fewer_way = std::min(forward, back);
  delay.all_clouds_tell = forward + back == views.size();
  delay.known_sigma_s = std::min(kUsualSigmaS, kMostCountedRad / delay.turn_rad_s);
  return delay;
}

// All poses as they change when a view's cloud of the reference LIDAR turns about its z, by this
// rate.
Eigen::VectorXd Direction(const BoardProblem& problem, const BoardState& state, double turn) {
  const SharedPlaces places(problem);
  Eigen::VectorXd w = Eigen::VectorXd::Zero(places.Count());
  for (std::size_t c = 0; c < state.camera_from_lidar.size(); ++c) {
    w.segment<6>(SharedPlaces::Pose(c)) = turn * Adjoint(state.camera_from_lidar[c]).col(2);
  }
  for (std::size_t l = 0; l < problem.lidars.size(); ++l) w[places.LidarPose(l) + 2] = -turn;
  return w;
}

CloudEdges Turned(const CloudEdges& cloud, double angle) {
  const Rigid3 by = RotationAbout(Eigen::Vector3d::UnitZ(), angle);
  const Eigen::Matrix3d r = by.rotation.toRotationMatrix();
  Eigen::Matrix4d about_centre = Eigen::Matrix4d::Identity();
  about_centre.topLeftCorner<3, 3>() = r;
  const auto turn_scatter = [&](Eigen::Matrix4d* scatter) {
    *scatter = about_centre * *scatter * about_centre.transpose();
  };
  CloudEdges out = cloud;
  for (Eigen::Vector3d& point : out.boundary) point = by * point;
  for (Eigen::Vector3d& corner : out.corners) corner = by * corner;
  for (Crossing& crossing : out.crossings) crossing.point = by * crossing.point;
  out.centre = by * out.centre;
  out.normal = r * out.normal;
  if (out.pose) {
    out.pose->sensor_from_target = by * out.pose->sensor_from_target;
    const Matrix6d adjoint = Adjoint(by);
    out.pose->covariance = adjoint * out.pose->covariance * adjoint.transpose();
  }
  turn_scatter(&out.scatter);
  turn_scatter(&out.raw_scatter);
  for (PointGroup& group : out.groups) turn_scatter(&group.scatter);
  return out;
}

// How a view's cloud turned, and the turn about the LIDAR's z by which the view alone has the
// camera beside the guess.
struct TurnedBeside {
  double turn_rad_s = 0;
  double turned_rad = 0;
};

// Of the candidate that fits the guess best. Also of views that are too far beside it to be used.
std::optional<TurnedBeside> TurnedBesideGuess(const CameraView& view,
                                              const Rigid3& camera_from_lidar) {
  if (view.image == nullptr || !view.image->pose) return std::nullopt;
  const Rigid3 seen = camera_from_lidar.Inverse() * view.image->pose->sensor_from_target;
  std::optional<TurnedBeside> best;
  double least = kMostTurned;
  for (const CloudEdges* candidate : view.candidates) {
    if (!candidate->pose || std::abs(candidate->turn_rad_s) < kStandsStill) continue;
    for (int quarter = 0; quarter < 4; ++quarter) {
      const Rigid3 meant = candidate->pose->sensor_from_target * QuarterTurns(quarter);
      const Rigid3 beside = seen * meant.Inverse();
      const double turned = RotationDistance(beside, {});
      if (turned > least) continue;
      least = turned;
      best = {candidate->turn_rad_s, Log(beside)[2]};
    }
  }
  return best;
}

// Median, and by how much it is uncertain.
Estimate RobustMean(std::vector<double> values) {
  const double middle = Median(values);
  const auto count = static_cast<double>(values.size());
  for (double& value : values) value = std::abs(value - middle);
  return {middle, 1.4826 * 1.2533 * Median(std::move(values)) / std::sqrt(count)};
}

std::string CannotTell(const EncoderDelay& delay) {
  const char* why = !delay.all_clouds_tell ? "Not all clouds tell which way the motor turned"
                    : delay.views_of_fewer_way == 0 ? "All sweeps turned the same way"
                    : !delay.BothWays()             ? "Too few sweeps turned the other way"
                                                    : "Too little tells how late the encoder is";
  return Format(
      "%s: an encoder that is stamped 10 ms late turns the result by up to %.2f deg, and nothing "
      "here shows it (1 sigma counts %.0f ms). Take views with the motor turning one way and the "
      "other in turn.",
      why, 0.01 * kDegrees * delay.turn_rad_s, 1000 * delay.known_sigma_s);
}

// Of the result, which has it taken off: how far clouds lie beside it that have not.
Cause CauseOf(const EncoderDelay& delay, const CameraCalibration& camera) {
  const double seconds = delay.seconds.value;
  const double turn = seconds * delay.turn_rad_s;
  const char* which = seconds > 0 ? "late" : "early";
  Cause cause{
      "encoder's delay",
      Format(
          "the motor's encoder is stamped %.1f +- %.1f ms %s: clouds of sweeps that turn one way "
          "lie %.2f deg beside those of the other way. Add %.4f to encoder_delay_s of the rig "
          "file's turned_scanner (it is 0 where left out), and take the session again",
          1000 * std::abs(seconds), 1000 * delay.seconds.sigma, which,
          2 * kDegrees * std::abs(turn), seconds),
      std::pow(seconds / delay.seconds.sigma, 2), 1, std::nullopt};
  if (camera.covariance) {
    const Vector6d move = turn * Adjoint(camera.camera_from_lidar).col(2);
    cause.moves_sigma = std::sqrt(move.dot(SolveSymmetric(*camera.covariance, move)));
  }
  return cause;
}

bool LooksLate(const EncoderDelay& delay) {
  const double size = std::abs(delay.seconds.value);
  return delay.BothWays() && (size > kLooksLate * delay.seconds.sigma ||
                              size > kGivenWrongSigmas * delay.stated_sigma_s);
}

std::size_t ImagesUsed(const CalibratedCameras& calibrated) {
  std::size_t used = 0;
  for (const CameraViews& camera : calibrated.cameras) {
    if (camera.report.calibration.solved()) used += camera.Used().size();
  }
  return used;
}

// Whether a delay is there beyond doubt, by what is left where `taken_off_s` of it is taken off,
// and the result is no worse for it.
bool IsSure(const CalibratedCameras& found, double taken_off_s,
            const CalibratedCameras& as_they_are) {
  const auto& left = found.encoder_delay;
  if (!left || !left->BothWays()) return false;
  // Where views contradict each other nearly as much as before, it is something else that they
  // show.
  for (std::size_t c = 0; c < found.cameras.size(); ++c) {
    const double now = found.cameras[c].report.variance_factor;
    const double before = as_they_are.cameras[c].report.variance_factor;
    if (now > kMostLeft && now > kMostOfBefore * before) return false;
  }
  const Estimate& seconds = left->seconds;
  const double total = taken_off_s + seconds.value;
  return std::abs(seconds.value) < kDelaySettled * seconds.sigma &&
         std::abs(total) > kGivenWrongSigmas * seconds.sigma && std::abs(total) <= kMostLateS &&
         ImagesUsed(found) >= ImagesUsed(as_they_are);
}

CalibratedCameras Told(CalibratedCameras calibrated, double taken_off_s) {
  if (!calibrated.encoder_delay) return calibrated;
  EncoderDelay delay = *calibrated.encoder_delay;
  delay.seconds.value += taken_off_s;
  for (CameraViews& camera : calibrated.cameras) {
    CameraReport& report = camera.report;
    if (!report.calibration.solved()) continue;
    if (taken_off_s == 0 && !delay.IsTold()) {
      report.cannot_tell = CannotTell(delay);
      continue;
    }
    report.nuisance.push_back(
        {"encoder's delay", "ms", {1000 * delay.seconds.value, 1000 * delay.seconds.sigma}});
    if (taken_off_s == 0) continue;
    report.causes.insert(report.causes.begin(), CauseOf(delay, report.calibration));
  }
  return calibrated;
}

}  // namespace

std::optional<EncoderDelay> EncoderDelayOf(const JointResult& result) {
  const BoardProblem& problem = result.joint.problem;
  const BoardSolution& solution = result.solution;
  std::optional<EncoderDelay> delay = RatesOf(problem.views);
  if (!delay) return std::nullopt;
  Eigen::VectorXd gradient = PriorInformation(problem, solution.state).gradient;
  Eigen::VectorXd all = Eigen::VectorXd::Zero(gradient.size());  // the views' information along W
  double information = 0, score = 0, usual = 0;
  for (const BoardView& view : problem.views) usual += view.cloud.turn_rad_s;
  usual = std::copysign(delay->turn_rad_s, usual);
  for (std::size_t v = 0; v < problem.views.size(); ++v) {
    const ViewInformation& view = solution.views[v];
    gradient += view.gradient;
    // Where a cloud does not tell, as most of the others: that moves the poses the most.
    const bool turns = Turns(problem.views[v]);
    const double turn = turns ? problem.views[v].cloud.turn_rad_s : usual;
    const Eigen::VectorXd w = Direction(problem, solution.state, turn);
    const Eigen::VectorXd of_view = view.information * w;
    all += of_view;
    information += w.dot(of_view);
    score += w.dot(view.gradient);
  }
  const Eigen::VectorXd move = solution.covariance * all;
  information -= all.dot(move);
  score -= move.dot(gradient);
  const bool any = information > 0;
  const double variance = any ? result.variance_factor / information : HUGE_VAL;
  delay->seconds = {any ? score / information : 0, std::sqrt(variance)};
  delay->stated_sigma_s = std::sqrt(variance / result.variance_factor);
  // With what is known beforehand; what is found is not taken off here.
  const double known = 1 / (1 / variance + 1 / std::pow(delay->known_sigma_s, 2));
  const double mean = known * delay->seconds.value / variance;
  delay->unknown_move = std::sqrt(known + mean * mean) * move;
  return delay;
}

std::optional<Estimate> RoughEncoderDelay(const std::vector<GuessedCamera>& cameras) {
  // One way, and the other.
  std::array<std::vector<double>, 2> turned;
  std::array<std::set<std::string>, 2> views;
  std::array<double, 2> rate{};
  for (const GuessedCamera& camera : cameras) {
    if (!camera.guess.camera_from_lidar) continue;
    for (const CameraView& view : camera.views.all) {
      const auto beside = TurnedBesideGuess(view, *camera.guess.camera_from_lidar);
      if (!beside) continue;
      const std::size_t way = beside->turn_rad_s > 0 ? 0 : 1;
      turned[way].push_back(beside->turned_rad);
      views[way].insert(view.view);
      rate[way] += beside->turn_rad_s;
    }
  }
  if (std::min(views[0].size(), views[1].size()) < EncoderDelay::kLeastEachWay) return std::nullopt;
  for (std::size_t way = 0; way < 2; ++way) rate[way] /= static_cast<double>(turned[way].size());
  const Estimate one = RobustMean(std::move(turned[0])), other = RobustMean(std::move(turned[1]));
  const double apart = rate[0] - rate[1];
  return Estimate{(one.value - other.value) / apart, std::hypot(one.sigma, other.sigma) / apart};
}

CameraViews WithoutEncoderDelay(CameraViews camera, double delay_s) {
  if (delay_s == 0) return camera;
  for (CameraView& view : camera.all) {
    for (const CloudEdges*& candidate : view.candidates) {
      auto turned =
          std::make_shared<CloudEdges>(Turned(*candidate, delay_s * candidate->turn_rad_s));
      candidate = turned.get();
      camera.turned_clouds.push_back(std::move(turned));
    }
    if (view.cloud) view.cloud = Turned(*view.cloud, delay_s * view.cloud->turn_rad_s);
  }
  return camera;
}

CalibratedCameras CalibrateWithoutEncoderDelay(
    const std::function<CalibratedCameras(double delay_s)>& calibrate) {
  CalibratedCameras as_they_are = calibrate(0);
  const std::optional<Estimate> rough = as_they_are.rough_encoder_delay;
  const auto& first = as_they_are.encoder_delay;
  double next = 0;
  if (rough && std::abs(rough->value) > kRoughlyLate * rough->sigma) {
    next = rough->value;
  } else if (first && LooksLate(*first)) {
    next = first->seconds.value;
  }
  if (next == 0) return Told(std::move(as_they_are), 0);
  double taken_off = 0;
  CalibratedCameras found;
  for (int i = 0; i < kMostTries; ++i) {
    taken_off += next;
    found = calibrate(taken_off);
    if (!found.encoder_delay) break;
    next = found.encoder_delay->seconds.value;
    if (std::abs(next) < kDelaySettled * found.encoder_delay->seconds.sigma) break;
  }
  const bool sure = IsSure(found, taken_off, as_they_are);
  return sure ? Told(std::move(found), taken_off) : Told(std::move(as_they_are), 0);
}

}  // namespace rgbdt
