#include "calib/simulate/waving.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "calib/model/errors.h"
#include "calib/model/parallel.h"
#include "calib/simulate/internal/beam.h"
#include "calib/simulate/internal/camera_renderer.h"
#include "calib/simulate/internal/dice.h"
#include "calib/simulate/internal/option_checks.h"
#include "calib/simulate/internal/rig_defaults.h"
#include "calib/simulate/internal/scanner.h"
#include "calib/simulate/internal/spinning.h"
#include "calib/simulate/internal/world.h"

namespace rgbdt::simulate {
namespace {

/// Rows that are taken to be exposed at once: the board moves by hundredths of a pixel in between.
constexpr int kBandRows = 16;

/// Where the board's sheet is met on a ray of the target's frame [m]; infinite: nowhere.
double MeetSheet(const BoardOptions& board, const Eigen::Vector3d& origin,
                 const Eigen::Vector3d& direction) {
  const double range = -origin.z() / direction.z();
  const Eigen::Vector3d place = origin + range * direction;
  const bool met = range > 0 && std::abs(place.x()) <= 0.5 * board.width_m &&
                   std::abs(place.y()) <= 0.5 * board.height_m;
  return met ? range : std::numeric_limits<double>::infinity();
}

}  // namespace

void WaveOptions::Check() const {
  kCheck.Between(range_m, 0.5, 30, "wave.range_m");
  kCheck.Between(height_m, -10, 10, "wave.height_m");
  kCheck.Between(reach_m.minCoeff(), 0, 10, "least of wave.reach_m");
  kCheck.Between(reach_m.x(), 0, range_m - 0.2, "wave.reach_m along x");
  kCheck.Between(turn_rad.minCoeff(), 0, 1.2, "least of wave.turn_rad");
  kCheck.Between(turn_rad.maxCoeff(), 0, 1.2, "most of wave.turn_rad");
  kCheck.Between(rig_turn_rad.minCoeff(), 0, 0.5, "least of wave.rig_turn_rad");
  kCheck.Between(rig_turn_rad.maxCoeff(), 0, 0.5, "most of wave.rig_turn_rad");
  kCheck.Between(slowest_hz, 0.01, 10, "wave.slowest_hz");
  kCheck.Between(fastest_hz, slowest_hz, 10, "wave.fastest_hz");
}

struct Waving::Impl {
  /// One axis of a motion: two waves, whose amplitudes add up to 1.
  struct Swing {
    double share[2], rate[2], phase[2];

    double At(double seconds) const {
      return share[0] * std::sin(rate[0] * seconds + phase[0]) +
             share[1] * std::sin(rate[1] * seconds + phase[1]);
    }
  };

  Impl(const Options& o, const WaveOptions& w, std::vector<ClockOptions> c);

  static Swing DrawSwing(const WaveOptions& wave, Dice* draw);
  std::size_t IndexOf(const std::string& name) const;
  Rigid3 At(double seconds) const;
  Rigid3 At(Utime utime) const { return At(ToSeconds(utime - wave.start)); }
  /// What a ring's beams meet in the revolution that begins at `utime`.
  std::vector<BeamReturn> CastRing(const Ring& ring, Utime utime) const;
  /// What a beam meets of the scene and of the board where it is at that time.
  BeamReturn Cast(const Eigen::Vector3d& origin, const std::vector<Eigen::Vector3d>& rays,
                  const Rigid3& lidar_from_target) const;

  Options options;
  WaveOptions wave;
  std::vector<ClockOptions> clocks;
  std::shared_ptr<const SceneModel> scene;
  World empty;
  HeatMap heat;
  Board at_origin;  ///< for its pattern
  std::vector<CameraRenderer> cameras;
  std::vector<Swing> swings;  ///< along x, y, z; about x, y, z; the rig's about x, y, z
  std::vector<std::vector<BeamReturn>> still;  ///< by ring: of the scene alone
  Rig rig;
  Truth truth;
};

Waving::Impl::Impl(const Options& o, const WaveOptions& w, std::vector<ClockOptions> c)
    : options(o),
      wave(w),
      clocks(std::move(c)),
      scene(std::make_shared<SceneModel>(MakeScene(options))),
      empty(scene, std::nullopt, options),
      heat(DrawHeat(options.board, scene->board_heat, options.seed, 0)),
      at_origin(options.board, {}, heat) {
  Dice draw(options.seed, 0, "waving");
  for (int axis = 0; axis < 9; ++axis) swings.push_back(DrawSwing(wave, &draw));
  std::vector<Rigid3> poses;
  for (const CameraOptions& camera : options.cameras) {
    poses.push_back(DrawCameraFromLidar(camera, options.seed));
    truth.camera_from_lidar[camera.name] = poses.back();
    cameras.emplace_back(camera, poses.back(), options.supersampling, options.threads);
  }
  still.resize(static_cast<std::size_t>(options.spinning->rings()));
  ForEach(options.spinning->rings(), options.threads, [&](int index) {
    still[static_cast<std::size_t>(index)] =
        CastStanding(empty, *options.spinning, Ring(*options.spinning, index));
  });
  rig = MakeRig(options, Scanner(options.scanner, options.seed), *scene, poses);
}

Waving::Impl::Swing Waving::Impl::DrawSwing(const WaveOptions& wave, Dice* draw) {
  Swing swing{};
  const double middle = std::sqrt(wave.slowest_hz * wave.fastest_hz);
  swing.share[0] = draw->Between(0.5, 0.7);
  swing.share[1] = 1 - swing.share[0];
  swing.rate[0] = 2 * M_PI * draw->Between(wave.slowest_hz, middle);
  swing.rate[1] = 2 * M_PI * draw->Between(middle, wave.fastest_hz);
  for (double& phase : swing.phase) phase = draw->Between(0, 2 * M_PI);
  return swing;
}

std::size_t Waving::Impl::IndexOf(const std::string& name) const {
  rig.Camera(name);  // throws, naming the cameras that there are
  std::size_t index = 0;
  while (cameras[index].options().name != name) ++index;
  return index;
}

Rigid3 Waving::Impl::At(double seconds) const {
  const auto moved = [&](const Eigen::Vector3d& most, std::size_t first) {
    Eigen::Vector3d by;
    for (int axis = 0; axis < 3; ++axis) {
      by[axis] = most[axis] * swings[first + static_cast<std::size_t>(axis)].At(seconds);
    }
    return by;
  };
  const auto turned = [](const Eigen::Vector3d& about) {
    return RotationAbout(Eigen::Vector3d::UnitZ(), about.z()) *
           RotationAbout(Eigen::Vector3d::UnitY(), about.y()) *
           RotationAbout(Eigen::Vector3d::UnitX(), about.x());
  };
  Rigid3 pose = turned(moved(wave.turn_rad, 3));
  Eigen::Matrix3d facing;  // the target's x to the right, y down, z away
  facing << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  pose.rotation = pose.rotation * Eigen::Quaterniond(facing);
  pose.translation = Eigen::Vector3d(wave.range_m, 0, wave.height_m) + moved(wave.reach_m, 0);
  return turned(moved(wave.rig_turn_rad, 6)).Inverse() * pose;
}

std::vector<BeamReturn> Waving::Impl::CastRing(const Ring& ring, Utime utime) const {
  // Of the board's whole way, seen from the LIDAR, no beam beyond this angle meets it.
  const double aside = wave.reach_m.tail<2>().norm() + std::abs(wave.height_m) +
                       0.5 * std::hypot(options.board.width_m, options.board.height_m);
  const double widest = std::atan2(aside, std::max(0.1, wave.range_m - wave.reach_m.x() - 0.7)) +
                        wave.rig_turn_rad.sum();
  const double least_x = std::cos(widest + 0.1);
  std::vector<BeamReturn> returns = still[static_cast<std::size_t>(ring.index())];
  for (int column = 0; column < ring.columns(); ++column) {
    if (ring.Direction(column).x() < least_x) continue;
    returns[static_cast<std::size_t>(column)] =
        Cast(ring.start(), ring.SubRays(column), At(utime + ring.FiredAfter(column)));
  }
  return returns;
}

BeamReturn Waving::Impl::Cast(const Eigen::Vector3d& origin,
                              const std::vector<Eigen::Vector3d>& rays,
                              const Rigid3& lidar_from_target) const {
  thread_local std::vector<Hit> hits;
  hits.resize(rays.size());
  empty.caster().CastFan(origin, rays.data(), static_cast<int>(rays.size()), hits.data());
  const Rigid3 target_from_lidar = lidar_from_target.Inverse();
  const Eigen::Vector3d from = target_from_lidar * origin;
  std::vector<SubReturn> met;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Eigen::Vector3d along = target_from_lidar.rotation * rays[i];
    const double board = MeetSheet(options.board, from, along);
    const double range = std::min(board, hits[i].range);
    if (!(range <= options.spinning->max_range_m)) continue;
    met.push_back({range, range == board ? at_origin.Reflectivity(from + range * along)
                                         : empty.Reflectivity(hits[i], origin + range * rays[i])});
  }
  return CombineReturns(*options.spinning, static_cast<int>(rays.size()), &met);
}

Waving::Waving(const Options& options, const WaveOptions& wave, std::vector<ClockOptions> clocks) {
  options.Check();
  wave.Check();
  if (!options.spinning) throw InputError("simulator: a board is waved before a spinning LIDAR");
  if (clocks.size() != options.cameras.size()) {
    throw InputError("simulator: " + std::to_string(clocks.size()) + " clocks for " +
                     std::to_string(options.cameras.size()) + " cameras; expected one each");
  }
  impl_ = std::make_unique<Impl>(options, wave, std::move(clocks));
}

Waving::~Waving() = default;

const Rig& Waving::rig() const { return impl_->rig; }
const Truth& Waving::truth() const { return impl_->truth; }
Rigid3 Waving::LidarFromTarget(Utime utime) const { return impl_->At(utime); }

Cloud Waving::Sweep(Utime utime) const {
  const Options& options = impl_->options;
  return SpinningSweep(*options.spinning, options.seed, utime, options.threads,
                       [&](const Ring& ring) { return impl_->CastRing(ring, utime); });
}

Image Waving::TakeImage(const std::string& camera, Utime utime) {
  const std::size_t index = impl_->IndexOf(camera);
  CameraRenderer& renderer = impl_->cameras[index];
  const ClockOptions& clock = impl_->clocks[index];
  const int height = renderer.options().height;
  const int count = clock.rolling_s == 0 ? 1 : (height + kBandRows - 1) / kBandRows;
  std::vector<World> worlds;
  worlds.reserve(static_cast<std::size_t>(count));
  for (int band = 0; band < count; ++band) {
    const double row = (band + 0.5) * height / count - 0.5;  // the band's middle
    const double seconds = ToSeconds(utime - impl_->wave.start) + clock.RowAfterMiddle(row, height);
    worlds.emplace_back(impl_->scene, Board(impl_->options.board, impl_->At(seconds), impl_->heat),
                        impl_->options);
  }
  std::vector<const World*> bands;
  bands.reserve(worlds.size());
  for (const World& world : worlds) bands.push_back(&world);
  if (!renderer.has_empty()) renderer.RenderEmpty(impl_->empty);
  renderer.RenderBands(bands);
  Image image = renderer.Take(impl_->options.seed, CameraUtime(camera, utime));
  image.radiometry = impl_->rig.Camera(camera).radiometry;
  image.frame_number = image.utime / 1000;
  return image;
}

std::vector<Eigen::Vector2d> Waving::Corners(const std::string& camera, Utime utime) const {
  const std::size_t index = impl_->IndexOf(camera);
  const CameraRenderer& renderer = impl_->cameras[index];
  const CameraOptions& options = renderer.options();
  const ClockOptions& clock = impl_->clocks[index];
  const double seconds = ToSeconds(utime - impl_->wave.start);
  std::vector<Eigen::Vector2d> corners;
  for (const Eigen::Vector3d& corner : impl_->rig.target.InnerCorners()) {
    // A corner is seen by the row that it is on at the row's time: a few rounds find it.
    std::optional<Eigen::Vector2d> pixel;
    double row = 0.5 * (options.height - 1);
    for (int round = 0; round < 5; ++round) {
      const double later = clock.RowAfterMiddle(row, options.height);
      pixel = renderer.lens().Project(renderer.camera_from_lidar() *
                                      (impl_->At(seconds + later) * corner));
      if (!pixel) return {};
      row = pixel->y();
    }
    const bool inside = pixel->x() >= 0 && pixel->y() >= 0 && pixel->x() <= options.width - 1 &&
                        pixel->y() <= options.height - 1;
    if (!inside) return {};
    corners.push_back(*pixel);
  }
  return corners;
}

Utime Waving::CameraUtime(const std::string& camera, Utime utime) const {
  const ClockOptions& clock = impl_->clocks[impl_->IndexOf(camera)];
  return utime - FromSeconds(clock.OffsetAt(ToSeconds(utime - impl_->wave.start)));
}

}  // namespace rgbdt::simulate
