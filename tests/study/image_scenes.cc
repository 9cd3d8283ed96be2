#include "tests/study/image_scenes.h"

#include <cmath>
#include <memory>

#include "calib/camera/camera.h"
#include "calib/simulate/internal/noise.h"
#include "calib/simulate/simulator.h"

namespace rgbdt::study {
namespace {

using simulate::CameraOptions;
using simulate::Options;

constexpr Utime kUtime = 1'433'160'013'000'000;
// The empty scene is what costs in a colour image: several views share it.
constexpr int kViewsPerColorScene = 10;
constexpr double kLeastContrast = 6;  // times NETD, as it reaches the camera
constexpr double kMostContrastK = 6;

ImageScene TakeScene(const simulate::Simulator& simulator, const std::string& view) {
  ImageScene made;
  const CameraSpec& spec = simulator.rig().cameras[0];
  made.image = simulator.TakeImage(spec.name, kUtime);
  made.target = simulator.rig().target;
  const Rigid3& lidar_from_target = simulator.truth().lidar_from_target.at(view);
  made.range_m = lidar_from_target.translation.norm();
  const Rigid3 camera_from_target =
      simulator.truth().camera_from_lidar.at(spec.name) * lidar_from_target;
  const Camera camera(spec);
  for (const Eigen::Vector3d& corner : made.target.InnerCorners()) {
    const Eigen::Vector2d outside = Eigen::Vector2d::Constant(-1e6);
    made.corners.push_back(camera.Project(camera_from_target * corner).value_or(outside));
  }
  return made;
}

}  // namespace

std::vector<SceneClass> SceneClasses() {
  constexpr CameraKind kColor = CameraKind::kColor;
  constexpr CameraKind kThermal = CameraKind::kThermal;
  std::vector<SceneClass> classes;
  for (const auto& [name, scene] : simulate::kSceneNames) {
    classes.push_back({"color_" + name, kColor, scene});
  }
  for (const auto& [name, scene] : simulate::kSceneNames) {
    classes.push_back({"thermal_" + name, kThermal, scene});
  }
  for (const char* name : {"inverted", "glow", "border", "hands", "dead", "all"}) {
    SceneClass hard{std::string("thermal_") + name};
    const bool all = hard.name == "thermal_all";
    hard.inverted = all || hard.name == "thermal_inverted";
    hard.glow = all || hard.name == "thermal_glow";
    hard.border = all || hard.name == "thermal_border";
    hard.hands = all || hard.name == "thermal_hands";
    hard.dead = all || hard.name == "thermal_dead";
    classes.push_back(hard);
  }
  return classes;
}

Options SceneOptions(const SceneClass& scene_class, int index, std::uint64_t seed) {
  const simulate::Noise noise(seed, index, scene_class.name);
  Options options;
  options.seed = noise.Bits(0) >> 1;
  options.scene = scene_class.scene;
  options.supersampling = 4;
  const bool thermal = scene_class.kind == CameraKind::kThermal;
  options.cameras = {thermal ? simulate::DefaultThermalCamera() : simulate::DefaultColorCamera()};
  if (!thermal) return options;
  CameraOptions& camera = options.cameras[0];
  // A surface's temperature is seen times emissivity and a little less where it is colder around.
  const double least = 1.1 * kLeastContrast * camera.netd_k;
  const double contrast = least * std::pow(kMostContrastK / least, noise.Uniform(1));
  options.board.black_minus_white_k = scene_class.inverted ? -contrast : contrast;
  if (scene_class.glow) {
    options.board.glow_k = 10 * contrast;
    options.board.glow_radius_m = noise.Uniform(2, 0.2, 0.4);
  }
  if (scene_class.border) {
    if (noise.Uniform(3) < 0.5) {
      options.board.border_to_white = 1;
    } else {
      options.board.border_k = 299;  // about as warm as what is seen behind it outdoors
    }
  }
  if (scene_class.hands) {
    options.holder.hands = noise.Uniform(4) < 0.5 ? 1 : 2;
    options.holder.person = true;
    options.holder.person_aside_m = noise.Uniform(5, -0.8, 0.8);
  }
  if (scene_class.dead) camera.dead_pixels = 20;
  return options;
}

void RenderScenes(const SceneClass& scene_class, int count, std::uint64_t seed,
                  const std::function<void(int, const ImageScene&)>& take) {
  const int views = scene_class.kind == CameraKind::kColor ? kViewsPerColorScene : 1;
  std::unique_ptr<simulate::Simulator> simulator;
  for (int i = 0; i < count; ++i) {
    const Options options = SceneOptions(scene_class, i / views, seed);
    if (i % views == 0) simulator = std::make_unique<simulate::Simulator>(options);
    const std::string view = std::to_string(i);
    simulator->ShowView(i % views, view);
    ImageScene made = TakeScene(*simulator, view);
    made.contrast_k = options.board.black_minus_white_k.value_or(0);
    take(i, made);
  }
}

}  // namespace rgbdt::study
