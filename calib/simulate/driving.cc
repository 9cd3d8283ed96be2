#include "calib/simulate/driving.h"

#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "calib/model/errors.h"
#include "calib/simulate/internal/camera_renderer.h"
#include "calib/simulate/internal/natural_scene.h"
#include "calib/simulate/internal/rig_defaults.h"
#include "calib/simulate/internal/scanner.h"
#include "calib/simulate/internal/spinning.h"
#include "calib/simulate/internal/ways.h"
#include "calib/simulate/internal/world.h"

namespace rgbdt::simulate {
namespace {

constexpr double kCell = 8;  // [m] after which the street is made anew

Options Checked(Options options) {
  options.natural.on = true;
  options.natural.board = false;
  options.natural.people = 0;
  options.Check();
  if (!options.spinning) throw InputError("simulator: who drives has a spinning LIDAR");
  if (options.scene == Scene::kNight) throw InputError("simulator: nobody drives at night");
  return options;
}

}  // namespace

struct Driving::Impl {
  Impl(const Options& o, double speed_mps, std::vector<ClockOptions> c);

  Rigid3 At(Utime utime) const { return way(ToSeconds(utime - kStart)); }
  const World& WorldAt(Utime utime);

  Options options;
  std::vector<ClockOptions> clocks;
  Way way;
  Rig rig;
  Truth truth;
  std::optional<World> world;
  double world_x = 0;
};

Driving::Impl::Impl(const Options& o, double speed_mps, std::vector<ClockOptions> c)
    : options(Checked(o)),
      clocks(std::move(c)),
      way(options.scene == Scene::kIndoor ? RoomWay(options.seed, speed_mps)
                                          : StreetWay(options.seed, speed_mps)) {
  if (clocks.empty()) clocks.resize(options.cameras.size());
  if (clocks.size() != options.cameras.size()) {
    throw InputError("simulator: " + std::to_string(clocks.size()) + " clocks for " +
                     std::to_string(options.cameras.size()) + " cameras; expected one each");
  }
  std::vector<Rigid3> poses;
  for (const CameraOptions& camera : options.cameras) {
    poses.push_back(DrawCameraFromLidar(camera, options.seed));
    truth.camera_from_lidar[camera.name] = poses.back();
  }
  rig =
      MakeRig(options, Scanner(options.scanner, options.seed), MakeNaturalWorld(options, 0), poses);
}

const World& Driving::Impl::WorldAt(Utime utime) {
  const double x = kCell * std::floor(At(utime).translation.x() / kCell);
  if (!world || (options.scene != Scene::kIndoor && x != world_x)) {
    world_x = x;
    world.emplace(std::make_shared<SceneModel>(MakeNaturalWorld(options, x)), std::nullopt,
                  options);
  }
  return *world;
}

Driving::Driving(const Options& options, double speed_mps, std::vector<ClockOptions> clocks)
    : impl_(std::make_unique<Impl>(options, speed_mps, std::move(clocks))) {}
Driving::~Driving() = default;

const Rig& Driving::rig() const { return impl_->rig; }
const Truth& Driving::truth() const { return impl_->truth; }
Rigid3 Driving::WorldFromLidar(Utime utime) const { return impl_->At(utime); }

Cloud Driving::Sweep(Utime utime) {
  return MovingSweep(
      impl_->WorldAt(utime), *impl_->options.spinning, impl_->options.seed, utime,
      [this](Utime at) { return impl_->At(at); }, impl_->options.threads);
}

Image Driving::TakeImage(const std::string& camera, Utime utime) {
  const CameraSpec& spec = impl_->rig.Camera(camera);
  const auto index = static_cast<std::size_t>(&spec - impl_->rig.cameras.data());
  const World& world = impl_->WorldAt(utime);
  const ClockOptions& clock = impl_->clocks[index];
  const auto camera_from_world = [&](Utime at) {
    return impl_->truth.camera_from_lidar.at(camera) * impl_->At(at).Inverse();
  };
  CameraRenderer renderer(impl_->options.cameras[index], camera_from_world(utime),
                          impl_->options.supersampling, impl_->options.threads);
  if (clock.rolling_s != 0) {
    renderer.Roll([&](int row) {
      return camera_from_world(utime + FromSeconds(clock.RowAfterMiddle(row, spec.height)));
    });
  }
  renderer.RenderEmpty(world);
  renderer.ShowEmpty(world);
  const Utime by_camera = utime - FromSeconds(clock.OffsetAt(ToSeconds(utime - kStart)));
  Image image = renderer.Take(impl_->options.seed, by_camera);
  image.radiometry = spec.radiometry;
  image.frame_number = by_camera / 1000;
  return image;
}

}  // namespace rgbdt::simulate
