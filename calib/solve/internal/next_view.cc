#include "calib/solve/internal/next_view.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "calib/model/linear_algebra.h"
#include "calib/model/statistics.h"
#include "calib/model/text.h"
#include "calib/solve/colouring.h"

namespace rgbdt {
namespace {

constexpr double kDegree = M_PI / 180;
constexpr double kDistanceM = 5;  // at which the colouring sigma is compared
constexpr double kTilt = 35 * kDegree;
constexpr double kMargin = 0.03;  // of the image's width that the board keeps from its border

using Index = Eigen::Index;

// Where the board might be held, as a person would say it.
struct Place {
  double range_m = 0, azimuth = 0, elevation = 0;  // of its centre, LIDAR frame
  double tilt = 0, tilt_towards = 0;  // of its normal off the line of sight; 0: right edge away
  double roll = 0;

  Rigid3 LidarFromTarget() const {
    const Eigen::Vector3d away(std::cos(elevation) * std::cos(azimuth),
                               std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
    const Eigen::Vector3d right = away.cross(Eigen::Vector3d::UnitZ()).normalized();
    Eigen::Matrix3d axes;
    axes << right, away.cross(right), away;
    Rigid3 facing{Eigen::Quaterniond(axes), range_m * away};
    // Turned about this axis, what lies towards `tilt_towards` moves away.
    const Eigen::Vector3d axis(std::sin(tilt_towards), -std::cos(tilt_towards), 0);
    return facing * RotationAbout(axis, tilt) * RotationAbout(Eigen::Vector3d::UnitZ(), roll);
  }

  std::string Words() const;
};

std::string Degrees(double rad) {
  return std::to_string(std::lround(std::abs(rad) / kDegree)) + " deg";
}

std::string Place::Words() const {
  std::string words = Format("hold the board %.1f m from the LIDAR, ", range_m);
  words += std::abs(azimuth) < kDegree ? std::string("straight ahead")
                                       : Degrees(azimuth) + (azimuth > 0 ? " left" : " right");
  if (std::abs(elevation) >= kDegree) {
    words += ", " + Degrees(elevation) + (elevation > 0 ? " above" : " below") + " its height";
  }
  const int towards = static_cast<int>(std::lround(tilt_towards / (90 * kDegree)));
  const char* const edges[] = {"right", "lower", "left", "upper"};
  words += std::string(", its ") + edges[towards % 4] + " edge turned " + Degrees(tilt) + " away";
  if (std::abs(roll) >= kDegree) words += ", rolled " + Degrees(roll);
  return words;
}

// Between the lowest and the highest of points, as the LIDAR sees them [rad].
template <typename Points, typename ToPoint>
double HeightOf(const Points& points, const ToPoint& to_point) {
  double low = 10;
  double high = -10;
  for (const auto& each : points) {
    const Eigen::Vector3d p = to_point(each);
    const double elevation = std::atan2(p.z(), p.head<2>().norm());
    low = std::min(low, elevation);
    high = std::max(high, elevation);
  }
  return std::max(0.0, high - low);
}

// How many rings lie on the board. A cloud that does not tell them apart is of a turned scanner,
// whose lines cross the outline twice.
double RingsOn(const CloudEdges& cloud) {
  std::set<int> rings;
  for (const PointGroup& group : cloud.groups) {
    if (group.ring >= 0) rings.insert(group.ring);
  }
  return rings.empty() ? 0.5 * static_cast<double>(cloud.crossings.size())
                       : static_cast<double>(rings.size());
}

// How exactly this LIDAR and these cameras see a board, whatever its place.
struct Exactness {
  double rings_per_rad = 0;  // of a board's height, as the LIDAR sees it
  double points_per_sr = 0, scatter_sigma_m = 0;
  double crossings_per_rad = 0;  // of a side's apparent length
  double half_width_rad = 0, crossing_sigma_rad = 0;
  std::vector<double> corner_sigma_px;
};

Exactness ExactnessOf(const BoardProblem& problem) {
  std::vector<double> points, scatter, crossings, rings, widths, sigmas;
  std::vector<std::vector<double>> corners(problem.cameras.size());
  const double area = problem.target.width_m * problem.target.height_m;
  const double outline = 2 * (problem.target.width_m + problem.target.height_m);
  for (const BoardView& view : problem.views) {
    const CloudEdges& cloud = view.cloud;
    const double range = cloud.centre.norm();
    const double facing = std::abs(cloud.normal.dot(cloud.centre.normalized()));
    points.push_back(cloud.points * range * range / (area * std::max(0.1, facing)));
    scatter.push_back(cloud.scatter_sigma_m);
    crossings.push_back(static_cast<double>(cloud.crossings.size()) * range / outline);
    // The first and the last one are a height apart.
    const double height = HeightOf(cloud.crossings, [](const Crossing& c) { return c.point; });
    rings.push_back(std::max(0.0, RingsOn(cloud) - 1) / std::max(1e-3, height));
    for (const Crossing& c : cloud.crossings) {
      widths.push_back(c.half_width_m / range);
      sigmas.push_back(c.sigma_m / range);
    }
    for (const BoardImage& image : view.images) {
      corners[static_cast<std::size_t>(image.camera)].push_back(image.edges->corner_sigma_px);
    }
  }
  Exactness out{Median(rings),
                Median(points),
                Median(scatter),
                Median(crossings),
                Median(widths),
                Median(sigmas),
                {}};
  for (auto& own : corners) out.corner_sigma_px.push_back(Median(own));
  return out;
}

// What the cloud of a board there would be.
CloudEdges ExpectedCloud(const Target& target, const Exactness& exactness,
                         const Rigid3& lidar_from_target) {
  CloudEdges cloud;
  cloud.pose = TargetPose{lidar_from_target, Matrix6d::Zero(), true};
  cloud.centre = lidar_from_target.translation;
  const double range = cloud.centre.norm();
  const Eigen::Matrix3d axes = lidar_from_target.rotation.toRotationMatrix();
  const double facing = std::abs(axes.col(2).dot(cloud.centre)) / range;
  const double w = target.width_m;
  const double h = target.height_m;
  const double points = exactness.points_per_sr * w * h * facing / (range * range);
  // Spread evenly over the board.
  cloud.scatter.topLeftCorner<3, 3>() = points / 12 *
                                        (w * w * axes.col(0) * axes.col(0).transpose() +
                                         h * h * axes.col(1) * axes.col(1).transpose());
  cloud.scatter(3, 3) = points;
  cloud.raw_scatter = cloud.scatter;
  cloud.scatter_sigma_m = exactness.scatter_sigma_m;
  const auto corners = target.OutlineCorners();
  for (int side = 0; side < 4; ++side) {
    const Eigen::Vector3d& from = corners[static_cast<std::size_t>(side)];
    const Eigen::Vector3d& to = corners[static_cast<std::size_t>((side + 1) % 4)];
    const int count = std::clamp(
        static_cast<int>(exactness.crossings_per_rad * (to - from).norm() / range), 1, 2000);
    for (int i = 0; i < count; ++i) {
      Crossing c;
      c.point = lidar_from_target * Eigen::Vector3d(from + (to - from) * (i + 0.5) / count);
      c.half_width_m = exactness.half_width_rad * range;
      c.sigma_m = exactness.crossing_sigma_rad * range;
      c.side = side;
      c.kind = CrossingKind::kFar;
      cloud.crossings.push_back(c);
    }
  }
  return cloud;
}

// A board without a pattern shows its sides.
void AddSides(const Camera& camera, const Rigid3& camera_from_target, const Target& target,
              ImageEdges* image) {
  const auto corners = target.OutlineCorners();
  for (std::size_t i = 0; i < 4; ++i) {
    ImageSide& side = image->sides[i];
    side.curve = ProjectSegment(camera, camera_from_target * corners[i],
                                camera_from_target * corners[(i + 1) % 4], 8);
    side.seen = side.curve.size() > 2;
    side.covariance = std::pow(image->corner_sigma_px, 2) * Eigen::Matrix2d::Identity();
  }
}

// What each camera would see; nothing where one does not see the whole board.
std::optional<std::vector<ImageEdges>> ExpectedImages(const BoardProblem& problem,
                                                      const BoardState& state,
                                                      const Exactness& exactness,
                                                      const Rigid3& lidar_from_target) {
  std::vector<ImageEdges> images(problem.cameras.size());
  for (std::size_t c = 0; c < problem.cameras.size(); ++c) {
    const Camera& camera = problem.cameras[c];
    const Rigid3 camera_from_target = state.camera_from_lidar[c] * lidar_from_target;
    const double margin = kMargin * camera.width();
    for (const Eigen::Vector3d& corner : problem.target.OutlineCorners()) {
      const auto pixel = camera.Project(camera_from_target * corner);
      if (!pixel || !camera.Contains(*pixel - Eigen::Vector2d(margin, margin)) ||
          !camera.Contains(*pixel + Eigen::Vector2d(margin, margin))) {
        return std::nullopt;
      }
    }
    images[c].corner_sigma_px = exactness.corner_sigma_px[c];
    for (const Eigen::Vector3d& corner : problem.target.InnerCorners()) {
      const auto pixel = camera.Project(camera_from_target * corner);
      if (!pixel) return std::nullopt;
      images[c].corners.push_back(*pixel);
    }
    if (images[c].corners.empty()) AddSides(camera, camera_from_target, problem.target, &images[c]);
  }
  return images;
}

// What a board there would tell of the shared unknowns.
std::optional<Eigen::MatrixXd> Expected(const BoardProblem& problem, const BoardState& state,
                                        const Exactness& exactness,
                                        const Rigid3& lidar_from_target) {
  const auto images = ExpectedImages(problem, state, exactness, lidar_from_target);
  if (!images) return std::nullopt;
  BoardView view;
  view.cloud = ExpectedCloud(problem.target, exactness, lidar_from_target);
  for (std::size_t c = 0; c < images->size(); ++c) {
    view.images.push_back({static_cast<int>(c), &(*images)[c], false});
  }
  auto [alone, there] = Part(problem, {}, state);
  alone.views = {view};
  there.lidar_from_target = {lidar_from_target};
  there.side_shift = {{}};
  for (std::size_t l = 0; l < alone.lidars.size(); ++l) {  // it is not said to see the board there
    alone.lidars[l].views = {BoardView()};
    there.lidars[l].side_shift = {{}};
  }
  return InformationOf(alone, there, 0).information;
}

// Directions in which boards were seen, and somewhat beyond [rad].
struct Field {
  double low_azimuth = 1e9, high_azimuth = -1e9, low_elevation = 1e9, high_elevation = -1e9;

  explicit Field(const BoardProblem& problem) {
    for (const BoardView& view : problem.views) {
      for (const Crossing& crossing : view.cloud.crossings) {
        const Eigen::Vector3d& p = crossing.point;
        const double azimuth = std::atan2(p.y(), p.x());
        const double elevation = std::asin(std::clamp(p.z() / p.norm(), -1.0, 1.0));
        low_azimuth = std::min(low_azimuth, azimuth - 5 * kDegree);
        high_azimuth = std::max(high_azimuth, azimuth + 5 * kDegree);
        low_elevation = std::min(low_elevation, elevation - 3 * kDegree);
        high_elevation = std::max(high_elevation, elevation + 3 * kDegree);
      }
    }
  }
};

// Whether six rings of a spinning LIDAR lie on the board; fewer are too few
// (calib/detect/TARGET.md).
bool EnoughRings(const Target& target, const Exactness& exactness, const Place& place) {
  constexpr double kLeastRings = 6;
  const Rigid3 lidar_from_target = place.LidarFromTarget();
  const double height = HeightOf(target.OutlineCorners(), [&](const Eigen::Vector3d& corner) {
    return Eigen::Vector3d(lidar_from_target * corner);
  });
  return exactness.rings_per_rad * height >= kLeastRings;
}

std::vector<Place> PlacesToTry(const BoardProblem& problem, const Exactness& exactness) {
  const Field field(problem);
  std::vector<Place> places;
  for (const double range : {1.5, 2.0, 3.0, 4.5, 6.0}) {
    const double reach = std::atan(0.5 * problem.target.width_m / range);
    for (const double across : {0.0, 0.5, 1.0}) {
      for (const double up : {0.0, 0.5, 1.0}) {
        const auto between = [&](double low, double high, double share) {
          return low + reach + share * std::max(0.0, high - low - 2 * reach);
        };
        for (int towards = 0; towards < 4; ++towards) {
          for (const double roll : {0.0, 30 * kDegree}) {
            const Place place{range,
                              between(field.low_azimuth, field.high_azimuth, across),
                              between(field.low_elevation, field.high_elevation, up),
                              kTilt,
                              towards * 90 * kDegree,
                              roll};
            if (EnoughRings(problem.target, exactness, place)) places.push_back(place);
          }
        }
      }
    }
  }
  return places;
}

// The worst camera's worst sigma.
struct Worst {
  std::size_t camera = 0;
  double sigma_px = 0;
};

Worst WorstOf(const BoardProblem& problem, const Eigen::MatrixXd& covariance) {
  Worst worst;
  for (std::size_t c = 0; c < problem.cameras.size(); ++c) {
    const Camera& camera = problem.cameras[c];
    const auto places = SharedPlaces(problem).PoseAndLens(c);
    const PoseAndLensCovariance own = covariance(places, places);
    for (const double x : {0.0, 0.5, 1.0}) {
      for (const double y : {0.0, 0.5, 1.0}) {
        const Eigen::Vector2d pixel(x * (camera.width() - 1), y * (camera.height() - 1));
        const auto sigma = ColouringSigmaAt(camera, own, pixel, kDistanceM);
        if (sigma && *sigma > worst.sigma_px) worst = {c, *sigma};
      }
    }
  }
  return worst;
}

BoardProblem WithLenses(BoardProblem problem, const JointResult& result) {
  for (std::size_t c = 0; c < problem.cameras.size(); ++c) {
    CameraSpec spec = *result.joint.cameras[c].views.spec;
    spec.lens = result.solution.state.lenses[c];
    problem.cameras[c] = Camera(spec);
  }
  return problem;
}

}  // namespace

std::optional<NextView> FindNextView(const JointResult& result) {
  const JointProblem& joint = result.joint;
  const BoardState& state = result.solution.state;
  if (joint.problem.views.empty()) return std::nullopt;
  const BoardProblem problem = WithLenses(joint.problem, result);
  const Eigen::MatrixXd& covariance = result.solution.covariance;
  const Eigen::MatrixXd information = InverseOfSymmetric(covariance);
  const Exactness exactness = ExactnessOf(problem);
  const double scale = std::sqrt(result.PoseFactor());
  const Worst before = WorstOf(problem, covariance);
  std::optional<NextView> best;
  for (const Place& place : PlacesToTry(problem, exactness)) {
    const auto more = Expected(problem, state, exactness, place.LidarFromTarget());
    if (!more) continue;
    const Worst after = WorstOf(problem, InverseOfSymmetric(Eigen::MatrixXd(information + *more)));
    if (best && scale * after.sigma_px >= best->sigma_after_px) continue;
    best = NextView{place.Words(), place.LidarFromTarget(),
                    joint.cameras[before.camera].views.spec->name, scale * before.sigma_px,
                    scale * after.sigma_px};
  }
  return best;
}

}  // namespace rgbdt
