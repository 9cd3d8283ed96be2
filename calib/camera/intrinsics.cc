#include "calib/camera/intrinsics.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "calib/camera/camera.h"
#include "calib/camera/internal/intrinsics_bundle.h"
#include "calib/camera/internal/intrinsics_start.h"
#include "calib/model/check.h"
#include "calib/model/errors.h"
#include "calib/model/statistics.h"
#include "calib/model/text.h"

namespace rgbdt {
namespace {

// Corners that fit perfectly have no scatter: nothing is an outlier below this [px].
constexpr double kLeastSigma = 0.02;
constexpr int kRounds = 8;

double Rms(const std::vector<Eigen::Vector2d>& residuals, const std::vector<bool>& used) {
  double sum = 0;
  int count = 0;
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    if (!used[i]) continue;
    sum += residuals[i].squaredNorm();
    ++count;
  }
  return count == 0 ? 0 : std::sqrt(sum / count);
}

void SetPose(const Rigid3& camera_from_target, BundleView* view) {
  const Eigen::AngleAxisd turn(camera_from_target.rotation);
  view->pose << turn.angle() * turn.axis(), camera_from_target.translation;
}

CameraSpec SpecOf(const IntrinsicsInput& input, const Lens& lens) {
  CameraSpec spec;
  spec.width = input.width;
  spec.height = input.height;
  spec.lens = lens;
  return spec;
}

Bundle MakeBundle(const IntrinsicsInput& input, const IntrinsicsStart& start) {
  Bundle bundle;
  bundle.choice = input.choice;
  bundle.lens = ParametersOf(start.lens, input.choice);
  bundle.points = input.target.InnerCorners();
  for (const Eigen::Vector3d& point : bundle.points) {
    bundle.bow_factors.push_back(input.target.BowFactors(point.head<2>()));
  }
  if (input.target.print_sigma > 0) {  // of width and height, each
    bundle.board_sigmas = {std::sqrt(2.0) * input.target.print_sigma, kBowSigmaM, kBowSigmaM,
                           kBowSigmaM};
  }
  const auto [least, greatest] = FocalRange(input.choice, input.width, input.height);
  bundle.least_focal = 0.2 * least;
  bundle.greatest_focal = 5 * greatest;
  for (std::size_t i = 0; i < input.views.size(); ++i) {
    BundleView view;
    view.pixels = input.views[i].corners;
    view.used.assign(view.pixels.size(), true);
    view.pose.setZero();
    view.posed = view.active = start.poses[i].has_value();
    if (view.posed) SetPose(*start.poses[i], &view);
    bundle.views.push_back(std::move(view));
  }
  return bundle;
}

int ActiveViews(const Bundle& bundle) {
  return static_cast<int>(std::count_if(bundle.views.begin(), bundle.views.end(),
                                        [](const BundleView& view) { return view.active; }));
}

// Sigma of a corner along x or y, from the median of the active views' residuals: robust.
double RobustSigma(const Bundle& bundle) {
  std::vector<double> sizes;
  for (const BundleView& view : bundle.views) {
    if (!view.active) continue;
    for (const Eigen::Vector2d& r : Residuals(bundle, view)) {
      sizes.push_back(std::abs(r.x()));
      sizes.push_back(std::abs(r.y()));
    }
  }
  return std::max(kLeastSigma, 1.4826 * Median(std::move(sizes)));
}

// The focal lengths first: from a guess that is a tenth off, a free distortion would take their
// part. The loss narrows as the fit gets better.
void SolveRobustly(const IntrinsicsOptions& options, Bundle* bundle) {
  const int all = static_cast<int>(bundle->lens.size());
  std::string ignored;
  for (const int parameters : {2, 6, all, all, all}) {
    Solve({parameters, 3 * RobustSigma(*bundle), options.max_iterations}, bundle, &ignored);
  }
}

// A view may have been far off because its pose began far off, through a lens then unknown: each
// one that is left out gets another chance through the lens that is known now.
void StartAgain(const IntrinsicsInput& input, Bundle* bundle) {
  const Camera camera(SpecOf(input, LensOf(bundle->lens, bundle->choice)));
  const double loss_scale = 3 * RobustSigma(*bundle);
  for (BundleView& view : bundle->views) {
    if (view.active) continue;
    std::vector<Eigen::Vector3d> points;
    std::vector<Eigen::Vector3d> directions;
    for (std::size_t i = 0; i < view.pixels.size(); ++i) {
      const auto direction = camera.Unproject(view.pixels[i]);
      if (!direction) continue;  // beyond what the other views tell of the lens
      points.push_back(bundle->points[i]);
      directions.push_back(*direction);
    }
    if (2 * points.size() < view.pixels.size()) continue;
    const auto pose = PoseFromDirections(points, directions);
    if (!pose) continue;
    SetPose(*pose, &view);
    view.posed = true;
    SolvePose(loss_scale, *bundle, &view);
  }
}

// What fits how well, and what is left out for it.
class Selection {
 public:
  Selection(const IntrinsicsOptions& options, std::size_t views) : options_(options), why_(views) {}

  // Chooses anew among all corners. True where that changed anything.
  bool Update(Bundle* bundle) {
    const double limit = options_.max_corner_sigmas * RobustSigma(*bundle);
    std::vector<double> rms;
    bool changed = false;
    for (std::size_t v = 0; v < bundle->views.size(); ++v) {
      BundleView& view = bundle->views[v];
      if (!view.posed) continue;
      const auto residuals = Residuals(*bundle, view);
      for (std::size_t i = 0; i < residuals.size(); ++i) {
        const bool use = residuals[i].norm() <= limit;
        changed |= use != view.used[i];
        view.used[i] = use;
      }
      if (view.active) rms.push_back(Rms(residuals, view.used));
    }
    const double median = std::max(kLeastSigma, Median(rms));
    for (std::size_t v = 0; v < bundle->views.size(); ++v) {
      BundleView& view = bundle->views[v];
      why_[v] = WhyNot(view, Residuals(*bundle, view), median);
      changed |= view.active != why_[v].empty();
      view.active = why_[v].empty();
    }
    return changed;
  }

  const std::string& why(std::size_t view) const { return why_[view]; }

 private:
  std::string WhyNot(const BundleView& view, const std::vector<Eigen::Vector2d>& residuals,
                     double median) const {
    if (!view.posed) {
      return "no pose of the board explains its corners: mirrored, or not in the target's order";
    }
    const auto all = static_cast<double>(view.used.size());
    const auto used = static_cast<double>(std::count(view.used.begin(), view.used.end(), true));
    const bool enough = all - used <= options_.max_left_out * all && used >= 6;
    if (enough && Rms(residuals, view.used) <= options_.max_view_ratio * median) return "";
    const double rms = Rms(residuals, std::vector<bool>(view.used.size(), true));
    return "RMS " + Fixed(rms, 1) + " px, " + Fixed(rms / median, 0) +
           " times the median of the views";
  }

  IntrinsicsOptions options_;
  std::vector<std::string> why_;
};

IntrinsicsViewFit FitOf(const Bundle& bundle, const BundleView& view) {
  IntrinsicsViewFit fit;
  fit.used = view.used;
  fit.residuals_px = Residuals(bundle, view);
  fit.rms_px = Rms(fit.residuals_px, view.used);
  for (std::size_t i = 0; i < view.used.size(); ++i) {
    if (!view.used[i]) ++fit.corners_left_out;
    if (fit.residuals_px[i].norm() <= fit.worst_px) continue;
    fit.worst_px = fit.residuals_px[i].norm();
    fit.worst_corner = static_cast<int>(i);
  }
  const Eigen::Vector3d turn = view.pose.head<3>();
  const double angle = turn.norm();
  if (angle > 0) {
    fit.camera_from_target.rotation =
        Eigen::Quaterniond(Eigen::AngleAxisd(angle, turn / angle)).normalized();
  }
  fit.camera_from_target.translation = view.pose.tail<3>();
  return fit;
}

void FillViews(const IntrinsicsInput& input, const Bundle& bundle, const Selection& selection,
               IntrinsicsResult* result) {
  double squares = 0;
  for (std::size_t v = 0; v < bundle.views.size(); ++v) {
    const BundleView& view = bundle.views[v];
    result->views.push_back(FitOf(bundle, view));
    IntrinsicsViewFit& fit = result->views.back();
    fit.name = input.views[v].name;
    fit.rejected = selection.why(v);
    if (!view.active) continue;
    const int used = static_cast<int>(view.used.size()) - fit.corners_left_out;
    squares += used * fit.rms_px * fit.rms_px;
    result->corners_used += used;
  }
  result->rms_px = result->corners_used == 0 ? 0 : std::sqrt(squares / result->corners_used);
}

ImageCoverage CoverageOf(const IntrinsicsInput& input, const IntrinsicsOptions& options,
                         const Bundle& bundle) {
  ImageCoverage coverage;
  coverage.columns = options.grid_columns;
  coverage.rows = options.grid_rows;
  coverage.corners.assign(static_cast<std::size_t>(coverage.columns * coverage.rows), 0);
  for (const BundleView& view : bundle.views) {
    for (std::size_t i = 0; view.active && i < view.pixels.size(); ++i) {
      if (!view.used[i]) continue;
      const auto cell = [](double at, int size, int cells) {
        return std::clamp(static_cast<int>((at + 0.5) / size * cells), 0, cells - 1);
      };
      const int column = cell(view.pixels[i].x(), input.width, coverage.columns);
      const int row = cell(view.pixels[i].y(), input.height, coverage.rows);
      ++coverage.corners[static_cast<std::size_t>(row * coverage.columns + column)];
    }
  }
  coverage.fraction =
      static_cast<double>(std::count_if(coverage.corners.begin(), coverage.corners.end(),
                                        [](int corners) { return corners > 0; })) /
      static_cast<double>(coverage.corners.size());
  return coverage;
}

// Why the numbers are not to be trusted; empty: they are.
std::string WhyNotConverged(const IntrinsicsResult& result, const IntrinsicsOptions& options,
                            const std::string& solver) {
  const int views = result.ViewsUsed();
  if (views < options.min_views) {
    return std::to_string(views) + " usable views; expected at least " +
           std::to_string(options.min_views);
  }
  const auto bad = [](double focal) { return !std::isfinite(focal) || focal <= 0; };
  if (bad(result.lens.fx) || bad(result.lens.fy) || result.covariance.size() == 0) {
    return "the views do not determine the lens: tilt the board more, about both of its axes, and "
           "bring it to every part of the image";
  }
  const double sigma = std::max(result.Sigma(0) / result.lens.fx, result.Sigma(1) / result.lens.fy);
  if (!(sigma <= options.max_focal_sigma)) {
    return "not enough tilt: the focal length is known to " +
           (sigma < 1 ? Fixed(100 * sigma, 1) + "% only" : "nothing better than a factor") +
           "; tilt the board more (30 to 45 degrees), about both of its axes";
  }
  if (!solver.empty()) return solver;
  if (!(result.rms_px <= options.max_rms_px)) {
    return "RMS " + Fixed(result.rms_px, 1) +
           " px: the corners do not fit this lens model; try another one";
  }
  return "";
}

}  // namespace

void IntrinsicsOptions::Check() const {
  const OptionCheck check("intrinsics options");
  check.Require(min_views >= 1, "min_views", min_views, "1 or more");
  check.Require(max_corner_sigmas > 0, "max_corner_sigmas", max_corner_sigmas, "more than 0");
  check.Require(max_left_out >= 0 && max_left_out <= 1, "max_left_out", max_left_out, "0 to 1");
  check.Require(max_view_ratio > 1, "max_view_ratio", max_view_ratio, "more than 1");
  check.Require(max_focal_sigma > 0, "max_focal_sigma", max_focal_sigma, "more than 0");
  check.Require(max_rms_px > 0, "max_rms_px", max_rms_px, "more than 0");
  check.Require(max_iterations >= 1, "max_iterations", max_iterations, "1 or more");
  check.Require(grid_columns >= 1 && grid_columns <= 100, "grid_columns", grid_columns, "1 to 100");
  check.Require(grid_rows >= 1 && grid_rows <= 100, "grid_rows", grid_rows, "1 to 100");
}

IntrinsicsResult CalibrateIntrinsics(const IntrinsicsInput& input,
                                     const IntrinsicsOptions& options) {
  input.Check();
  options.Check();
  Bundle bundle = MakeBundle(input, GuessIntrinsics(input));
  Selection selection(options, bundle.views.size());
  std::string solver;
  if (ActiveViews(bundle) > 0) SolveRobustly(options, &bundle);
  for (int round = 0; round < kRounds; ++round) {
    StartAgain(input, &bundle);
    const bool changed = selection.Update(&bundle);
    if (ActiveViews(bundle) == 0 || (round > 0 && !changed)) break;
    solver.clear();
    Solve({static_cast<int>(bundle.lens.size()), 0, options.max_iterations}, &bundle, &solver);
  }

  IntrinsicsResult result;
  result.choice = input.choice;
  result.lens = LensOf(bundle.lens, input.choice);
  result.names = ParameterNames(input.choice);
  result.values = bundle.lens;
  FillViews(input, bundle, selection, &result);
  const auto count = static_cast<Eigen::Index>(bundle.lens.size());
  const Eigen::MatrixXd covariance =
      ActiveViews(bundle) > 0 ? CovarianceOfLensAndBoard(bundle) : Eigen::MatrixXd();
  if (covariance.size() > 0) result.covariance = covariance.topLeftCorner(count, count);
  if (covariance.rows() > count) {
    const auto board = [&](int i) {
      return Estimate{bundle.board[static_cast<std::size_t>(i)],
                      std::sqrt(covariance(count + i, count + i))};
    };
    result.board = {board(kAspect), board(kBow), board(kBow + 1), board(kBow + 2)};
  }
  result.coverage = CoverageOf(input, options, bundle);
  const std::string why = WhyNotConverged(result, options, solver);
  result.converged = why.empty();
  result.detail = why;
  return result;
}

}  // namespace rgbdt
