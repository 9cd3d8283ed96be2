#include "tests/unit/solve/solve_world.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>

#include "calib/camera/outline_pose.h"
#include "calib/camera/pixel_by_point.h"
#include "calib/model/linear_algebra.h"
#include "calib/solve/first_guess.h"

namespace rgbdt {
namespace {

constexpr double kCrossingRad = 0.010, kHalfWidthRad = 0.0015, kPointRad = 0.010;

CameraSpec Fisheye() {
  CameraSpec spec;
  spec.name = "thermal";
  spec.kind = CameraKind::kThermal;
  spec.width = 480;
  spec.height = 384;
  spec.lens = {Lens::Model::kFisheye, 330, 331, 238.7, 190.2, {-0.03, 0.01, -0.004, 0.001}};
  return spec;
}

void TurnByQuarters(int count, ImageEdges* image) {
  image->pose->sensor_from_target = image->pose->sensor_from_target * QuarterTurns(count);
  std::rotate(image->sides.begin(), image->sides.begin() + count, image->sides.end());
}

Eigen::Vector3d Outward(int side) {
  const Eigen::Vector3d outward[] = {{0, -1, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}};
  return outward[side];
}

}  // namespace

SolveWorld::SolveWorld(const SolveWorldOptions& options)
    : options_(options), random_(options.seed) {
  rig.hash = "hash";
  rig.target = {9, 6, 0.1, 1.0, 0.7, {0, 0}, {}, options.print_sigma};
  if (options.plain) rig.target = {0, 0, 0, 0.8, 0.8, {0, 0}, {}};
  rig.cameras = {WorldCamera(), Fisheye()};
  for (CameraSpec& camera : rig.cameras) {
    camera.lens_uncertainty = options.lens_uncertainty;
    true_lenses_.push_back(camera.lens);
  }
  camera_from_lidar = {WorldTruth(), RotationAbout({-0.4, 0.9, 0.2}, 0.05) * WorldTruth()};
  camera_from_lidar[1].translation = {-0.11, 0.04, 0.02};
  shared = options.shared;
  if (options.draw_nuisances) shared = Drawn(true);
  if (options.rings) {
    for (double& offset : ring_offset_m) offset = options.rings->sigma_m * Normal();
  }
  while (static_cast<int>(lidar_from_target.size()) < options.views) AddView(AnyBoard());
}

void SolveWorld::AddView(const Rigid3& board) {
  const auto n = lidar_from_target.size();
  lidar_from_target.push_back(board);
  side_shift.emplace_back();
  for (double& shift : side_shift.back()) shift = options_.side_sigma_rad * Normal();
  ViewDetection detection;
  detection.view = (n < 9 ? "000" : "00") + std::to_string(n + 1);
  detection.heldout =
      options_.heldout_every > 0 && n % static_cast<std::size_t>(options_.heldout_every) == 1;
  const auto motor = options_.motor.value_or(SolveWorldOptions::Motor{});
  const double turn = (motor.both_ways && n % 2 == 1 ? -1 : 1) * motor.turn_rad_s;
  // At the angle that is read the motor was before: the cloud is turned back by what came since.
  const Rigid3 late = RotationAbout(Eigen::Vector3d::UnitZ(), -turn * motor.encoder_delay_s);
  detection.cloud.candidates = {SeeCloud(late * board, side_shift.back(), n % 2 == 1)};
  detection.cloud.candidates[0].turn_rad_s = turn;
  for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
    detection.images.push_back({rig.cameras[c].name, static_cast<Utime>(1000 + n),
                                SeeImage(c, camera_from_lidar[c] * board), "", 0});
  }
  detections.push_back(std::move(detection));
}

LidarViews SolveWorld::SeenBy(const std::string& lidar, const Rigid3& reference_from_lidar,
                              double ranges_off_m) {
  LidarViews views;
  views.report.calibration.lidar = lidar;
  views.range_offset_sigma_m = 0.02;
  const auto of_reference = shared;
  const auto drawn = Drawn(false);
  for (const std::size_t k : {kNoReturnShift, kFarShift, kMergedShift}) {
    if (options_.draw_nuisances) shared[k] = drawn[k];
  }
  shared[kRangeOffset] = ranges_off_m;
  for (std::size_t v = 0; v < detections.size(); ++v) {
    std::array<double, 4> shift{};
    for (double& side : shift) side = options_.side_sigma_rad * Normal();
    CloudDetection seen;
    seen.candidates = {
        SeeCloud(reference_from_lidar.Inverse() * lidar_from_target[v], shift, v % 3 == 1)};
    views.Add(detections[v].view, seen);
  }
  shared = of_reference;
  return views;
}

bool SolveWorld::Seen(const Rigid3& board, double margin_px) const {
  const Eigen::Vector3d away = board.translation.normalized();
  if (away.dot(board.rotation * Eigen::Vector3d::UnitZ()) < 0.5) return false;
  for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
    const Camera camera(rig.cameras[c]);
    const Eigen::Vector2d margin(margin_px, margin_px);
    for (const Eigen::Vector3d& corner : rig.target.OutlineCorners()) {
      const auto pixel = camera.Project(camera_from_lidar[c] * (board * corner));
      if (!pixel || !camera.Contains(*pixel - margin) || !camera.Contains(*pixel + margin)) {
        return false;
      }
    }
  }
  return true;
}

double SolveWorld::Normal() {
  // Box and Muller; the standard's distribution differs between libraries.
  return std::sqrt(-2 * std::log(random_.Uniform(1e-12, 1))) *
         std::cos(2 * M_PI * random_.Uniform(0, 1));
}

Rigid3 SolveWorld::AnyBoard() {
  while (true) {
    Rigid3 camera_from_target = RotationAbout(random_.Direction(), random_.Uniform(0.2, 0.7)) *
                                RotationAbout({0, 0, 1}, random_.Uniform(-0.5, 0.5));
    const double z = random_.Uniform(1.8, 4);
    camera_from_target.translation = {random_.Uniform(-0.5, 0.5) * z,
                                      random_.Uniform(-0.4, 0.4) * z, z};
    Rigid3 board = camera_from_lidar[0].Inverse() * camera_from_target;
    if (Seen(board)) return board;
  }
}

std::array<double, kSharedUnknowns> SolveWorld::Drawn(bool outline) {
  const BoardPriors priors;
  auto drawn = priors.Means();
  for (int k = 0; k < kRangeOffset; ++k) {
    if (k < kOutlineTop || outline) {
      drawn[static_cast<std::size_t>(k)] += priors.Sigma(k) * Normal();
    }
  }
  for (const int k : {kPrintWidth, kPrintHeight}) {
    if (options_.print_sigma == 0) continue;
    drawn[static_cast<std::size_t>(k)] = options_.print_sigma * Normal();
  }
  for (const int k : {kBowX, kTwist, kBowY}) {
    if (options_.print_sigma == 0) continue;
    drawn[static_cast<std::size_t>(k)] = kBowSigmaM * Normal();
  }
  return drawn;
}

// Where a point of a flat board lies on one of this shape: a bowl's and a saddle's height over the
// mean plane.
Eigen::Vector3d SolveWorld::Bent(const Eigen::Vector3d& flat) const {
  const double x = flat.x() / rig.target.width_m;
  const double y = flat.y() / rig.target.height_m;
  return flat + (shared[kBowX] * (4 * x * x - 1.0 / 3) + shared[kTwist] * 4 * x * y +
                 shared[kBowY] * (4 * y * y - 1.0 / 3)) *
                    Eigen::Vector3d::UnitZ();
}

// The image's corners and sides, and the pose that the corners give.
ImageEdges SolveWorld::SeeImage(std::size_t c, const Rigid3& camera_from_target) {
  const Camera camera(rig.cameras[c]);
  ImageEdges image;
  image.width = camera.width();
  image.height = camera.height();
  // Errors are larger than the corners' scatter tells by what is taken for granted of them.
  image.corner_sigma_px = (c == 0 ? 0.08 : 0.2) / kCornerSigmaInflation;
  for (const Eigen::Vector3d& corner : PrintedAs(rig.target, shared).InnerCorners()) {
    image.corners.emplace_back(*camera.Project(camera_from_target * Bent(corner)) +
                               kCornerSigmaInflation * image.corner_sigma_px *
                                   Eigen::Vector2d(Noise(), Noise()));
  }
  const auto corners = rig.target.OutlineCorners();
  for (std::size_t s = 0; s < 4; ++s) {
    const Eigen::Vector3d out = shared[kOutlineTop + s] * Outward(static_cast<int>(s));
    std::vector<Eigen::Vector2d> chain;
    for (int i = 0; i <= 20; ++i) {
      const Eigen::Vector3d on_side =
          corners[s] + out + i / 20.0 * (corners[(s + 1) % 4] - corners[s]);
      chain.push_back(*camera.Project(camera_from_target * Bent(on_side)));
    }
    image.outline_corners[s] = chain.front();
    image.outline.insert(image.outline.end(), chain.begin(), chain.end() - 1);
    for (const Eigen::Vector2d& p : chain) {
      image.edge_pixels.emplace_back(std::lround(p.x()), std::lround(p.y()));
    }
    image.sides[s] = SeeSide(chain, 0.1);
  }
  if (rig.target.HasPattern()) {
    image.pose = PoseOfCorners(camera, image, camera_from_target);
  } else {
    image.pose = PoseFromSides(camera, rig.target, image.sides, camera_from_target, 0)->pose;
    TurnByQuarters(static_cast<int>(detections.size()) % 4, &image);
  }
  return image;
}

ImageSide SolveWorld::SeeSide(const std::vector<Eigen::Vector2d>& chain, double sigma) {
  const double common = sigma * Noise();
  const double ends[] = {common + sigma * Noise(), common + sigma * Noise()};
  ImageSide side{true, "", {}, Eigen::Matrix2d::Constant(sigma * sigma)};
  side.covariance.diagonal() *= 2;
  const auto last = chain.size() - 1;
  for (std::size_t i = 0; i <= last; ++i) {
    const Eigen::Vector2d along =
        (i < last ? chain[i + 1] - chain[i] : chain[i] - chain[i - 1]).normalized();
    const double t = static_cast<double>(i) / static_cast<double>(last);
    side.curve.emplace_back(chain[i] + ((1 - t) * ends[0] + t * ends[1]) *
                                           Eigen::Vector2d(-along.y(), along.x()));
  }
  return side;
}

TargetPose SolveWorld::PoseOfCorners(const Camera& camera, const ImageEdges& image,
                                     Rigid3 pose) const {
  const auto model = rig.target.InnerCorners();
  Matrix6d h = Matrix6d::Zero();
  for (int round = 0; round < 4; ++round) {
    h.setZero();
    Vector6d g = Vector6d::Zero();
    for (std::size_t i = 0; i < model.size(); ++i) {
      const Eigen::Vector3d p = pose * model[i];
      Eigen::Matrix<double, 3, 6> by_delta;
      by_delta << 0, p.z(), -p.y(), 1, 0, 0,  //
          -p.z(), 0, p.x(), 0, 1, 0,          //
          p.y(), -p.x(), 0, 0, 0, 1;
      const Eigen::Matrix<double, 2, 6> j = PixelByPoint(camera.lens(), p) * by_delta;
      h += j.transpose() * j;
      g += j.transpose() * (image.corners[i] - *camera.Project(p));
    }
    pose = Exp(Vector6d(h.ldlt().solve(g))) * pose;
  }
  return {pose, Matrix6d(std::pow(image.corner_sigma_px, 2) * h.inverse()), true};
}

CloudEdges SolveWorld::SeeCloud(const Rigid3& board, const std::array<double, 4>& shift,
                                bool turned) {
  CloudEdges cloud;
  SeePlane(board, &cloud);
  if (options_.rings) SeeRings(board, &cloud);
  const auto nuisances = options_.nuisances_by_view ? Drawn(false) : shared;
  const auto corners = rig.target.OutlineCorners();
  for (int side = 0; side < 4; ++side) {
    const auto s = static_cast<std::size_t>(side);
    const auto kind = static_cast<CrossingKind>(1 + std::lround(random_.Uniform(-0.5, 2.5)));
    const Eigen::Vector3d along = corners[(s + 1) % 4] - corners[s];
    const int count =
        static_cast<int>(along.norm() / (kCrossingRad * board.translation.norm())) + 2;
    for (int i = 0; i < count; ++i) {
      cloud.crossings.push_back(SeeCrossing(board, Bent(corners[s] + (i + 0.5) / count * along),
                                            side, kind, nuisances, shift[s]));
    }
    for (int i = 0; i < 25; ++i) {
      cloud.boundary.emplace_back(board * (corners[s] + i / 25.0 * along));
    }
  }
  cloud.pose = PoseOfCloud(cloud, board);
  if (turned) {
    cloud.pose->sensor_from_target = cloud.pose->sensor_from_target * kHalfTurn;
    for (Crossing& crossing : cloud.crossings) crossing.side = (crossing.side + 2) % 4;
  }
  return cloud;
}

// Where a scan leaves the board: the side as the beam's width, the rim and the cut shift it,
// somewhere in the interval between two beams.
Crossing SolveWorld::SeeCrossing(const Rigid3& board, const Eigen::Vector3d& on_side, int side,
                                 CrossingKind kind,
                                 const std::array<double, kSharedUnknowns>& nuisances,
                                 double own_shift) {
  const BoardPriors priors;
  const Eigen::Vector3d outward = Outward(side);
  const Eigen::Vector3d lidar = board.Inverse().translation;
  const double range = board.translation.norm();
  Crossing crossing;
  crossing.side = side;
  crossing.kind = kind;
  crossing.half_width_m = kHalfWidthRad * range * random_.Uniform(0.7, 1.3);
  const double place = options_.noise * random_.Uniform(-1, 1) * crossing.half_width_m;
  const double blur = priors.blur_rad * Noise();
  Eigen::Vector3d at = on_side;
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector3d beam = at - lidar;
    const double per_rad = beam.norm() / std::sqrt(1 - std::pow(beam.normalized().dot(outward), 2));
    const double rim = std::max(0.0, -beam.dot(outward) / beam.z());
    const double angle =
        nuisances[static_cast<std::size_t>(kNoReturnShift) + static_cast<std::size_t>(kind) - 1] +
        own_shift + blur;
    at = on_side +
         (nuisances[static_cast<std::size_t>(kOutlineTop + side)] + per_rad * angle +
          per_rad / beam.norm() * nuisances[kFringe] + rim * nuisances[kThickness] + place) *
             outward;
    crossing.sigma_m = std::hypot(crossing.half_width_m / std::sqrt(3), priors.blur_rad * per_rad);
  }
  crossing.point = Published(board * at);
  return crossing;
}

void SolveWorld::SeePlane(const Rigid3& board, CloudEdges* cloud) {
  const double range = board.translation.norm();
  const Eigen::Vector3d n = board.rotation * Eigen::Vector3d::UnitZ();
  const double facing = n.dot(board.translation) / range;
  const double w = rig.target.width_m;
  const double h = rig.target.height_m;
  cloud->points = static_cast<int>(w * h * facing / std::pow(kPointRad * range, 2));
  cloud->centre = board.translation;
  cloud->normal = -n;
  cloud->width_m = w;
  cloud->height_m = h;
  cloud->spacing_m = kPointRad * range;
  cloud->scatter_sigma_m = 0.006;
  for (int i = 0; i < cloud->points; ++i) {
    const Eigen::Vector3d on =
        board * Eigen::Vector3d(w * random_.Uniform(-0.5, 0.5), h * random_.Uniform(-0.5, 0.5), 0);
    const double off = cloud->scatter_sigma_m * Noise();
    const Eigen::Vector3d beam = on.normalized();
    const Eigen::Vector3d measured = on - shared[kRangeOffset] * beam;
    Eigen::Vector4d q(0, 0, 0, 1);
    q.head<3>() = measured + off * n - cloud->centre;
    cloud->scatter += q * q.transpose();
    q.head<3>() = measured + off / beam.dot(n) * beam - cloud->centre;
    cloud->raw_scatter += q * q.transpose();
  }
}

// As SeePlane, told apart by ring and by brightness.
void SolveWorld::SeeRings(const Rigid3& board, CloudEdges* cloud) {
  constexpr double kRingRad = 2 * M_PI / 180;  // ring 8 looks level
  constexpr double kAcrossRad = 0.004;
  constexpr double kDark = -3.4;
  constexpr double kBright = -0.7;
  const double range = board.translation.norm();
  const Eigen::Vector3d n = board.rotation * Eigen::Vector3d::UnitZ();
  cloud->centre = Published(board.translation);
  cloud->group_sigma_m = cloud->scatter_sigma_m;
  cloud->scatter.setZero();
  std::array<double, 16> in_view{};
  for (double& offset : in_view) offset = options_.rings->in_view_sigma_m * Normal();
  std::map<std::pair<int, bool>, PointGroup> groups;
  for (int ring = 0; ring < 16; ++ring) {
    const double elevation = kRingRad * (ring - 8);
    const double azimuth = std::atan2(board.translation.y(), board.translation.x());
    for (double a = azimuth - 1; a < azimuth + 1; a += kAcrossRad) {
      const Eigen::Vector3d beam(std::cos(a) * std::cos(elevation),
                                 std::sin(a) * std::cos(elevation), std::sin(elevation));
      const Eigen::Vector3d start(0, 0, -options_.rings->beams_meet_m * std::tan(elevation));
      const double towards = n.dot(beam);
      const double met = n.dot(board.translation - start) / towards;
      if (!(met > 0) || met > 2 * range) continue;
      const Eigen::Vector3d on = board.Inverse() * Eigen::Vector3d(start + met * beam);
      if (std::abs(on.x()) > 0.46 * rig.target.width_m ||
          std::abs(on.y()) > 0.46 * rig.target.height_m) {
        continue;
      }
      const bool dark =
          (static_cast<int>(on.x() / 0.1 + 100) + static_cast<int>(on.y() / 0.1 + 100)) % 2 == 0;
      const auto r = static_cast<std::size_t>(ring);
      const double offset = shared[kRangeOffset] + ring_offset_m[r] + in_view[r] -
                            (dark ? options_.rings->dark_m : 0);
      const double noise = cloud->group_sigma_m * Noise();
      Eigen::Vector4d q(0, 0, 0, 1);
      q.head<3>() = (met - offset) * beam + noise * n - cloud->centre;
      PointGroup& group = groups[{ring, dark}];
      group.ring = ring;
      group.log2_intensity = dark ? kDark : kBright;
      group.scatter += q * q.transpose();
      cloud->scatter += q * q.transpose();
    }
  }
  for (const auto& [key, group] : groups) cloud->groups.push_back(group);
  cloud->raw_scatter = cloud->scatter;
  cloud->points = static_cast<int>(cloud->scatter(3, 3));
}

Eigen::Vector3d SolveWorld::Published(const Eigen::Vector3d& met) const {
  Eigen::Vector3d p = met;
  if (!options_.rings) return p;
  for (int i = 0; i < 5; ++i) {
    p.z() = met.z() + options_.rings->beams_meet_m * p.z() / p.head<2>().norm();
  }
  return p;
}

// From crossings and plane, their shifts unknown.
TargetPose SolveWorld::PoseOfCloud(const CloudEdges& cloud, Rigid3 pose) const {
  const BoardPriors priors;
  constexpr int kUnknowns = 14;  // pose, classes, sides, thickness
  using Matrix = Eigen::Matrix<double, kUnknowns, kUnknowns>;
  using Vector = Eigen::Matrix<double, kUnknowns, 1>;
  auto guess = priors.Means();
  std::array<double, 4> sides{};
  Matrix h;
  for (int round = 0; round < 6; ++round) {
    h.setZero();
    Vector g = Vector::Zero();
    const auto prior = [&](int k, double value, double sigma) {
      h(k, k) += 1 / (sigma * sigma);
      g[k] -= value / (sigma * sigma);
    };
    for (int k = 0; k < 3; ++k) {
      prior(6 + k, guess[static_cast<std::size_t>(k)], priors.class_sigma_rad);
    }
    for (int k = 0; k < 4; ++k) {
      prior(9 + k, sides[static_cast<std::size_t>(k)], priors.side_sigma_rad);
    }
    prior(13, guess[kThickness] - priors.thickness_m, priors.thickness_sigma_m);
    for (const Crossing& crossing : cloud.crossings) {
      const CrossingResidual r = ResidualOf(rig.target, priors, crossing, pose, guess,
                                            sides[static_cast<std::size_t>(crossing.side)]);
      Vector j = Vector::Zero();
      j.head<6>() = r.by_target.transpose();
      j[5 + static_cast<int>(crossing.kind)] = -r.per_rad;
      j[9 + crossing.side] = -r.per_rad;
      j[13] = -r.per_thickness;
      h += j * j.transpose() / (r.sigma_m * r.sigma_m);
      g -= r.beyond_m * j / (r.sigma_m * r.sigma_m);
    }
    const Eigen::Matrix3d axes = pose.rotation.toRotationMatrix();
    Eigen::Vector4d x;
    x << axes.col(2), axes.col(2).dot(cloud.centre - pose.translation);
    Eigen::Matrix<double, 4, kUnknowns> j = Eigen::Matrix<double, 4, kUnknowns>::Zero();
    j.block<3, 1>(0, 0) = -axes.col(1);
    j.block<3, 1>(0, 1) = axes.col(0);
    j(3, 0) = -axes.col(1).dot(cloud.centre - pose.translation);
    j(3, 1) = axes.col(0).dot(cloud.centre - pose.translation);
    j(3, 5) = -1;
    const Eigen::Matrix4d information = cloud.scatter / std::pow(cloud.scatter_sigma_m, 2);
    h += j.transpose() * information * j;
    g -= j.transpose() * information * x;
    const Vector step = h.ldlt().solve(g);
    pose = pose * Exp(Vector6d(step.head<6>()));
    for (int k = 0; k < 3; ++k) guess[static_cast<std::size_t>(k)] += step[6 + k];
    for (int k = 0; k < 4; ++k) sides[static_cast<std::size_t>(k)] += step[9 + k];
    guess[kThickness] += step[13];
  }
  const Matrix6d to_lidar = Adjoint(pose);
  return {pose, to_lidar * Matrix6d(h.inverse().topLeftCorner<6, 6>()) * to_lidar.transpose(),
          false};
}

void SolveWorld::MoveCameras(double angle, double distance_m) {
  for (Rigid3& pose : camera_from_lidar) {
    pose = RotationAbout(random_.Direction(), angle) * pose;
    pose.translation += distance_m * random_.Direction();
  }
}

void TurnImage(ImageEdges* image) {
  std::reverse(image->corners.begin(), image->corners.end());
  std::rotate(image->sides.begin(), image->sides.begin() + 2, image->sides.end());
  image->pose->sensor_from_target = image->pose->sensor_from_target * kHalfTurn;
}

SolveSession::SolveSession(const SolveWorld& world, const std::vector<Rigid3>& guesses)
    : rig_(world.rig) {
  for (std::size_t c = 0; c < rig_.cameras.size(); ++c) {
    cameras.push_back({ViewsOf(rig_.cameras[c], world.detections), {}});
    cameras.back().guess.camera_from_lidar = guesses[c];
  }
}

void SolveSession::Divide(std::size_t first_view, const std::vector<Rigid3>& camera_from_lidar) {
  std::vector<GuessedCamera> later = cameras;
  const auto at = static_cast<std::ptrdiff_t>(first_view);
  for (std::size_t c = 0; c < later.size(); ++c) {
    auto& before = cameras[c].views.all;
    before.erase(before.begin() + at, before.end());
    auto& after = later[c].views.all;
    after.erase(after.begin(), after.begin() + at);
    later[c].guess.camera_from_lidar = camera_from_lidar[c];
  }
  cameras.insert(cameras.end(), later.begin(), later.end());
}

JointProblem SolveSession::Joint(double range_offset_sigma_m) const {
  return MakeJointProblem(rig_.target, cameras, range_offset_sigma_m);
}

double Chi2Of(const Rigid3& truth, const Rigid3& estimate, const Matrix6d& covariance) {
  const Vector6d delta = Log(truth * estimate.Inverse());
  return delta.dot(SolveSymmetric(covariance, delta));
}

}  // namespace rgbdt
