#include "calib/solve/internal/view_equations.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "calib/camera/lens.h"
#include "calib/camera/pixel_by_point.h"
#include "calib/model/linear_algebra.h"

namespace rgbdt {
namespace {

constexpr double kLeastCornerPx = 0.01;

// At the board, as it was detected: weights that moved with the board would be an objective of
// their own.
double PixelsPerMetre(const BoardProblem& problem, const BoardImage& image) {
  const Lens& lens = problem.cameras[static_cast<std::size_t>(image.camera)].lens();
  return lens.fx / image.edges->pose->sensor_from_target.translation.norm();
}

}  // namespace

ViewEquations::ViewEquations(const BoardProblem& problem, const BoardState& state, std::size_t view)
    : ViewEquations(problem, state, problem.views[view], state.lidar_from_target[view],
                    state.side_shift[view]) {
  for (std::size_t l = 0; l < problem.lidars.size(); ++l) {
    further_.emplace_back(problem, state, places_, l, view);
    further_.back().AddTo(&h_, &g_);
    cost_ += further_.back().cost();
  }
}

ViewEquations::ViewEquations(const BoardProblem& problem, const BoardState& state,
                             const BoardView& view, const Rigid3& lidar_from_target,
                             const std::array<double, 4>& side_shift)
    : problem_(problem),
      view_(view),
      state_(state),
      lidar_from_target_(lidar_from_target),
      side_shift_(side_shift),
      places_(problem),
      h_(Eigen::MatrixXd::Zero(Size(), Size())),
      g_(Eigen::VectorXd::Zero(Size())) {
  for (const BoardImage& image : view_.images) {
    AddCorners(image);
    AddImageSides(image);
  }
  AddCrossings();
  of_points_ = -h_.topLeftCorner<kOwnUnknowns, kOwnUnknowns>();
  AddPlane();
  of_points_ += h_.topLeftCorner<kOwnUnknowns, kOwnUnknowns>();
  AddSidePriors();
}

std::optional<Eigen::Vector2d> ViewEquations::Project(int camera,
                                                      const Eigen::Vector3d& point) const {
  auto pixel = problem_.cameras[static_cast<std::size_t>(camera)].Project(point);
  if (!pixel) return pixel;
  ProjectUnchecked(LensOf(camera), point.x(), point.y(), point.z(), &pixel->x(), &pixel->y());
  return pixel;
}

// Corners: 2 rows each over the board's pose, the camera's, the lens and the print.
void ViewEquations::AddCorners(const BoardImage& image) {
  const Rigid3 camera_from_target =
      state_.camera_from_lidar[static_cast<std::size_t>(image.camera)] * lidar_from_target_;
  const Eigen::Matrix3d rotation = camera_from_target.rotation.toRotationMatrix();
  const Target printed = PrintedAs(problem_.target, state_.shared);
  const auto model = printed.InnerCorners();
  const auto& seen = image.edges->corners;
  if (seen.size() != model.size()) return;
  const double sigma =
      kCornerSigmaInflation * std::max(kLeastCornerPx, image.edges->corner_sigma_px);
  const auto by_print = [&](const Eigen::Vector3d& corner) -> Eigen::Vector2d {
    return (corner.head<2>() - printed.pattern_offset_m).cwiseQuotient(printed.print_scale);
  };
  ImageMatrix h = ImageMatrix::Zero();
  ImageVector g = ImageVector::Zero();
  for (std::size_t i = 0; i < model.size(); ++i) {
    if (!IsSeen(seen[i])) continue;
    Eigen::Vector3d corner = model[image.turned ? model.size() - 1 - i : i];
    const Eigen::Vector3d bow = problem_.target.BowFactors(corner.head<2>());
    corner.z() = BowAt(problem_.target, state_.shared, corner.head<2>());
    Eigen::Matrix<double, 3, 2> on_board;  // by the pattern's plane
    on_board << Eigen::Matrix2d::Identity(),
        BowSlope(problem_.target, state_.shared, corner.head<2>());
    const Eigen::Vector3d p = camera_from_target * corner;
    const auto pixel = Project(image.camera, p);
    if (!pixel) {
      cost_ += RobustCost(1e6);
      continue;
    }
    const PixelDerivatives by = PixelByPointAndLens(LensOf(image.camera), p) / sigma;
    const Eigen::Matrix<double, 2, 3> by_point = by.leftCols<3>();
    Eigen::Matrix<double, 2, kImageUnknowns> j;
    j << -by_point * rotation * CrossMatrix(corner), by_point * rotation,
        -by_point * CrossMatrix(p), by_point, by.rightCols<kLensNumbers>(),
        by_point * rotation * on_board * by_print(corner).asDiagonal(),
        by_point * rotation.col(2) * bow.transpose();
    const Eigen::Vector2d residual = (*pixel - seen[i]) / sigma;
    // Both coordinates together: two degrees of freedom.
    const double squared = residual.squaredNorm() / 2;
    const double weight = RobustWeight(squared);
    cost_ += 2 * RobustCost(squared);
    h.noalias() += weight * j.transpose() * j;
    g.noalias() -= weight * j.transpose() * residual;
  }
  Spread(image.camera, h, g);
}

// From (board, camera, lens, print, shape) to their places among the unknowns.
void ViewEquations::Spread(int camera, const ImageMatrix& h, const ImageVector& g) {
  std::array<Eigen::Index, kImageUnknowns> place{};
  std::iota(place.begin(), place.begin() + 6, 0);
  const auto shared = places_.PoseAndLens(static_cast<std::size_t>(camera));
  std::transform(shared.begin(), shared.end(), place.begin() + 6,
                 [](Eigen::Index at) { return kOwnUnknowns + at; });
  place[6 + kPoseAndLens] = Shared(kPrintWidth);
  place[7 + kPoseAndLens] = Shared(kPrintHeight);
  for (int k = 0; k < 3; ++k) {
    place[static_cast<std::size_t>(8 + kPoseAndLens + k)] = Shared(kBowX + k);
  }
  h_(place, place) += h;
  g_(place) += g;
}

void ViewEquations::AddImageSides(const BoardImage& image) {
  for (int i = 0; i < 4; ++i) {
    const ImageSide& side = image.edges->sides[static_cast<std::size_t>(i)];
    if (side.seen && side.curve.size() >= 2) {
      AddImageSide(image, side, image.turned ? (i + 2) % 4 : i);
    }
  }
}

// The projected side's distance from the curve at the curve's two ends.
void ViewEquations::AddImageSide(const BoardImage& image, const ImageSide& side, int on_board) {
  const auto camera = static_cast<std::size_t>(image.camera);
  Eigen::Matrix<double, 2, Eigen::Dynamic> j =
      Eigen::Matrix<double, 2, Eigen::Dynamic>::Zero(2, Size());
  Eigen::Vector2d residual;
  const std::size_t last = side.curve.size() - 1;
  for (int end = 0; end < 2; ++end) {
    const Eigen::Vector2d& at = side.curve[end == 0 ? 0 : last];
    const Eigen::Vector2d& next = side.curve[end == 0 ? 1 : last - 1];
    const auto there = AtCurveEnd(image, on_board, at, end == 0 ? next - at : at - next);
    if (!there) return;
    residual[end] = there->beside;
    j.row(end).head<6>() = there->by_target;
    j.row(end).segment<6>(kOwnUnknowns + SharedPlaces::Pose(camera)) = there->by_camera;
    j.row(end).segment<kLensNumbers>(kOwnUnknowns + places_.Lens(camera)) = there->by_lens;
    j(end, Shared(kOutlineTop + on_board)) = there->by_outline;
    j.row(end).segment<3>(Shared(kBowX)) = there->by_bow;
  }
  const double px_per_m = PixelsPerMetre(problem_, image);
  for (int end = 0; end < 2; ++end) {
    image_side_ends_.push_back(
        {residual[end] / px_per_m, std::sqrt(side.covariance(end, end)) / px_per_m});
  }
  Eigen::Matrix2d covariance = side.covariance;
  covariance.diagonal().array() += std::pow(px_per_m * problem_.priors.image_side_sigma_m, 2);
  const auto inverse = InverseOfPositive(covariance);
  if (!inverse) return;
  const Eigen::Matrix2d information = *inverse;
  const double squared = residual.dot(information * residual) / 2;
  const double weight = RobustWeight(squared);
  cost_ += 2 * RobustCost(squared);
  h_ += weight * j.transpose() * information * j;
  g_ -= weight * j.transpose() * information * residual;
}

// One end: where on the side the curve ends, and how far the projected side lies from there.
std::optional<ViewEquations::CurveEnd> ViewEquations::AtCurveEnd(
    const BoardImage& image, int side, const Eigen::Vector2d& at,
    const Eigen::Vector2d& along) const {
  const Lens& lens = LensOf(image.camera);
  const Rigid3 camera_from_target =
      state_.camera_from_lidar[static_cast<std::size_t>(image.camera)] * lidar_from_target_;
  const Eigen::Matrix3d rotation = camera_from_target.rotation.toRotationMatrix();
  const auto corners = problem_.target.OutlineCorners();
  const auto s = static_cast<std::size_t>(side);
  const Eigen::Vector2d out = OutwardOf(side);
  const Eigen::Vector3d outward(out.x(), out.y(), 0);
  const Eigen::Vector3d shift =
      state_.shared[static_cast<std::size_t>(kOutlineTop + side)] * outward;
  const Eigen::Vector3d from = corners[s] + shift;
  const Eigen::Vector3d to = corners[(s + 1) % 4] + shift;
  const Eigen::Vector2d tangent = along.normalized();
  const auto at_t = [&](double t) -> Eigen::Vector3d {
    Eigen::Vector3d point = from + t * (to - from);
    point.z() = BowAt(problem_.target, state_.shared, point.head<2>());
    return point;
  };
  double t = 0.5;  // along the side; Newton's steps put it beside the curve's end
  for (int i = 0; i < 4; ++i) {
    const Eigen::Vector3d p = camera_from_target * at_t(t);
    const auto pixel = Project(image.camera, p);
    if (!pixel) return std::nullopt;
    const Eigen::Vector2d by_t = PixelByPoint(lens, p) * rotation * (to - from);
    const double speed = tangent.dot(by_t);
    if (std::abs(speed) < 1e-6) return std::nullopt;
    t += std::clamp(tangent.dot(at - *pixel) / speed, -1.0, 1.0);
  }
  const Eigen::Vector3d on_target = at_t(t);
  const Eigen::Vector3d p = camera_from_target * on_target;
  const auto pixel = Project(image.camera, p);
  if (!pixel) return std::nullopt;
  const Eigen::RowVector2d normal(-tangent.y(), tangent.x());
  const PixelDerivatives by = PixelByPointAndLens(lens, p);
  // Where the pixel moves along the curve, t takes that back: along the projected side, which is
  // not quite parallel to the curve.
  const Eigen::Vector2d by_t = by.leftCols<3>() * rotation * (at_t(t + 0.5) - at_t(t - 0.5));
  const Eigen::RowVector2d across =
      normal - normal.dot(by_t) / tangent.dot(by_t) * tangent.transpose();
  const Eigen::Matrix<double, 1, 3> by_point = across * by.leftCols<3>();
  CurveEnd end;
  end.beside = normal * (*pixel - at);
  end.by_camera << -by_point * CrossMatrix(p), by_point;
  end.by_target << -by_point * rotation * CrossMatrix(on_target), by_point * rotation;
  end.by_lens = across * by.rightCols<kLensNumbers>();
  const Eigen::Vector3d outwards(
      out.x(), out.y(), BowSlope(problem_.target, state_.shared, on_target.head<2>()).dot(out));
  end.by_outline = by_point * rotation * outwards;
  end.by_bow =
      by_point * rotation.col(2) * problem_.target.BowFactors(on_target.head<2>()).transpose();
  return end;
}

// From how far off on a crossing counts less; matters for outliers only.
double ViewEquations::OwnSigma(const Crossing& crossing, const CrossingResidual& here) const {
  if (std::abs(here.beyond_m) < 2 * here.sigma_m) return here.sigma_m;
  return SigmaByCloud(problem_.target, problem_.priors, crossing, view_.cloud, state_.shared)
      .value_or(here.sigma_m);
}

void ViewEquations::AddCrossings() {
  // The outline's and the class's derivatives are the side's and the kind's: added up apart.
  std::array<std::array<CrossingMatrix, 3>, 4> h;
  std::array<std::array<CrossingVector, 3>, 4> g;
  for (int side = 0; side < 4; ++side) {
    for (int kind = 0; kind < 3; ++kind) {
      h[side][kind].setZero();
      g[side][kind].setZero();
    }
  }
  for (const Crossing& crossing : view_.cloud.crossings) {
    const auto side = static_cast<std::size_t>(crossing.side);
    if (!view_.sides[side] || !(crossing.sigma_m > 0)) continue;
    const CrossingResidual r = ResidualOf(problem_.target, problem_.priors, crossing,
                                          lidar_from_target_, state_.shared, side_shift_[side]);
    if (!(r.per_rad > 0)) continue;
    CrossingVector j;
    j << r.by_target.transpose(), -r.per_rad, -r.per_thickness, -r.per_outline, r.by_beams_meet,
        -r.per_fringe, r.per_bow.transpose();
    const double sigma = OwnSigma(crossing, r);
    const double squared = r.beyond_m * r.beyond_m / (sigma * sigma);
    // Noise that it shares with its neighbours counts once: in weight, not in what is far off.
    const double share = sigma * sigma / (crossing.sigma_m * crossing.sigma_m);
    const double weight = RobustWeight(squared) / (crossing.sigma_m * crossing.sigma_m);
    cost_ += share * RobustCost(squared);
    const auto kind = static_cast<std::size_t>(crossing.kind) - 1;
    h[side][kind].noalias() += weight * j * j.transpose();
    g[side][kind].noalias() -= weight * r.beyond_m * j;
  }
  for (int side = 0; side < 4; ++side) {
    for (int kind = 0; kind < 3; ++kind) {
      const auto s = static_cast<std::size_t>(side);
      SpreadCrossings(side, kind, h[s][static_cast<std::size_t>(kind)],
                      g[s][static_cast<std::size_t>(kind)]);
    }
  }
}

void ViewEquations::SpreadCrossings(int side, int kind, const CrossingMatrix& h,
                                    const CrossingVector& g) {
  if (h(8, 8) == 0) return;
  // Places of the derivatives: the class's shift stands for the side's, too.
  constexpr std::size_t kPlaces = kCrossingUnknowns + 1;
  const std::array<Eigen::Index, kPlaces> place{0,
                                                1,
                                                2,
                                                3,
                                                4,
                                                5,
                                                Shared(kNoReturnShift + kind),
                                                Shared(kThickness),
                                                Shared(kOutlineTop + side),
                                                Shared(kBeamsMeet),
                                                Shared(kFringe),
                                                Shared(kBowX),
                                                Shared(kTwist),
                                                Shared(kBowY),
                                                6 + side};
  const std::array<int, kPlaces> sum{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 6};
  for (std::size_t a = 0; a < kPlaces; ++a) {
    for (std::size_t b = 0; b < kPlaces; ++b) h_(place[a], place[b]) += h(sum[a], sum[b]);
    g_[place[a]] += g[sum[a]];
  }
}

void ViewEquations::AddPlane() {
  const double sigma = view_.cloud.scatter_sigma_m;
  if (!(sigma > 0) || !(view_.cloud.scatter(3, 3) > 0) || !(view_.cloud.raw_scatter(3, 3) > 0)) {
    return;
  }
  const bool told_apart = !view_.cloud.groups.empty() && view_.cloud.group_sigma_m > 0;
  if (told_apart && !problem_.ranges_exact) return AddGroups();
  const PlaneResidual r = ResidualOf(view_.cloud, lidar_from_target_, state_.shared[kRangeOffset],
                                     state_.shared[kBeamsMeet]);
  const Eigen::Matrix4d information = view_.cloud.scatter / (sigma * sigma);
  cost_ += r.x.dot(information * r.x);
  const std::array<Eigen::Index, 5> place = PlanePlaces();
  h_(place, place) += r.by.transpose() * information * r.by;
  g_(place) -= r.by.transpose() * information * r.x;
}

// Groups of one ring stand together. Their residuals are linear in the range offset.
void ViewEquations::AddGroups() {
  const double beams_meet = state_.shared[kBeamsMeet];
  const PlaneResidual unmoved = ResidualOf(view_.cloud, lidar_from_target_, 0, beams_meet);
  PlaneResidual by_offset = ResidualOf(view_.cloud, lidar_from_target_, 1, beams_meet);
  by_offset.x -= unmoved.x;
  by_offset.by -= unmoved.by;
  const std::vector<PointGroup>& groups = view_.cloud.groups;
  const PointGroup* const end = groups.data() + groups.size();
  for (const PointGroup* first = groups.data(); first != end;) {
    const PointGroup* const last = std::find_if(
        first, end, [&](const PointGroup& group) { return group.ring != first->ring; });
    AddRing(first, last, unmoved, by_offset);
    first = last;
  }
}

// The groups of one ring. What the ring is off by in this view is noise that they share; with its
// variance s^2 and w the groups' information of it, what they say together is less by
// 1 / (1 / s^2 + w) of what they say of it, squared.
void ViewEquations::AddRing(const PointGroup* first, const PointGroup* last,
                            const PlaneResidual& unmoved, const PlaneResidual& by_offset) {
  constexpr int kMost = 5 + RangeTerms::kMostParts;
  const std::array<Eigen::Index, 5> plane = PlanePlaces();
  const Eigen::Vector4d& along = by_offset.x;  // a point's distance by its offset
  const double weight = 1 / (view_.cloud.group_sigma_m * view_.cloud.group_sigma_m);
  std::array<Eigen::Index, kMost> own{};
  std::copy(plane.begin(), plane.end(), own.begin());
  // What the groups say of the offset that they share, with each unknown; `place` of each.
  std::vector<Eigen::Index> place(plane.begin(), plane.end());
  std::vector<double> shared(plane.size(), 0);
  double of_offset = 0;  // w
  double residual = 0;
  for (const PointGroup* group = first; group != last; ++group) {
    const RangeTerms::Parts parts = problem_.ranges.PartsOf(*group);
    double offset = state_.shared[kRangeOffset];
    for (const auto& [term, part] : parts) offset += part * state_.range_terms[term];
    Eigen::Matrix<double, 4, kMost> by = Eigen::Matrix<double, 4, kMost>::Zero();
    by.leftCols<5>() = unmoved.by + offset * by_offset.by;
    std::size_t count = plane.size();
    for (const auto& [term, part] : parts) {
      by.col(static_cast<Eigen::Index>(count)) = part * along;
      own[count++] = kOwnUnknowns + places_.RangeTerm(term);
    }
    const Eigen::Vector4d x = unmoved.x + offset * along;
    const Eigen::Vector4d weighted = weight * group->scatter * x;
    const Eigen::Matrix<double, kMost, 4> by_weighted = weight * by.transpose() * group->scatter;
    const Eigen::Matrix<double, kMost, kMost> h = by_weighted * by;
    const Eigen::Matrix<double, kMost, 1> g = by.transpose() * weighted;
    const Eigen::Matrix<double, kMost, 1> of_own = by_weighted * along;
    for (std::size_t a = 0; a < count; ++a) {
      const auto at = static_cast<Eigen::Index>(a);
      for (std::size_t b = 0; b < count; ++b) {
        h_(own[a], own[b]) += h(at, static_cast<Eigen::Index>(b));
      }
      g_[own[a]] -= g[at];
      if (a < plane.size()) {
        shared[a] += of_own[at];
      } else {
        place.push_back(own[a]);
        shared.push_back(of_own[at]);
      }
    }
    cost_ += x.dot(weighted);
    of_offset += weight * along.dot(group->scatter * along);
    residual += along.dot(weighted);
  }
  if (first->ring < 0 || !(of_offset > 0)) return;
  rings_off_.push_back({first->ring, -residual / of_offset, 1 / of_offset});
  const double sigma = problem_.priors.ring_view_sigma_m;
  if (!(sigma > 0)) return;
  const double share = 1 / (1 / (sigma * sigma) + of_offset);
  for (std::size_t a = 0; a < place.size(); ++a) {
    for (std::size_t b = 0; b < place.size(); ++b) {
      h_(place[a], place[b]) -= share * shared[a] * shared[b];
    }
    g_[place[a]] += share * shared[a] * residual;
  }
  cost_ -= share * residual * residual;
}

std::array<Eigen::Index, 5> ViewEquations::PlanePlaces() const {
  return {0, 1, 5, Shared(kRangeOffset), Shared(kBeamsMeet)};
}

void ViewEquations::AddSidePriors() {
  const double weight = 1 / (problem_.priors.side_sigma_rad * problem_.priors.side_sigma_rad);
  for (int side = 0; side < 4; ++side) {
    const double shift = side_shift_[static_cast<std::size_t>(side)];
    h_(6 + side, 6 + side) += weight;
    g_[6 + side] -= weight * shift;
    cost_ += weight * shift * shift;
  }
}

}  // namespace rgbdt
