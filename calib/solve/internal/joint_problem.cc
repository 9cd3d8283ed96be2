#include "calib/solve/internal/joint_problem.h"

#include <algorithm>
#include <utility>

#include "calib/model/beam_priors.h"
#include "calib/model/linear_algebra.h"
#include "calib/solve/first_guess.h"

namespace rgbdt {
namespace {

void TurnCloud(CloudEdges* cloud) {
  cloud->pose->sensor_from_target = cloud->pose->sensor_from_target * kHalfTurn;
  for (Crossing& crossing : cloud->crossings) crossing.side = (crossing.side + 2) % 4;
}

// What is known of a lens besides these views. Where it was made from some of their images, these
// tell it again: of the share s of its images that come again, the square of 1 - s is left of its
// information. With 1 - s the images that come again would still be in its mean: the variance would
// come out up to a fifth too small; with the square it is a twelfth.
LensCovariance LensPrior(const CameraSpec& spec, const std::vector<const CameraView*>& used) {
  // Two detections of one image differ by hundredths of a pixel, two images by more than this.
  constexpr double kSamePx = 0.25;
  const LensUncertainty stated = spec.LensUncertaintyOrUsual();
  const auto shared = std::count_if(used.begin(), used.end(), [&](const CameraView* view) {
    const Eigen::Vector2d middle = MiddleOf(view->image->corners);
    return std::any_of(stated.made_from.begin(), stated.made_from.end(),
                       [&](const auto& other) { return (other - middle).norm() < kSamePx; });
  });
  if (shared == 0 || stated.exact()) return stated.covariance;
  const double left =
      1 - std::min(1.0, static_cast<double>(shared) / static_cast<double>(stated.made_from.size()));
  const LensCovariance usual = UsualLensUncertainty(spec.lens, spec.width, spec.height).covariance;
  // (left^2 stated^-1 + usual^-1)^-1, also where the stated one is singular.
  const LensCovariance both = stated.covariance + left * left * usual;
  const LensCovariance left_of_it = usual * SolveSymmetric(both, stated.covariance);
  return 0.5 * (left_of_it + left_of_it.transpose());
}

// Whether the LIDAR spins: its clouds tell lasers apart.
bool HasRings(const BoardProblem& problem) {
  return std::any_of(problem.views.begin(), problem.views.end(), [](const BoardView& view) {
    const auto& groups = view.cloud.groups;
    return std::any_of(groups.begin(), groups.end(),
                       [](const PointGroup& group) { return group.ring >= 0; });
  });
}

// Builds the problem a camera at a time, in the order of the cameras.
class Builder {
 public:
  explicit Builder(const Target& target) {
    joint_.problem.target = target;
    joint_.problem.priors = PriorsOf(target);
  }

  void Add(GuessedCamera guessed) {
    const int index = static_cast<int>(joint_.cameras.size());
    joint_.problem.lens_of.push_back(FirstOfName(guessed.views.spec->name));
    GuessedCamera& camera = joint_.cameras.emplace_back(std::move(guessed));
    joint_.problem.cameras.emplace_back(*camera.views.spec);
    for (CameraView& o : camera.views.all) {
      if (o.usable() && !o.heldout) AddImage(index, &o);
    }
  }

  JointProblem Finish(double range_offset_sigma_m) {
    BoardProblem& problem = joint_.problem;
    AddLensPriors();
    const bool offset = OpenRanges(range_offset_sigma_m, &problem);
    std::vector<Rigid3> poses;
    for (const GuessedCamera& c : joint_.cameras) poses.push_back(*c.guess.camera_from_lidar);
    joint_.start = StartOf(problem, poses);
    joint_.start.shared[kRangeOffset] = offset ? joint_.cameras.front().guess.range_offset_m : 0;
    return std::move(joint_);
  }

 private:
  // The camera of this name that came first; the next one, where there is none yet.
  std::size_t FirstOfName(const std::string& name) const {
    const auto first =
        std::find_if(joint_.cameras.begin(), joint_.cameras.end(),
                     [&](const GuessedCamera& camera) { return camera.views.spec->name == name; });
    return static_cast<std::size_t>(first - joint_.cameras.begin());
  }

  void AddLensPriors() {
    const std::size_t count = joint_.cameras.size();
    for (std::size_t c = 0; c < count; ++c) {
      const std::size_t lens = joint_.problem.LensOf(c);
      std::vector<const CameraView*> used;
      for (std::size_t other = lens; other < count; ++other) {
        if (joint_.problem.LensOf(other) != lens) continue;
        const auto own = joint_.cameras[other].views.Used();
        used.insert(used.end(), own.begin(), own.end());
      }
      joint_.problem.lens_priors.push_back(LensPrior(*joint_.cameras[c].views.spec, used));
    }
  }

  void AddImage(int camera, CameraView* o) {
    const Rigid3& camera_from_lidar =
        *joint_.cameras[static_cast<std::size_t>(camera)].guess.camera_from_lidar;
    const Rigid3 lidar_from_image_target =
        camera_from_lidar.Inverse() * o->image->pose->sensor_from_target;
    auto view = std::find_if(joint_.problem.views.begin(), joint_.problem.views.end(),
                             [&](const BoardView& v) { return v.name == o->view; });
    if (view == joint_.problem.views.end()) {
      BoardView& fresh = joint_.problem.views.emplace_back();
      fresh.name = o->view;
      fresh.cloud = *o->cloud;
      if (HalfTurned(lidar_from_image_target, *fresh.cloud.pose)) TurnCloud(&fresh.cloud);
      fresh.cloud.pose->half_turn_known = o->image->pose->half_turn_known;
      fresh.images.push_back({camera, o->image, false});
      return;
    }
    if ((view->cloud.centre - o->cloud->centre).norm() > 0.01) {
      o->Reject("takes another board of the cloud than the cameras before it");
      return;
    }
    const bool turned = HalfTurned(lidar_from_image_target, *view->cloud.pose);
    view->images.push_back({camera, o->image, turned});
    if (!turned || !o->image->pose->half_turn_known || view->cloud.pose->half_turn_known) return;
    // This camera knows which end is up, those before it did not.
    TurnCloud(&view->cloud);
    view->cloud.pose->half_turn_known = true;
    for (BoardImage& image : view->images) image.turned = !image.turned;
  }

  JointProblem joint_;
};

}  // namespace

BoardPriors PriorsOf(const Target& target) {
  BoardPriors priors;
  priors.print_sigma = std::max(kNoPrintSigma, target.print_sigma);
  if (target.HasPattern() && target.print_sigma > 0) priors.bow_sigma_m = kBowSigmaM;
  if (target.WhiteToTheRim()) {
    priors.class_sigma_rad = kSharedPlainClassShiftSigmaRad;
    priors.fringe_sigma_m = kPlainFringeSigmaM;
  }
  return priors;
}

bool OpenRanges(double range_offset_sigma_m, BoardProblem* problem) {
  problem->ranges_exact = range_offset_sigma_m == 0;
  // A plain board's rim, which images show beside its front, leans it there as an offset of the
  // ranges would: such boards are no evidence of one, unless nothing is to be known of it.
  const bool offset = range_offset_sigma_m > 0 &&
                      (problem->PatternIsSeen() || range_offset_sigma_m >= kRangeOffsetSigmaM);
  if (!problem->ranges_exact) OpenBeams(problem);
  if (offset) problem->priors.range_offset_sigma_m = range_offset_sigma_m;
  return offset;
}

void OpenBeams(BoardProblem* problem) {
  if (HasRings(*problem)) problem->priors.beams_meet_sigma_m = kBeamsMeetSigmaM;
}

JointProblem MakeJointProblem(const Target& target, std::vector<GuessedCamera> cameras,
                              double range_offset_sigma_m) {
  Builder builder(target);
  for (GuessedCamera& camera : cameras) builder.Add(std::move(camera));
  return builder.Finish(range_offset_sigma_m);
}

}  // namespace rgbdt
