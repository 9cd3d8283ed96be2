#include "calib/methods/refine.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calib/methods/edge_grid/by_edge_grid.h"
#include "calib/methods/gradient_orientation/by_gradient_orientation.h"
#include "calib/methods/mutual_information/by_mutual_information.h"
#include "calib/methods/natural/direction_words.h"
#include "calib/methods/natural/shot_places.h"
#include "calib/model/errors.h"
#include "calib/model/stopwatch.h"
#include "calib/solve/colouring.h"

namespace rgbdt {
namespace {

constexpr double kUntold = 0.5;  // of the start's sigma: a direction that the scene hardly told

// One camera's shots: those to solve with, and those to judge by.
struct CameraShots {
  std::vector<Shot> used, heldout;
};

std::vector<Shot> Spread(const std::vector<Shot>& shots, std::size_t most) {
  if (shots.size() <= most) return shots;
  std::vector<Shot> kept;
  for (std::size_t i = 0; i < most; ++i) kept.push_back(shots[i * shots.size() / most]);
  return kept;
}

// By the poses that a drive's views keep, or else by the sweeps.
std::vector<ShotPlace> PlacesOf(const std::vector<View>& views) {
  std::vector<ShotPlace> places;
  std::vector<const Cloud*> sweeps;
  for (const View& view : views) {
    if (view.map_from_lidar) places.push_back({0, *view.map_from_lidar});
    sweeps.push_back(&view.cloud);
  }
  return places.size() == views.size() ? places : FindPlaces(sweeps);
}

CameraShots ShotsOf(const std::string& camera, const std::vector<View>& views,
                    const std::vector<ShotPlace>& places, std::size_t most) {
  CameraShots shots;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const View& view = views[i];
    const auto image = std::find_if(view.images.begin(), view.images.end(),
                                    [&](const Image& one) { return one.camera == camera; });
    if (image == view.images.end()) continue;
    (view.heldout ? shots.heldout : shots.used)
        .push_back({view.name, &view.cloud, &*image, places[i]});
  }
  // A result that nothing was left out to judge by may be worse than the start.
  if (shots.heldout.empty() && shots.used.size() > 1) {
    shots.heldout.push_back(shots.used.back());
    shots.used.pop_back();
  }
  return {Spread(shots.used, most), Spread(shots.heldout, most)};
}

std::vector<std::string> NamesOf(const std::vector<Shot>& shots) {
  std::vector<std::string> names;
  names.reserve(shots.size());
  for (const Shot& shot : shots) names.push_back(shot.view);
  return names;
}

SceneAlignment Align(const CameraSpec& spec, const std::vector<Shot>& shots, const Rigid3& start,
                     const RefineOptions& options) {
  if (options.method == "natural") {
    return AlignToScene(MakeSceneProblem(spec, shots, options.natural), start, options.natural);
  }
  SceneAlignment out;
  out.state.lens = spec.lens;
  out.look.sigma_px = 1;
  out.fit = options.method == "mi"    ? AlignByMutualInformation(spec, shots, start)
            : options.method == "nmi" ? AlignByNormalisedMutualInformation(spec, shots, start)
            : options.method == "gom" ? AlignByGradientOrientation(spec, shots, start)
                                      : AlignByEdgeGrid(spec, shots, start);
  out.state.camera_from_lidar = out.fit.camera_from_lidar;
  out.sums = SceneProblem(spec, shots, options.natural.edges, 1).SumsAt(out.state, out.look);
  return out;
}

void SayWhatIsUntold(const SceneAlignment& found, const NaturalOptions& options,
                     CameraReport* report) {
  const Vector6d sigma = options.StartCovariance().diagonal().cwiseSqrt();
  for (const SceneAlignment::Direction& direction : found.directions) {
    if (direction.ratio < kUntold) break;
    const Eigen::Index number = MainNumber(direction.delta, sigma);
    report->warnings.push_back("the scene hardly tells " + DirectionWords(number) +
                               ": it stays about where it was; take sweeps that show " +
                               NeededFor(number));
  }
}

// The lens that natural found, with the covariance that pose and lens have together; absent: it was
// taken for exact, or the method does not look for it.
std::optional<SolvedLens> LensOf(const SceneAlignment& found, const CameraSpec& spec) {
  if (found.covariance.isZero(0) || spec.LensUncertaintyOrUsual().exact()) return std::nullopt;
  SolvedLens lens{found.state.lens, {}};
  lens.covariance.leftCols<6>() = found.covariance.block<kLensNumbers, 6>(kLensAt, 0);
  lens.covariance.rightCols<kLensNumbers>() =
      found.covariance.bottomRightCorner<kLensNumbers, kLensNumbers>();
  return lens;
}

// What the sweeps that were left out say of the start and of the result.
SceneCheck CheckOf(const CameraSpec& spec, const CameraShots& shots, const SceneAlignment& found,
                   const Rigid3& start, const NaturalOptions& options) {
  SceneCheck check;
  check.edges = found.sums.Depth().edges;
  check.shown = found.sums.Depth().Share();
  if (shots.heldout.empty()) return check;
  const SceneProblem heldout(spec, shots.heldout, options.edges, 1);
  if (heldout.edges() == 0) return check;
  SceneAlignment before = found;  // the beam is the LIDAR's; the lens belongs to the pose
  before.state.lens = spec.lens;
  if (!(heldout.SumsAt(found.state, found.look).All().edges > 0)) return check;
  check.heldout_start = SceneFitness(heldout, before, start);
  check.heldout_result = SceneFitness(heldout, found, found.fit.camera_from_lidar);
  return check;
}

bool IsWorse(const SceneCheck& check) {
  return check.heldout_start && *check.heldout_result < *check.heldout_start;
}

CameraReport RefineCamera(const CameraSpec& rig_spec, const std::vector<View>& views,
                          const std::vector<ShotPlace>& places, const Calibration& start,
                          const RefineOptions& options) {
  CameraReport report;
  report.calibration.camera = rig_spec.name;
  const CameraCalibration* given = start.Find(rig_spec.name);
  const std::optional<Rigid3> pose = given != nullptr && given->solved()
                                         ? std::optional(given->camera_from_lidar)
                                         : rig_spec.camera_from_lidar_guess;
  const CameraSpec spec = start.WithSolvedLens(rig_spec);
  const CameraShots shots = ShotsOf(spec.name, views, places, options.most_sweeps);
  report.used = NamesOf(shots.used);
  report.heldout = NamesOf(shots.heldout);
  if (!pose) {
    report.calibration.detail =
        "nothing to start from: give a calibration, or camera_from_lidar_guess in the rig file";
    return report;
  }
  report.first_guess = *pose;
  report.calibration.camera_from_lidar = *pose;
  if (shots.used.empty()) {
    report.calibration.detail = "no view with an image of this camera is there to solve with";
    return report;
  }
  const Stopwatch watch;
  SceneAlignment found = Align(spec, shots.used, *pose, options);
  report.solve_s = watch.Seconds();
  report.scene = CheckOf(spec, shots, found, *pose, options.natural);
  report.scene->joined = options.join_start;
  CameraCalibration& result = report.calibration;
  if (given != nullptr) {
    result.timing = given->timing;
    // Which belong to the pose, as long as nothing else was found.
    result.lens = given->lens;
    result.range_errors = given->range_errors;
  }
  if (!found.fit.converged) {
    result.status = SolveStatus::kNotConverged;
    result.detail = found.fit.why_not;
    return report;
  }
  if (IsWorse(*report.scene)) {
    const std::string kept = "on sweeps that were left out the start fits better; it is kept";
    if (given != nullptr && given->converged()) {
      result = *given;
      result.status = SolveStatus::kFirstGuessKept;
      result.detail = given->detail.empty() ? kept : given->detail + "; " + kept;
    } else {
      result.status = SolveStatus::kNotConverged;
      result.detail = kept + ", and it is no calibration";
    }
  } else {
    result.camera_from_lidar = found.fit.camera_from_lidar;
    result.status = SolveStatus::kConverged;
    result.covariance = found.fit.covariance;
    if (const auto lens = LensOf(found, spec)) result.lens = lens;
    report.variance_factor = found.scatter_factor;
    SayWhatIsUntold(found, options.natural, &report);
  }
  if (report.calibration.covariance) report.sigma = SigmaOf(rig_spec, report.calibration);
  return report;
}

}  // namespace

void RefineOptions::Check() const {
  if (std::find(kRefineMethodNames.begin(), kRefineMethodNames.end(), method) ==
      kRefineMethodNames.end()) {
    throw InputError("method '" + method +
                     "' is unknown; there are natural, mi, nmi, gom, edge-grid");
  }
  if (most_sweeps == 0) throw InputError("most_sweeps is 0; expected 1 or more");
}

Report Refine(const Rig& rig, const std::vector<View>& views, const Calibration& start,
              const RefineOptions& options) {
  options.Check();
  Report report;
  report.method = options.method;
  report.rig_hash = rig.hash;
  for (const View& view : views) {
    DetectedView& seen = report.detections.emplace_back();
    seen.view = view.name;
    seen.heldout = view.heldout;
    for (const Image& image : view.images) {
      seen.images.push_back({image.camera, "not looked for"});
      report.utime = std::max(report.utime, image.utime);
    }
    seen.cloud_why_not = "not looked for";
  }
  const std::vector<ShotPlace> places = PlacesOf(views);
  for (const CameraSpec& camera : rig.cameras) {
    RefineOptions own = options;
    const CameraCalibration* given = start.Find(camera.name);
    if (own.join_start && given != nullptr) {
      if (!given->converged() || !given->covariance) {
        throw InputError("camera " + camera.name +
                         ": the prior is no calibration with a covariance; start from it without "
                         "joining it (--calibration)");
      }
      own.natural.start_covariance = given->PoseAndLens();
    }
    report.cameras.push_back(RefineCamera(camera, views, places, start, own));
  }
  return report;
}

}  // namespace rgbdt
