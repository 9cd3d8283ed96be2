#include "calib/simulate/simulator.h"

#include <optional>
#include <stdexcept>
#include <utility>

#include "calib/model/errors.h"
#include "calib/simulate/internal/board_poses.h"
#include "calib/simulate/internal/camera_renderer.h"
#include "calib/simulate/internal/hidden_outline.h"
#include "calib/simulate/internal/livox.h"
#include "calib/simulate/internal/natural_scene.h"
#include "calib/simulate/internal/noise.h"
#include "calib/simulate/internal/rig_defaults.h"
#include "calib/simulate/internal/scanner.h"
#include "calib/simulate/internal/spinning.h"
#include "calib/simulate/internal/world.h"

namespace rgbdt::simulate {
namespace {

Options Checked(const Options& options) {
  options.Check();
  return options;
}

}  // namespace

struct Simulator::Impl {
  explicit Impl(const Options& o);

  const World& world() const { return view ? *view : empty; }
  CameraRenderer& Camera(const std::string& name);
  void MakeHeat();
  void DriveTo(int index);
  void ShowBoard(int index, const std::string& view_name);

  Options options;
  std::shared_ptr<const SceneModel> scene;
  World empty;
  std::optional<World> view;  ///< with the board; absent before the first view and without a board
  Scanner scanner;
  std::vector<CameraRenderer> cameras;
  Rig rig;
  Truth truth;
};

Simulator::Impl::Impl(const Options& o)
    : options(Checked(o)),
      scene(std::make_shared<SceneModel>(MakeScene(options))),
      empty(scene, std::nullopt, options),
      scanner(options.scanner, options.seed) {
  std::vector<Rigid3> poses;
  for (const CameraOptions& camera : options.cameras) {
    poses.push_back(DrawCameraFromLidar(camera, options.seed));
    truth.camera_from_lidar[camera.name] = poses.back();
    cameras.emplace_back(camera, poses.back(), options.supersampling, options.threads);
  }
  for (const FurtherLidarOptions& lidar : options.further_lidars) {
    truth.reference_from_lidar[lidar.name] = DrawReferenceFromLidar(lidar, options.seed);
  }
  rig = MakeRig(options, scanner, *scene, poses);
}

CameraRenderer& Simulator::Impl::Camera(const std::string& name) {
  for (CameraRenderer& camera : cameras) {
    if (camera.options().name == name) return camera;
  }
  rig.Camera(name);  // throws, naming the cameras that there are
  throw std::logic_error("the rig has a camera that is not simulated: " + name);
}

void Simulator::Impl::MakeHeat() {
  for (const CameraRenderer& camera : cameras) {
    if (camera.options().kind != CameraKind::kThermal) continue;
    view->set_heat(HideOutline(*view, camera.CentreInLidar(), options.board));
    return;
  }
}

Simulator::Simulator(const Options& options) : impl_(new Impl(options)) {}
Simulator::~Simulator() = default;

const Rig& Simulator::rig() const { return impl_->rig; }
const Truth& Simulator::truth() const { return impl_->truth; }

/// Takes the rig to where it stands in a natural scene's view.
void Simulator::Impl::DriveTo(int index) {
  view.reset();
  scene = std::make_shared<SceneModel>(MakeNaturalScene(options, index));
  empty = World(scene, std::nullopt, options);
  for (CameraRenderer& camera : cameras) {
    camera.RenderEmpty(empty);
    camera.ShowEmpty(empty);
  }
}

void Simulator::Impl::ShowBoard(int index, const std::string& view_name) {
  const Rigid3 pose = BoardPose(options, empty, scanner, cameras, index);
  const HeatMap heat = DrawHeat(options.board, scene->board_heat, options.seed, index);
  view.emplace(scene, Board(options.board, pose, heat), options);
  MakeHeat();
  for (CameraRenderer& camera : cameras) {
    if (!camera.has_empty()) camera.RenderEmpty(empty);
    camera.Render(*view);
  }
  truth.lidar_from_target[view_name] = pose;
}

void Simulator::ShowView(int index, const std::string& view_name) {
  if (index < 0) {
    throw InputError("simulator: view index is " + std::to_string(index) + "; expected 0 or more");
  }
  impl_->scanner.SweepBack(index % 2 == 1);
  const NaturalOptions& natural = impl_->options.natural;
  if (natural.on) {
    impl_->DriveTo(index);
    impl_->truth.world_from_lidar[view_name] = *impl_->scene->world_from_lidar;
  }
  if (!natural.on || natural.board) impl_->ShowBoard(index, view_name);
}

int Simulator::sweep_lines() const { return impl_->scanner.sweep_lines(); }
Utime Simulator::line_period() const { return impl_->scanner.line_period(); }

LineScan Simulator::Line(Utime sweep_utime, int line) const {
  if (line < 0 || line >= sweep_lines()) {
    throw InputError("simulator: line is " + std::to_string(line) + "; expected 0 to " +
                     std::to_string(sweep_lines() - 1));
  }
  return impl_->scanner.Line(impl_->world(), sweep_utime, line);
}

LineScan Simulator::LineAt(Utime utime,
                           const std::function<double(double seconds)>& motor_angle) const {
  return impl_->scanner.LineAt(impl_->world(), utime, motor_angle);
}

Cloud Simulator::Revolution(Utime utime) const {
  const Options& o = impl_->options;
  if (o.turned()) throw InputError("simulator: the rig has a turned scanner; call Line");
  if (o.livox) return LivoxCloud(impl_->world(), *o.livox, o.seed, utime, o.threads);
  return SpinningSweep(impl_->world(), *o.spinning, o.seed, utime, o.threads);
}

std::vector<LidarCloud> Simulator::FurtherRevolutions(Utime utime) const {
  const Options& o = impl_->options;
  std::vector<LidarCloud> clouds;
  for (std::size_t i = 0; i < o.further_lidars.size(); ++i) {
    const FurtherLidarOptions& lidar = o.further_lidars[i];
    clouds.push_back(
        {lidar.name, SpinningSweep(impl_->world(), lidar.spinning, SeedOfLidar(o.seed, i), utime,
                                   o.threads, impl_->truth.reference_from_lidar.at(lidar.name))});
  }
  return clouds;
}

EncoderReading Simulator::Encoder(Utime utime, Utime sweep_utime) const {
  EncoderReading reading;
  reading.utime = utime;
  reading.sweep_utime = sweep_utime;
  const double late = impl_->options.scanner.encoder_delay_s;
  const double seconds = sweep_utime == 0 ? 0 : ToSeconds(utime - sweep_utime) - late;
  reading.ticks = impl_->scanner.Ticks(impl_->scanner.MotorAngle(seconds));
  return reading;
}

Image Simulator::TakeImage(const std::string& camera, Utime utime) const {
  CameraRenderer& renderer = impl_->Camera(camera);
  if (!renderer.has_empty()) {  // no view was shown yet
    renderer.RenderEmpty(impl_->empty);
    renderer.ShowEmpty(impl_->empty);
  }
  Image image = renderer.Take(impl_->options.seed, utime);
  image.radiometry = impl_->rig.Camera(camera).radiometry;
  // A count that a restarted simulator repeats: milliseconds of simulated time.
  image.frame_number = utime / 1000;
  return image;
}

CornerSelection Simulator::PickCorners(const std::string& camera, Utime image_utime) const {
  const CameraRenderer& renderer = impl_->Camera(camera);
  const NaturalOptions& natural = impl_->options.natural;
  if (natural.on && !natural.board) {
    throw InputError("simulator: the scene has no board to pick corners of; set natural.board");
  }
  if (!impl_->view) {
    throw InputError("simulator: no board to pick corners of; call ShowView first");
  }
  CornerSelection selection;
  selection.camera = camera;
  selection.utime = image_utime;
  selection.image_utime = image_utime;
  const Noise noise(impl_->options.seed, image_utime, camera + " picks");
  const Rigid3 camera_from_target =
      renderer.camera_from_lidar() * impl_->view->board()->lidar_from_target();
  const auto corners = impl_->rig.target.OutlineCorners();
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const auto pixel = renderer.lens().Project(camera_from_target * corners[i]);
    if (!pixel) throw InputError("simulator: " + camera + " does not see the board");
    selection.corners[i] =
        *pixel + impl_->options.pick_sigma_px *
                     Eigen::Vector2d(noise.Normal(2 * i), noise.Normal(2 * i + 1));
  }
  return selection;
}

}  // namespace rgbdt::simulate
