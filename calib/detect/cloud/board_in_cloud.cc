#include "calib/detect/cloud/board_in_cloud.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <sstream>

#include "calib/detect/cloud/board_crossings.h"
#include "calib/detect/cloud/cloud_sanity.h"
#include "calib/detect/cloud/internal/board_plane.h"
#include "calib/detect/cloud/plane_regions.h"
#include "calib/detect/cloud/range_grid.h"
#include "calib/detect/cloud/scattered_crossings.h"
#include "calib/model/beam_priors.h"
#include "calib/model/check.h"
#include "calib/model/errors.h"
#include "calib/model/range_errors.h"
#include "calib/model/statistics.h"
#include "calib/model/text.h"

namespace rgbdt {
namespace {

struct Size {
  double longer = 0, shorter = 0;
};

// Extent of flat points, and of half a spacing beyond the outermost on each side.
Size Measure(const std::vector<Eigen::Vector2d>& flat, double spacing) {
  std::vector<cv::Point2f> points;
  points.reserve(flat.size());
  for (const Eigen::Vector2d& p : flat) {
    points.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()));
  }
  const cv::RotatedRect box = cv::minAreaRect(points);
  return {std::max(box.size.width, box.size.height) + spacing,
          std::min(box.size.width, box.size.height) + spacing};
}

// A look at a region's own few points: is it worth the look at all the beams?
bool MayBe(const PlaneRegion& region, const Target& target) {
  const PlaneFrame frame(region.plane, region.points[0].cast<double>());
  std::vector<Eigen::Vector2d> flat;
  for (const Eigen::Vector3f& p : region.points) flat.push_back(frame.Flat(p.cast<double>()));
  const Size size = Measure(flat, 0);
  const double diagonal = std::hypot(target.width_m, target.height_m);
  return size.longer > 0.4 * diagonal && size.shorter > 0.25 * diagonal;
}

double Spacing(const PlaneMembers& members) {
  return std::max(members.row_spacing_m, members.column_spacing_m);
}

// The rectangle where its beams meet `plane`, which may differ a little from the frame's.
Rigid3 PoseOf(const PlaneFrame& frame, const FlatRectangle& rectangle, const Plane& plane) {
  const Eigen::Vector3d x =
      std::cos(rectangle.angle_rad) * frame.u + std::sin(rectangle.angle_rad) * frame.v;
  Eigen::Matrix3d axes;
  axes.col(2) = -plane.normal;
  axes.col(0) = (x - plane.normal.dot(x) * plane.normal).normalized();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  const Eigen::Vector3d centre = frame.Solid(rectangle.centre);
  return {Eigen::Quaterniond(axes).normalized(),
          centre * (plane.offset / plane.normal.dot(centre))};
}

// What holds within the rectangle and just beyond it.
struct Filling {
  double inside = 0;  // of the beams well inside that were not stopped before: those on the plane
  double seen = 0;    // how densely its inside is on the plane, against the beams' spacing
  double beyond = 0;  // how densely a band round the rectangle is on the plane, against its inside
  double closed = 0;  // how densely its holes are on the plane, against the beams' spacing
  BoardPoints on;     // its rim left out
};

Filling Fill(const Cloud& cloud, const PlaneMembers& members, const FlatRectangle& rectangle,
             const Target& target) {
  const bool bright = cloud.intensity.size() == cloud.size();
  constexpr double kMargin = 0.04;
  constexpr double kBand = 0.15;
  const double c = std::cos(rectangle.angle_rad);
  const double s = std::sin(rectangle.angle_rad);
  const double radius = target.holes ? target.holes->radius_m : 0;
  const std::vector<Eigen::Vector2d> holes = target.HoleCentres();
  // A place on the board, which may be turned by half a turn: its holes lie alike then.
  const auto on_board = [&](const Eigen::Vector2d& p) -> Eigen::Vector2d {
    const Eigen::Vector2d d = p - rectangle.centre;
    return {c * d.x() + s * d.y(), -s * d.x() + c * d.y()};
  };
  // How far beyond its sides a place lies, and how far outside of the board, its holes being
  // outside, too; negative inside.
  const auto beyond_sides = [&](const Eigen::Vector2d& p) {
    return std::max(std::abs(p.x()) - target.width_m / 2, std::abs(p.y()) - target.height_m / 2);
  };
  const auto outside = [&](const Eigen::Vector2d& p) {
    double off = beyond_sides(p);
    for (const Eigen::Vector2d& hole : holes) off = std::max(off, radius - (p - hole).norm());
    return off;
  };
  Filling filling;
  int band = 0;
  int in_holes = 0;
  int through = 0;
  for (std::size_t i = 0; i < members.flat.size(); ++i) {
    const Eigen::Vector2d place = on_board(members.flat[i]);
    const double off = outside(place);
    if (off < -kMargin) {
      filling.on.points.push_back(members.points[i]);
      filling.on.flat.push_back(members.flat[i]);
      filling.on.row.push_back(members.row[i]);
      filling.on.index.push_back(members.index[i]);
      filling.on.log2_intensity.push_back(bright ? Log2Intensity(cloud.intensity[members.index[i]])
                                                 : 0);
    }
    if (off > kMargin && beyond_sides(place) <= 0) ++in_holes;
    if (off > kMargin && off < kMargin + kBand && beyond_sides(place) > 0) ++band;
  }
  for (const Eigen::Vector2d& p : members.through) {
    if (outside(on_board(p)) < -kMargin) ++through;
  }
  const auto on = static_cast<double>(filling.on.points.size());
  filling.inside = on / std::max(1.0, on + through);
  const double band_area =
      (target.width_m + 2 * (kMargin + kBand)) * (target.height_m + 2 * (kMargin + kBand)) -
      (target.width_m + 2 * kMargin) * (target.height_m + 2 * kMargin);
  const auto circles = [&](double r) { return static_cast<double>(holes.size()) * M_PI * r * r; };
  const double inner_area =
      (target.width_m - 2 * kMargin) * (target.height_m - 2 * kMargin) - circles(radius + kMargin);
  filling.seen = on * members.beam_m2 / inner_area;
  if (radius > kMargin) filling.closed = in_holes * members.beam_m2 / circles(radius - kMargin);
  filling.beyond = on == 0 ? 1 : std::min(1.0, band / band_area / (on / inner_area));
  return filling;
}

// Of delta in the target's own axes about its centre: tilt and distance from the points' scatter
// about the plane, place and turn in the plane from the crossings.
Matrix6d CovarianceInTarget(const Eigen::Matrix4d& by_points, const Rigid3& pose,
                            const FlatRectangle& rectangle) {
  // A point at (x, y) on the board is moved off the plane by rx y - ry x + tz.
  const Eigen::Matrix3d axes = pose.rotation.toRotationMatrix();
  Eigen::Matrix<double, 3, 4> by_point = Eigen::Matrix<double, 3, 4>::Zero();
  by_point.block<1, 3>(0, 0) = axes.col(1).transpose();
  by_point.block<1, 3>(1, 0) = -axes.col(0).transpose();
  by_point(2, 3) = 1;
  const Eigen::Matrix3d plane = (by_point * by_points * by_point.transpose()).inverse();
  // The rectangle's covariance is of (u, v, angle); turned into the target's axes.
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  turn.topLeftCorner<2, 2>() = Eigen::Rotation2Dd(-rectangle.angle_rad).toRotationMatrix();
  const Eigen::Matrix3d flat = turn * rectangle.covariance * turn.transpose();
  const int from_plane[] = {0, 1, 5};
  const int from_flat[] = {3, 4, 2};
  Matrix6d out = Matrix6d::Zero();
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) {
      out(from_plane[i], from_plane[k]) = plane(i, k);
      out(from_flat[i], from_flat[k]) = flat(i, k);
    }
  }
  return out;
}

// Points along the sides that the cloud shows, for who compares outlines.
std::vector<Eigen::Vector3d> Outline(const Target& target, const FlatRectangle& rectangle,
                                     const Rigid3& pose) {
  constexpr double kSpacing = 0.02;
  const auto corners = target.OutlineCorners();
  std::vector<Eigen::Vector3d> out;
  for (std::size_t side = 0; side < 4; ++side) {
    if (rectangle.side_coverage[side] < 0.3) continue;
    const Eigen::Vector3d& a = corners[side];
    const Eigen::Vector3d& b = corners[(side + 1) % 4];
    const int pieces = std::max(1, static_cast<int>((b - a).norm() / kSpacing));
    for (int i = 0; i < pieces; ++i) {
      out.push_back(pose * (a + (b - a) * (i + 0.5) / pieces));
    }
  }
  return out;
}

struct Candidate {
  CloudEdges edges;
  double score = 0;
  double but_one = 0;    // the score of the three sides that show most
  double misfit = 0;     // of its outline
  double deviation = 0;  // of its outline's priors
};

// Two pieces of one board lead to the same place.
bool IsSame(const CloudEdges& a, const CloudEdges& b) {
  return (a.centre - b.centre).norm() < 0.04 && a.normal.dot(b.normal) > 0.97;
}

// Those that lie on a side.
std::vector<Crossing> CrossingsOf(const PlaneMembers& members, const FlatRectangle& rectangle) {
  std::vector<Crossing> out;
  for (std::size_t i = 0; i < members.crossings.size(); ++i) {
    if (rectangle.side[i] < 0) continue;
    const FlatCrossing& c = members.crossings[i];
    out.push_back({members.frame.Solid(c.middle), rectangle.half_width_m[i], rectangle.side[i],
                   c.kind, rectangle.sigma_m[i]});
  }
  return out;
}

std::optional<Candidate> FitBoard(const Cloud& cloud, const PlaneMembers& members,
                                  const FlatRectangle& voted, const Target& target,
                                  const BoardInCloudOptions& options) {
  const FlatRectangle rectangle =
      RefineRectangle(members.crossings, target.width_m, target.height_m, voted, options.edge);
  const auto seen_sides =
      std::count_if(rectangle.side_coverage.begin(), rectangle.side_coverage.end(),
                    [](double coverage) { return coverage >= 0.4; });
  constexpr double kMostPriorDeviation = 6;
  if (seen_sides < 3 || rectangle.coverage < 0.55 ||
      rectangle.prior_deviation > kMostPriorDeviation) {
    return std::nullopt;
  }
  Filling filling = Fill(cloud, members, rectangle, target);
  if (filling.inside < 0.85 || filling.seen < 0.7 || filling.beyond > 0.5 || filling.closed > 0.4 ||
      filling.on.points.size() < 12) {
    return std::nullopt;
  }
  // What sticks out of the rectangle has no say in where its plane lies.
  const BoardPlane points(members.plane, members.frame, filling.on, 0.3 * options.range_sigma_m);
  const Rigid3 pose = PoseOf(members.frame, rectangle, points.plane());
  const Eigen::Matrix4d scatter = points.Scatter(pose.translation);
  Candidate out;
  out.misfit = rectangle.misfit;
  out.deviation = rectangle.prior_deviation;
  const double filled = filling.inside * (1 - filling.beyond);
  out.score = rectangle.coverage * filled;
  auto sides = rectangle.side_coverage;
  std::sort(sides.begin(), sides.end());
  out.but_one = sides[1] * filled;
  out.edges.boundary = Outline(target, rectangle, pose);
  out.edges.centre = pose.translation;
  out.edges.normal = points.plane().normal;
  out.edges.spacing_m = Spacing(members);
  out.edges.points = static_cast<int>(filling.on.points.size());
  const Size size = Measure(members.flat, 0);
  out.edges.width_m = size.longer;
  out.edges.height_m = size.shorter;
  out.edges.scatter = scatter;
  out.edges.raw_scatter = points.RawScatter(pose.translation);
  out.edges.scatter_sigma_m = points.sigma_m();
  auto groups = points.GroupsAbout(pose.translation, cloud, options.one_laser);
  out.edges.groups = std::move(groups.groups);
  out.edges.group_sigma_m = groups.sigma_m;
  const Matrix6d to_lidar = Adjoint(pose);
  out.edges.pose = TargetPose{
      pose,
      to_lidar *
          CovarianceInTarget(scatter / (points.sigma_m() * points.sigma_m()), pose, rectangle) *
          to_lidar.transpose(),
      false};
  out.edges.crossings = CrossingsOf(members, rectangle);
  return out;
}

// Where a board lies in another frame of nearly the same plane.
FlatRectangle InFrame(const PlaneFrame& frame, const Candidate& board) {
  const Rigid3& pose = board.edges.pose->sensor_from_target;
  const Eigen::Vector3d x = pose.rotation * Eigen::Vector3d::UnitX();
  FlatRectangle rectangle;
  rectangle.centre = frame.Flat(pose.translation);
  rectangle.angle_rad = std::atan2(x.dot(frame.v), x.dot(frame.u));
  return rectangle;
}

// A cloud of a LIDAR whose pattern does not repeat: of a few seconds, in the order in which it was
// measured, without rows. A turned scanner's takes longer, and keeps to rows that were lost.
bool DoesNotRepeat(const RangeGrid& grid) {
  constexpr Utime kLongest = 5 * kMicrosecondsPerSecond;
  const std::vector<Utime>& utime = grid.cloud().utime;
  return grid.scattered() && !utime.empty() && utime.size() == grid.cloud().size() &&
         std::is_sorted(utime.begin(), utime.end()) && utime.back() - utime.front() <= kLongest;
}

// Many write such a cloud without times. Where it is none after all, a turned scanner's whose rig
// file does not say so, its crossings by the points alone are blunter.
bool MayNotRepeat(const RangeGrid& grid, const BoardInCloudOptions& options) {
  return grid.scattered() && grid.cloud().utime.empty() && !options.one_laser;
}

// Of points that keep to no grid: crossings by the points themselves, and as sharp as they turn out
// to be. Such LIDARs' beams and angles differ more than those of rings: a Livox's beam is 4.9 mrad
// high, its angles have a noise of up to 2.6 mrad.
std::optional<Candidate> FitScattered(const Cloud& cloud, PlaneMembers members, FlatRectangle near,
                                      const Target& target, BoardInCloudOptions options) {
  constexpr double kClassSigmaRad = 1.1e-3;  // kViewClassShiftSigmaRad, of so high a beam
  constexpr double kBluntestRad = 4e-3, kMisfit = 1.2;
  options.edge.class_sigma_rad = std::max(options.edge.class_sigma_rad, kClassSigmaRad);
  constexpr int kRounds = 4;
  constexpr double kStillM = 0.002, kLeastOnSides = 0.7, kLeastOnThree = 0.9;
  constexpr double kMostDeviation = 4, kLeastScore = 0.87;
  const auto cut = [&] {
    return ScatteredCrossings(cloud, members.plane, members.frame, near, target,
                              options.range_sigma_m);
  };
  for (int round = 0; round < 3; ++round) near = Centred(near, cut(), target);
  const double sharpest_rad = options.edge.blur_rad;
  std::optional<Candidate> board;
  for (int round = 0; round < kRounds; ++round) {
    members.crossings = cut();
    options.edge.blur_rad = sharpest_rad;
    board = FitBoard(cloud, members, near, target, options);
    while (board && board->misfit > kMisfit && options.edge.blur_rad < kBluntestRad) {
      options.edge.blur_rad *= 1.4;
      board = FitBoard(cloud, members, near, target, options);
    }
    if (!board) return std::nullopt;
    const Eigen::Vector2d before = near.centre;
    near = InFrame(members.frame, *board);
    if ((near.centre - before).norm() < kStillM) break;
  }
  // What holds the board, or stands beside it in its plane, leaves more than one place for it: then
  // none is better than a wrong one. One side may be hidden, as by the floor that it stands on: the
  // other three leave one place, where nothing speaks for another. A panel a few centimetres larger
  // makes itself fit by shifts that are hardly likely.
  const double on_sides = static_cast<double>(board->edges.crossings.size()) /
                          static_cast<double>(members.crossings.size());
  const bool is_whole = on_sides >= kLeastOnSides && board->score >= kLeastScore;
  const bool is_but_one = on_sides >= kLeastOnThree && board->but_one >= kLeastScore;
  const bool is_board = board->deviation <= kMostDeviation && (is_whole || is_but_one);
  if (!is_board) return std::nullopt;
  return board;
}

// The piece that looks most like a board of another size, for the reason.
class Likeness {
 public:
  void Consider(const PlaneMembers& members) {
    if (members.flat.size() < 30) return;
    const Size size = Measure(members.flat, Spacing(members));
    if (size.longer < 0.25 || size.longer > 2.5 || size.shorter < 0.2) return;
    double around = 0;
    for (const FlatCrossing& c : members.crossings) around += c.length_m;
    // Wholly outlined, and filled like a rectangle.
    const double outlined = around / (2 * (size.longer + size.shorter));
    const double area = static_cast<double>(members.flat.size()) * members.beam_m2;
    const double filled = area / (size.longer * size.shorter);
    const double likeness = std::min(outlined, 1.0) * std::min(filled, 1.0);
    if (likeness < 0.6 || likeness <= best_) return;
    best_ = likeness;
    size_ = size;
  }
  std::string Why(const Target& target) const {
    std::ostringstream text;
    text.precision(2);
    text << std::fixed << "no board of the target's size in the cloud";
    if (best_ > 0) {
      text << "; the likeliest piece measured " << size_.shorter << " x " << size_.longer
           << " m, the rig file says " << std::min(target.width_m, target.height_m) << " x "
           << std::max(target.width_m, target.height_m) << " m";
    } else {
      text << "; is it wholly in the LIDAR's view and nothing touching its sides?";
    }
    return text.str();
  }

 private:
  double best_ = 0;
  Size size_;
};

// Rectangles of the target's size; of a plain one also as it looks where it glares
// (kPlainClassShiftSigmaRad).
std::vector<FlatRectangle> Vote(const PlaneMembers& members, const Target& target, double range_m) {
  constexpr double kSwellRad = 0.004;
  constexpr int kPlainSizes = 3;
  std::vector<FlatRectangle> voted;
  for (int i = 0; i < (target.WhiteToTheRim() ? kPlainSizes : 1); ++i) {
    const double swell = 2 * i * kSwellRad * range_m;
    const auto more =
        VoteForRectangles(members.crossings, target.width_m + swell, target.height_m + swell);
    voted.insert(voted.end(), more.begin(), more.end());
  }
  return voted;
}

// Looks at all the beams of a region; and where that shows a board, once more about its centre, so
// that what touches it has no say in where its plane lies.
std::vector<Candidate> LookCloser(const RangeGrid& grid, PlaneRegion region, const Target& target,
                                  const BoardInCloudOptions& options, Likeness* likeness) {
  const double diagonal = std::hypot(target.width_m, target.height_m);
  PlaneSums sums;
  for (const Eigen::Vector3f& p : region.points) sums.Add(p.cast<double>());
  const MemberOptions whole{options.range_sigma_m, sums.Mean(), 1.2 * diagonal, 1.2 * diagonal};
  const PlaneMembers members = FindMembers(grid, region, whole);
  std::vector<Candidate> found;
  for (const FlatRectangle& voted : Vote(members, target, whole.middle.norm())) {
    const auto board = FitBoard(grid.cloud(), members, voted, target, options);
    if (!board) continue;
    region.plane = {board->edges.normal, board->edges.normal.dot(board->edges.centre)};
    const MemberOptions closer{options.range_sigma_m, board->edges.centre, 0.7 * diagonal,
                               0.5 * std::min(target.width_m, target.height_m)};
    PlaneMembers about = FindMembers(grid, region, closer);
    const FlatRectangle near = InFrame(about.frame, *board);
    std::optional<Candidate> better;
    if (DoesNotRepeat(grid) || MayNotRepeat(grid, options)) {
      better = FitScattered(grid.cloud(), about, near, target, options);
    }
    if (!better && !DoesNotRepeat(grid)) {
      better = FitBoard(grid.cloud(), about, near, target, options);
    }
    if (better) found.push_back(std::move(*better));
  }
  if (found.empty()) likeness->Consider(members);
  return found;
}

PlaneRegionOptions RegionOptions(const Target& target, const BoardInCloudOptions& options) {
  PlaneRegionOptions out;
  out.sigma_m = std::max(0.008, options.range_sigma_m);
  out.max_range_m = options.max_range_m;
  out.largest_m = 2.2 * std::hypot(target.width_m, target.height_m);
  out.smallest_m = std::min(target.width_m, target.height_m);
  out.seed_m = std::min(0.15, 0.2 * out.smallest_m);
  return out;
}

BoardsInCloud FindAtNoise(const RangeGrid& grid, const Target& target,
                          const BoardInCloudOptions& options) {
  std::vector<Candidate> found;
  Likeness likeness;
  for (const PlaneRegion& region : FindPlaneRegions(grid, RegionOptions(target, options))) {
    if (!MayBe(region, target)) continue;
    for (Candidate& board : LookCloser(grid, region, target, options, &likeness)) {
      found.push_back(std::move(board));
    }
  }
  if (found.empty()) return {{}, likeness.Why(target)};
  std::stable_sort(found.begin(), found.end(),
                   [](const Candidate& a, const Candidate& b) { return a.score > b.score; });
  BoardsInCloud boards;
  for (Candidate& c : found) {
    if (static_cast<int>(boards.candidates.size()) == options.max_candidates) break;
    if (std::any_of(boards.candidates.begin(), boards.candidates.end(),
                    [&](const CloudEdges& kept) { return IsSame(kept, c.edges); })) {
      continue;
    }
    boards.candidates.push_back(std::move(c.edges));
  }
  return boards;
}

}  // namespace

BoardInCloudOptions OptionsFor(const LidarSpec& lidar) {
  BoardInCloudOptions options;
  options.range_sigma_m = lidar.range_sigma_m;
  options.one_laser = lidar.turned_scanner.has_value();
  return options;
}

void BoardInCloudOptions::Check() const {
  const OptionCheck check("board in cloud");
  check.Positive(range_sigma_m, "range_sigma_m");
  check.Positive(max_range_m, "max_range_m");
  check.Positive(max_candidates, "max_candidates");
  check.Positive(edge.class_sigma_rad, "edge.class_sigma_rad");
  check.Positive(edge.side_sigma_rad, "edge.side_sigma_rad");
  check.Positive(edge.blur_rad, "edge.blur_rad");
  check.Positive(edge.thickness_m, "edge.thickness_m");
  check.Positive(edge.thickness_sigma_m, "edge.thickness_sigma_m");
}

BoardsInCloud FindBoards(const Cloud& cloud, const Target& target,
                         const BoardInCloudOptions& options) {
  options.Check();
  const RangeGrid grid(cloud);
  if (grid.hits() < 100) {
    return {{},
            "the cloud has " + std::to_string(grid.hits()) +
                " points; is the LIDAR connected and the view not covered?"};
  }
  // Many a LIDAR is noisier than its rig file says: where nothing is found, twice as noisy.
  constexpr double kMostSigma = 0.045;
  BoardInCloudOptions noisier = options;
  noisier.one_laser |= grid.misnumbered();  // nor do the numbers tell lasers
  if (target.WhiteToTheRim()) {
    noisier.edge.class_sigma_rad = std::max(noisier.edge.class_sigma_rad, kPlainClassShiftSigmaRad);
  }
  const BoardsInCloud as_stated = FindAtNoise(grid, target, noisier);
  BoardsInCloud boards = as_stated;
  while (boards.candidates.empty() && 2 * noisier.range_sigma_m <= kMostSigma) {
    noisier.range_sigma_m *= 2;
    boards = FindAtNoise(grid, target, noisier);
  }
  // Of points without order some cells stay empty by chance: fewer where cells are wider.
  for (const double coarser : {1.4, 2.0}) {
    if (!DoesNotRepeat(grid) || !boards.candidates.empty()) break;
    noisier.range_sigma_m = options.range_sigma_m;
    boards = FindAtNoise(RangeGrid(cloud, coarser), target, noisier);
  }
  if (!boards.candidates.empty()) return boards;
  const std::string off = WhyCloudIsOff(cloud);
  if (!off.empty()) return {{}, off};
  std::string lacks = WhyCutOut(cloud, target);
  if (lacks.empty() && !options.one_laser) lacks = WhyNoRings(grid);
  if (!lacks.empty()) return {{}, as_stated.why + "; " + lacks};
  if (grid.crowded() == 0) return as_stated;
  return {
      {},
      Format("%s; %.0f%% of the points share a beam: two returns, or several sweeps in one cloud?",
             as_stated.why.c_str(), 100 * grid.crowded())};
}

}  // namespace rgbdt
