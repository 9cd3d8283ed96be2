#include "calib/sync/sync.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <utility>

#include "calib/camera/camera.h"
#include "calib/model/check.h"
#include "calib/model/errors.h"
#include "calib/sync/internal/clock_model.h"
#include "calib/sync/internal/first_offset.h"
#include "calib/sync/internal/motion_problem.h"

namespace rgbdt {
namespace {

// Read-outs come out too short by 0.07% (README, "How good it is"), why is not known.
constexpr double kRollingShare = 1e-3;

using sync::CameraData;
using sync::CameraState;
using sync::MotionCovariance;
using sync::MotionData;
using sync::MotionState;
using sync::PosedImage;

constexpr std::size_t kLeastImages = 20;
constexpr double kMostSeconds = 600;  // of the way
constexpr double kBeyondImages = 1;   // [s] that the way goes on where no image shows the board
constexpr double kLeastRanges = 4;    // sigma of a range: the gate about the board

std::string Text(const char* format, double a, double b = 0, double c = 0) {
  char text[300];
  std::snprintf(text, sizeof text, format, a, b, c);
  return text;
}

/// A camera on its way into the problem.
struct Entrant {
  std::size_t index = 0;  // in the input
  CameraData data;
  CameraState state;
  sync::BoardSpeed speed;
};

void CheckInput(const WavedBoard& input) {
  if (!input.target.HasPattern()) {
    throw InputError("the rig's target is plain; a waved board needs a pattern");
  }
  if (input.cameras.empty()) throw InputError("no camera to be synchronised");
  if (input.sweeps.empty()) throw InputError("no sweep to be synchronised with");
  for (const WavedSweep& sweep : input.sweeps) {
    if (sweep.points.size() != sweep.utime.size()) {
      throw InputError("a sweep has " + std::to_string(sweep.points.size()) + " points and " +
                       std::to_string(sweep.utime.size()) + " times");
    }
  }
}

double TypicalSigma(const std::vector<PosedImage>& images) {
  std::vector<double> sigmas;
  for (const PosedImage& image : images) sigmas.push_back(image.sigma_px);
  return std::max(1e-3, Median(std::move(sigmas), 0.1));
}

// The camera's images posed, and where its search begins; nothing, with the reason in `out`.
std::optional<Entrant> Enter(const WavedBoard& input, std::size_t index, const SyncOptions& options,
                             SyncedCamera* out) {
  const WavedCamera& given = input.cameras[index];
  Entrant entrant{index, CameraData{Camera(given.spec), {}, 0.1, 1, {}, Matrix6d::Zero()}, {}, {}};
  CameraData& data = entrant.data;
  data.images = sync::PoseImages(data.camera, input.target, given.images, &out->repeated);
  if (out->repeated > 0) {
    out->warnings.push_back(std::to_string(out->repeated) + " of " +
                            std::to_string(given.images.size()) +
                            " images show again what the one before showed; they were left out");
  }
  if (data.images.size() < kLeastImages) {
    out->why_not = "the board is seen in " + std::to_string(data.images.size()) +
                   " different images; " + std::to_string(kLeastImages) + " are the least";
    return std::nullopt;
  }
  data.sigma_px = TypicalSigma(data.images);
  const sync::CameraTrack track(data.images, options.most_gap_s);
  entrant.speed = sync::SpeedOf(track, data.images);
  if (entrant.speed.speed < options.least_speed && entrant.speed.turn_speed < options.least_speed) {
    out->why_not = Text("the board hardly moves: %.3f m/s, %.3f rad/s; wave it faster",
                        entrant.speed.speed, entrant.speed.turn_speed);
    return std::nullopt;
  }
  const sync::FirstOffset first =
      sync::FindFirstOffset(track, input.sweeps, input.target, given.camera_from_lidar, options);
  if (!first.why_not.empty()) {
    out->why_not = first.why_not;
    return std::nullopt;
  }
  entrant.state.camera_from_lidar = first.camera_from_lidar;
  entrant.state.offset_s = first.offset_s;
  if (given.camera_from_lidar && given.covariance) {
    data.prior_pose = given.camera_from_lidar;
    data.prior_covariance = *given.covariance;
  }
  return entrant;
}

// By the LIDAR's clock.
struct Span {
  Utime from = std::numeric_limits<Utime>::max();
  Utime to = std::numeric_limits<Utime>::min();

  void Add(Utime first, Utime last) {
    from = std::min(from, first);
    to = std::max(to, last);
  }
};

// Where there are both images of the board and sweeps. A clock that was set in the log, or a pause,
// must not stretch the way over years.
Span SpanOf(const std::vector<WavedSweep>& sweeps, const std::vector<Entrant>& entrants) {
  Span of_sweeps;
  for (const WavedSweep& sweep : sweeps) {
    if (!sweep.utime.empty()) of_sweeps.Add(sweep.utime.front(), sweep.utime.back());
  }
  Span of_images;
  for (const Entrant& entrant : entrants) {
    const std::vector<PosedImage>& images = entrant.data.images;
    of_images.Add(images.front().utime + FromSeconds(entrant.state.offset_s - kBeyondImages),
                  images.back().utime + FromSeconds(entrant.state.offset_s + kBeyondImages));
  }
  const Span span{std::max(of_sweeps.from, of_images.from), std::min(of_sweeps.to, of_images.to)};
  const double seconds = ToSeconds(span.to - span.from);
  if (!(seconds > 0 && seconds <= kMostSeconds)) {
    throw InputError(
        Text("images of the board and sweeps go on together for %.0f s; expected at "
             "most %.0f s: cut the log, and were clocks set while it was recorded?",
             seconds, kMostSeconds));
  }
  return span;
}

// The camera that has most to tell of the way.
std::size_t Busiest(const std::vector<Entrant>& entrants) {
  std::size_t best = 0;
  for (std::size_t i = 1; i < entrants.size(); ++i) {
    if (entrants[i].data.images.size() > entrants[best].data.images.size()) best = i;
  }
  return best;
}

double TypicalPeriod(const std::vector<PosedImage>& images) {
  std::vector<double> periods;
  for (std::size_t i = 1; i < images.size(); ++i) {
    periods.push_back(ToSeconds(images[i].utime - images[i - 1].utime));
  }
  return Median(std::move(periods), 0.1);
}

// Cameras order corners up to half a turn: all as the leader does.
void AlignHalfTurns(const sync::Trajectory& way, const MotionState& state,
                    std::vector<Entrant>* entrants) {
  for (std::size_t c = 0; c < entrants->size(); ++c) {
    CameraData& data = (*entrants)[c].data;
    const Rigid3 lidar_from_camera = state.cameras[c].camera_from_lidar.Inverse();
    int turned = 0;
    int told = 0;
    for (const PosedImage& image : data.images) {
      const double seconds = state.SecondsOf(c, image, 1);
      if (seconds < 0 || seconds > way.Length()) continue;
      turned += RotationDistance(lidar_from_camera * image.camera_from_target, way.At(seconds)) >
                        0.5 * M_PI
                    ? 1
                    : 0;
      ++told;
    }
    if (2 * turned <= told) continue;
    for (PosedImage& image : data.images) TurnByHalf(&image);
  }
}

struct Posed {
  MotionData data;
  MotionState state;
};

Posed Begin(const WavedBoard& input, const SyncOptions& options, std::vector<Entrant> entrants) {
  Posed begun;
  const Span span = SpanOf(input.sweeps, entrants);
  const Entrant& leader = entrants[Busiest(entrants)];
  const double step = std::clamp(TypicalPeriod(leader.data.images), 0.05, 0.1);
  begun.state.way = sync::FirstWay(leader.data.images, leader.state, span.from, step,
                                   ToSeconds(span.to - span.from));
  for (const Entrant& entrant : entrants) begun.state.cameras.push_back(entrant.state);
  AlignHalfTurns(begun.state.way, begun.state, &entrants);
  begun.data.target = input.target;
  begun.data.sweeps = sync::AboutBoard(input.sweeps, input.target, begun.state.way);
  for (Entrant& entrant : entrants) begun.data.cameras.push_back(std::move(entrant.data));
  begun.data.on_board = {options.margin_m, kLeastRanges * input.range_sigma_m, input.range_sigma_m};
  begun.data.range_offset_sigma_m = input.range_offset_sigma_m;
  begun.data.clock_step_s = options.clock_step_s;
  begun.data.most_gap_s = options.most_gap_s;
  return begun;
}

double FactorOf(const sync::Misfit& misfit, double before) {
  return misfit.freedom < 10 ? before : std::max(1.0, before * misfit.chi2 / misfit.freedom);
}

// Noise of corners and points from their own scatter, that of images and sweeps from how they fit.
void LearnNoise(const MotionCovariance& found, MotionData* data) {
  for (std::size_t c = 0; c < data->cameras.size(); ++c) {
    const sync::Misfit& misfit = found.camera_misfits[c];
    CameraData& camera = data->cameras[c];
    if (misfit.points > 10) camera.sigma_px *= std::sqrt(misfit.point_chi2 / misfit.points);
    camera.variance_factor = FactorOf(misfit, camera.variance_factor);
  }
  const sync::Misfit& sweeps = found.sweep_misfit;
  if (sweeps.points > 10) {
    data->on_board.sigma_m *= std::sqrt(sweeps.point_chi2 / sweeps.points);
    data->on_board.gate_m = std::max(data->on_board.gate_m, kLeastRanges * data->on_board.sigma_m);
  }
  data->sweep_variance_factor = FactorOf(sweeps, data->sweep_variance_factor);
}

std::string Milliseconds(double seconds) { return Text("%.3f ms", 1e3 * seconds); }

const char* const kChangeNotTold = "whether the offset changes is not told";

// The offset over time, where images tell it, and what is to be said of it.
void LookAtClock(const MotionState& state, const MotionCovariance& found, std::size_t camera,
                 double step_s, const SyncOptions& options, SyncedCamera* out) {
  const std::vector<double>& changes = state.cameras[camera].changes_s;
  const Eigen::MatrixXd& covariance = found.changes[camera];
  std::vector<Eigen::Index> told;
  for (Eigen::Index k = 0; k < covariance.rows(); ++k) {
    if (std::sqrt(covariance(k, k)) < sync::kToldChange) told.push_back(k);
  }
  if (told.size() < 4) out->warnings.push_back(kChangeNotTold);
  const auto count = static_cast<Eigen::Index>(told.size());
  sync::OffsetsOverTime over{Eigen::VectorXd(count), Eigen::VectorXd(count),
                             Eigen::MatrixXd(count, count)};
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Index k = told[static_cast<std::size_t>(i)];
    over.seconds[i] = static_cast<double>(k) * step_s;
    over.values[i] = changes[static_cast<std::size_t>(k)];
    for (Eigen::Index j = 0; j < count; ++j) {
      over.covariance(i, j) = covariance(k, told[static_cast<std::size_t>(j)]);
    }
    out->offsets.push_back(
        {over.seconds[i],
         {state.cameras[camera].offset_s + over.values[i], std::sqrt(over.covariance(i, i))}});
  }
  const sync::ClockModel clock = sync::FitClock(over);
  if (!clock.jump && !clock.drift && !clock.wanders) return;
  out->time_offset_s.value = state.cameras[camera].offset_s + clock.mean_s;
  out->time_offset_s.sigma = std::hypot(out->time_offset_s.sigma, clock.spread_s);
  if (out->time_offset_s.sigma > options.most_sigma_s) {
    out->why_not =
        "the clock changes by " + Milliseconds(clock.spread_s) + " (RMS); no one offset holds";
  }
  out->drift = clock.drift;
  if (clock.jump) out->jump = OffsetAt{clock.jump->seconds, clock.jump->by_s};
  const std::string remedy = "; without PTP or a common trigger the offset holds for this log only";
  if (clock.jump) {
    out->warnings.push_back("the clock jumps by " + Milliseconds(clock.jump->by_s.value) +
                            Text(" about %.0f s after the first sweep used", clock.jump->seconds) +
                            remedy);
  } else if (clock.drift) {
    out->warnings.push_back(Text("the clock drifts by %.0f +- %.0f us/s", 1e6 * clock.drift->value,
                                 1e6 * clock.drift->sigma) +
                            remedy);
  } else {
    out->warnings.push_back("the offset changes by " + Milliseconds(clock.spread_s) +
                            " (RMS) over time, beyond chance" + remedy);
  }
}

void Report(const Posed& solved, const MotionCovariance& found, std::size_t camera,
            const SyncOptions& options, SyncedCamera* out) {
  const CameraState& state = solved.state.cameras[camera];
  const CameraData& data = solved.data.cameras[camera];
  const Eigen::Matrix<double, 8, 8>& covariance = found.cameras[camera];
  out->time_offset_s = {state.offset_s, std::sqrt(covariance(0, 0))};
  out->rolling_s = {state.rolling_s,
                    std::hypot(std::sqrt(covariance(1, 1)), kRollingShare * state.rolling_s)};
  out->camera_from_lidar = state.camera_from_lidar;
  out->covariance = covariance.bottomRightCorner<6, 6>();
  out->images = static_cast<int>(data.images.size());
  out->corner_rms_px = data.sigma_px;
  out->variance_factor = data.variance_factor;
  if (out->time_offset_s.sigma > options.most_sigma_s) {
    out->why_not = "the offset is known to " + Milliseconds(out->time_offset_s.sigma) +
                   " only; wave the board faster, and towards the LIDAR and away";
  } else if (std::abs(state.offset_s) > options.most_offset_s) {
    out->why_not = "the offset went beyond " + Milliseconds(options.most_offset_s);
  }
}

void Solve(const SyncOptions& options, const std::vector<std::size_t>& indices, Posed* posed,
           SyncResult* result) {
  const auto all_failed = [&](const std::string& why) {
    for (const std::size_t index : indices) result->cameras[index].why_not = why;
  };
  const std::string no_rest = "the solve did not come to rest; is the board seen all the time?";
  MotionCovariance found;
  for (int round = 0; round < 3; ++round) {
    if (!sync::SolveMotion(posed->data, &posed->state)) return all_failed(no_rest);
    const auto covariance = sync::CovarianceOf(posed->data, posed->state);
    if (!covariance) return all_failed("images and sweeps do not tell the board's way everywhere");
    found = *covariance;
    if (found.sweeps < 10) {
      return all_failed(std::to_string(found.sweeps) +
                        " sweeps show the board where the images have it; 10 are the least");
    }
    if (round < 2) LearnNoise(found, &posed->data);
  }
  for (std::size_t c = 0; c < indices.size(); ++c) {
    Report(*posed, found, c, options, &result->cameras[indices[c]]);
  }
  result->start = posed->state.way.start;
  result->sweeps = found.sweeps;
  result->seconds = found.last_s - found.first_s;
  result->plane_rms_m = posed->data.on_board.sigma_m;
  result->variance_factor = posed->data.sweep_variance_factor;
  if (posed->data.range_offset_sigma_m > 0) {
    result->range_offset_m = {posed->state.range_offset_m, std::sqrt(found.range_offset_m2)};
  }
  // Once more, with offsets that may change.
  const auto not_told = [&] {
    for (const std::size_t index : indices) {
      SyncedCamera& out = result->cameras[index];
      if (out.why_not.empty()) out.warnings.push_back(kChangeNotTold);
    }
  };
  const double seconds = found.last_s;
  const auto places = static_cast<std::size_t>(std::floor(seconds / options.clock_step_s)) + 1;
  if (places < 4) return not_told();
  MotionState changing = posed->state;
  posed->data.clocks_change = true;
  posed->data.clock_step_s = seconds / static_cast<double>(places - 1);
  for (CameraState& camera : changing.cameras) camera.changes_s.assign(places, 0.0);
  if (!sync::SolveMotion(posed->data, &changing)) return not_told();
  const auto over_time = sync::CovarianceOf(posed->data, changing);
  if (!over_time) return not_told();
  for (std::size_t c = 0; c < indices.size(); ++c) {
    SyncedCamera& out = result->cameras[indices[c]];
    if (out.why_not.empty()) {
      LookAtClock(changing, *over_time, c, posed->data.clock_step_s, options, &out);
    }
  }
}

}  // namespace

void SyncOptions::Check() const {
  const auto require = [](bool good, const std::string& field, double value,
                          const std::string& expected) {
    if (!good) {
      throw InputError("sync: " + field + " is " + std::to_string(value) + "; expected " +
                       expected);
    }
  };
  require(most_offset_s > 0 && most_offset_s <= 10, "most_offset_s", most_offset_s, "0 to 10");
  require(margin_m >= 0 && margin_m < 1, "margin_m", margin_m, "0 to 1");
  require(least_speed >= 0, "least_speed", least_speed, "0 or more");
  require(most_sigma_s > 0, "most_sigma_s", most_sigma_s, "more than 0");
  require(clock_step_s >= 0.5, "clock_step_s", clock_step_s, "0.5 or more");
  require(most_gap_s > 0 && most_gap_s <= 2, "most_gap_s", most_gap_s, "0 to 2");
}

WavedSweep TakeWavedSweep(const Cloud& cloud, double most_range_m) {
  if (cloud.utime.size() != cloud.size()) {
    throw InputError("a sweep of " + std::to_string(cloud.size()) + " points has " +
                     std::to_string(cloud.utime.size()) +
                     " times; the LIDAR's driver must publish each point's");
  }
  const auto [first, last] = std::minmax_element(cloud.utime.begin(), cloud.utime.end());
  if (cloud.size() > 1 && *first == *last) {
    throw InputError("all " + std::to_string(cloud.size()) +
                     " points of a sweep bear one time; the LIDAR's driver must publish each "
                     "point's");
  }
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (cloud.IsHit(i) && cloud.points[i].norm() < most_range_m && cloud.points[i].norm() > 0.1) {
      order.push_back(i);
    }
  }
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return cloud.utime[a] < cloud.utime[b]; });
  WavedSweep sweep;
  for (const std::size_t i : order) {
    sweep.points.push_back(cloud.points[i]);
    sweep.utime.push_back(cloud.utime[i]);
  }
  return sweep;
}

SyncResult Synchronise(const WavedBoard& input, const SyncOptions& options) {
  options.Check();
  CheckInput(input);
  SyncResult result;
  result.cameras.resize(input.cameras.size());
  std::vector<Entrant> entrants;
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < input.cameras.size(); ++i) {
    result.cameras[i].camera = input.cameras[i].spec.name;
    auto entrant = Enter(input, i, options, &result.cameras[i]);
    if (!entrant) continue;
    indices.push_back(i);
    entrants.push_back(std::move(*entrant));
  }
  if (entrants.empty()) return result;
  const sync::BoardSpeed speed = entrants[Busiest(entrants)].speed;
  result.speed = speed.speed;
  result.turn_speed = speed.turn_speed;
  Posed posed = Begin(input, options, std::move(entrants));
  Solve(options, indices, &posed, &result);
  return result;
}

std::string OffsetInPixels(const CameraSpec& spec, double offset_s) {
  const double focal = 0.5 * (spec.lens.fx + spec.lens.fy);
  const double seconds = std::abs(offset_s);
  return Text(
      "left in, it moves colours by %.1f px at 1 m/s across (3 m away) and by %.1f px at "
      "1 rad/s",
      focal * seconds / 3, focal * seconds);
}

}  // namespace rgbdt
