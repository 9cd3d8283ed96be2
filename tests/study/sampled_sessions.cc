#include "tests/study/sampled_sessions.h"

#include <cmath>
#include <cstdio>
#include <memory>

#include "calib/detect/cloud/board_in_cloud.h"
#include "calib/model/beam_priors.h"
#include "calib/model/errors.h"
#include "calib/simulate/internal/board_poses.h"
#include "calib/simulate/internal/rig_defaults.h"
#include "calib/simulate/internal/scene.h"
#include "tests/numbers.h"
#include "tests/study/sampled_images.h"

namespace rgbdt::study {
namespace {

using simulate::Noise;

simulate::Options OptionsOf(const SampledOptions& sampled, std::uint64_t seed) {
  simulate::Options options;
  options.seed = seed;
  options.scene = static_cast<simulate::Scene>(seed % 3);
  options.threads = 1;
  simulate::UseLidar(sampled.rings, &options);
  for (const int rings : sampled.further_rings) simulate::AddLidar(rings, &options);
  return options;
}

BeamModel ModelOf(const SampledOptions& sampled, const simulate::Options& options) {
  BeamModel model;
  if (sampled.range_offset_m > 0) {
    const Noise noise(options.seed, 0, "sampled range offset");
    model.range_offset_m = sampled.range_offset_m * (2 * noise.Uniform(0) - 1);
    model.range_offset_sigma_m = kUsualRangeOffsetSigmaM;
  }
  if (sampled.physics) DrawBeamPhysics(sampled.rings, options.seed, &model);
  model.range_sigma_m =
      options.spinning ? options.spinning->range_sigma_m : options.scanner.range_sigma_m;
  model.thickness_m = options.board.thickness_m;
  return model;
}

// A LIDAR beside the rig's own: its noise model, and where it is.
struct FurtherLidar {
  simulate::Options options;  // whose own LIDAR it is
  BeamModel model;
  ClassShifts shifts{};
  Rigid3 reference_from_lidar;
};

FurtherLidar MakeFurtherLidar(SampledOptions sampled, const simulate::Options& rig,
                              std::size_t index) {
  const simulate::FurtherLidarOptions& lidar = rig.further_lidars[index];
  FurtherLidar further;
  further.options = rig;
  further.options.seed = simulate::SeedOfLidar(rig.seed, index);
  further.options.spinning = lidar.spinning;
  further.options.livox.reset();
  sampled.rings = lidar.spinning.rings();
  further.model = ModelOf(sampled, further.options);
  further.shifts =
      DrawClassShifts(further.model, Noise(further.options.seed, 0, "sampled classes"));
  further.reference_from_lidar = simulate::DrawReferenceFromLidar(lidar, rig.seed);
  return further;
}

// The lens as a rig file might have it.
CameraSpec WithLensOff(CameraSpec camera, std::uint64_t seed) {
  const Noise noise(seed, 0, "lens of " + camera.name);
  camera.lens_uncertainty = LensOff(camera.lens);
  LensNumbers numbers = NumbersOf(camera.lens);
  for (Eigen::Index i = 0; i < numbers.size(); ++i) {
    numbers[i] += std::sqrt(camera.lens_uncertainty->covariance(i, i)) *
                  noise.Normal(static_cast<std::uint64_t>(i));
  }
  camera.lens = WithNumbers(camera.lens, numbers);
  return camera;
}

class SessionSampler {
 public:
  SessionSampler(const SampledOptions& sampled, std::uint64_t seed)
      : sampled_(sampled),
        options_(OptionsOf(sampled, seed)),
        scene_(std::make_shared<simulate::SceneModel>(MakeScene(options_))),
        empty_(scene_, std::nullopt, options_),
        scanner_(options_.scanner, seed) {
    session_.model = ModelOf(sampled_, options_);
    shifts_ = DrawClassShifts(session_.model, Noise(seed, 0, "sampled classes"));
    std::vector<Rigid3> mounts;
    for (const simulate::CameraOptions& camera : options_.cameras) {
      mounts.push_back(DrawCameraFromLidar(camera, seed));
      session_.truth.camera_from_lidar[camera.name] = mounts.back();
      renderers_.emplace_back(camera, mounts.back(), options_.supersampling, 1);
    }
    session_.rig = MakeRig(options_, scanner_, *scene_, mounts);
    session_.rig.lidar.range_offset_sigma_m = session_.model.range_offset_sigma_m;
    for (std::size_t i = 0; i < options_.further_lidars.size(); ++i) AddFurther(i);
    session_.true_cameras = session_.rig.cameras;
    session_.rig.target.print_sigma = sampled.print_sigma;
    session_.true_board = session_.rig.target;
    const Noise print(seed, 0, "print");
    session_.true_board.target.print_scale +=
        sampled.print_sigma * Eigen::Vector2d(print.Normal(0), print.Normal(1));
    if (sampled.print_sigma > 0) {
      session_.true_board.bow_m =
          kBowSigmaM * Eigen::Vector3d(print.Normal(2), print.Normal(3), print.Normal(4));
    }
    const double outline = session_.model.outline_sigma_m;
    for (std::size_t side = 0; side < 4; ++side) {
      session_.true_board.beyond_m[side] = outline * print.Normal(5 + side);
    }
    if (sampled.lenses_off) {
      for (CameraSpec& camera : session_.rig.cameras) camera = WithLensOff(camera, seed);
    }
  }

  SampledSession Run() {
    const int wanted = sampled_.views + sampled_.heldout;
    for (int pose = 0; static_cast<int>(session_.views.size()) < wanted; ++pose) {
      if (pose > 3 * wanted + 10) throw InputError("study: the board is not found");
      AddView(pose);
    }
    return std::move(session_);
  }

 private:
  void AddFurther(std::size_t index) {
    further_.push_back(MakeFurtherLidar(sampled_, options_, index));
    LidarSpec& lidar = session_.rig.further_lidars[index];
    lidar.range_offset_sigma_m = further_.back().model.range_offset_sigma_m;
    session_.truth.reference_from_lidar[lidar.name] = further_.back().reference_from_lidar;
  }

  CloudDetection LookAtCloud(const FurtherLidar& lidar, const LidarSpec& spec,
                             const Rigid3& reference_from_target, int pose) const {
    const SampledCloud cloud =
        SampleCloud(lidar.options, session_.true_board,
                    lidar.reference_from_lidar.Inverse() * reference_from_target, lidar.model,
                    lidar.shifts, Noise(lidar.options.seed, pose + 1, "sampled cloud"));
    BoardInCloudOptions detector;
    detector.range_sigma_m = spec.range_sigma_m;
    BoardsInCloud boards = FindBoards(cloud.cloud, session_.rig.target, detector);
    CloudDetection detection;
    detection.why_not = boards.candidates.empty() ? boards.why : "";
    detection.candidates = std::move(boards.candidates);
    return detection;
  }

  // Nothing, where no board is found in the cloud; it has not happened.
  void AddView(int pose) {
    const int index = static_cast<int>(session_.views.size());
    SampledView view;
    view.name = ViewName(index);
    view.heldout = IsHeldOut(index, sampled_.views, sampled_.heldout);
    view.lidar_from_target = BoardPose(options_, empty_, scanner_, renderers_, pose);
    SampledCloud cloud =
        SampleCloud(options_, session_.true_board, view.lidar_from_target, session_.model, shifts_,
                    Noise(options_.seed, pose + 1, "sampled cloud"));
    view.beams = std::move(cloud.beams);
    view.behind = cloud.behind;
    BoardsInCloud boards =
        FindBoards(cloud.cloud, session_.rig.target, OptionsFor(session_.rig.lidar));
    if (boards.candidates.empty()) return;
    view.cloud = std::move(cloud.cloud);
    ViewDetection detection;
    detection.view = view.name;
    detection.heldout = view.heldout;
    detection.sweep_utime = kJune2015 + pose;
    detection.cloud.candidates = std::move(boards.candidates);
    for (std::size_t c = 0; c < session_.rig.cameras.size(); ++c) {
      detection.images.push_back(
          LookAtImage(session_.true_cameras[c], session_.rig.cameras[c].lens, view, pose));
    }
    for (std::size_t i = 0; i < further_.size(); ++i) {
      const LidarSpec& spec = session_.rig.further_lidars[i];
      detection.further_clouds.push_back(
          {spec.name, LookAtCloud(further_[i], spec, view.lidar_from_target, pose)});
    }
    session_.detections.push_back(std::move(detection));
    session_.truth.lidar_from_target[view.name] = view.lidar_from_target;
    session_.views.push_back(std::move(view));
  }

  ImageDetection LookAtImage(const CameraSpec& camera, const Lens& given, const SampledView& view,
                             int pose) const {
    ImageDetection detection;
    detection.camera = camera.name;
    detection.utime = kJune2015 + pose;
    const Noise noise(options_.seed, pose + 1, "sampled " + camera.name);
    detection.edges = SampledEdges(
        camera, given, session_.true_board,
        session_.truth.camera_from_lidar.at(camera.name) * view.lidar_from_target, noise);
    if (!detection.edges) detection.why_not = "no pose from the corners";
    return detection;
  }

  SampledOptions sampled_;
  simulate::Options options_;
  std::shared_ptr<const simulate::SceneModel> scene_;
  simulate::World empty_;
  simulate::Scanner scanner_;
  std::vector<simulate::CameraRenderer> renderers_;  // only to ask what lies in an image
  ClassShifts shifts_{};
  std::vector<FurtherLidar> further_;
  SampledSession session_;
};

}  // namespace

void DrawBeamPhysics(int rings, std::uint64_t seed, BeamModel* model) {
  const Noise noise(seed, 0, "sampled physics");
  model->range_offset_sigma_m = kUsualRangeOffsetSigmaM;
  model->range_offset_m = model->range_offset_sigma_m * noise.Normal(0);
  model->dark_range_m = noise.Uniform(1, 0, 0.02);
  model->dark_range_sigma_m = 0.02;
  model->class_sigma_rad = noise.Uniform(2, 0.6e-3, 1.5e-3);
  model->class_prior_rad = 1.5e-3;
  model->outline_sigma_m = kOutlineSigmaM;
  if (rings == 0) return;
  model->beams_meet_m = noise.Uniform(3, 0, 0.045);
  model->beams_meet_sigma_m = 0.04;
  model->ring_offset_sigma_m = 0.015;
  const double sigma_m = noise.Uniform(4, 0.003, 0.010);
  for (int ring = 0; ring < rings; ++ring) {
    model->ring_offset_m.push_back(sigma_m * noise.Normal(5 + static_cast<std::uint64_t>(ring)));
  }
}

LensUncertainty LensOff(const Lens& lens) {
  LensNumbers sigma;
  sigma << 0.004 * lens.fx, 0.004 * lens.fy, 6, 6, 0.02, 0, 0, 0, 0;
  LensUncertainty off;
  off.covariance.diagonal() = sigma.cwiseAbs2();
  return off;
}

std::string ViewName(int index) {
  char name[16];
  std::snprintf(name, sizeof(name), "%04d", index + 1);
  return name;
}

bool IsHeldOut(int index, int views, int heldout) {
  const int all = views + heldout;
  return (index + 1) * heldout / all > index * heldout / all;
}

std::optional<SampledSession> SampleSession(const SampledOptions& options, std::uint64_t seed) {
  try {
    return SessionSampler(options, seed).Run();
  } catch (const InputError&) {
    return std::nullopt;
  }
}

}  // namespace rgbdt::study
