#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "calib/model/rig.h"
#include "calib/model/view_detection.h"
#include "calib/simulate/internal/noise.h"
#include "calib/solve/camera_views.h"

namespace rgbdt::study {

struct PairedOptions {
  int views = 8;
  bool paper = true;  ///< the paper's steps in the cloud, too: they take most of the time
};

/// One session as both methods see it: the same boards, images and clouds.
struct PairedSession {
  Rig rig;                                ///< the simulator's default; without guesses
  std::vector<Rigid3> camera_from_lidar;  ///< the truth, by camera of the rig
  std::vector<ViewDetection> by_paper;    ///< one a view
  std::vector<ViewDetection> by_boards;   ///< the same for `auto`
};

/// Clouds are rendered; the board is found in them by FindBoards for `auto`, its boundary by the
/// paper's steps (DetectCloudEdges) for `paper`. Images are not rendered: inner corners are sampled
/// (CornerSigma), and the edge pixels are all those in the paper's 5x5 band about the true outline,
/// as where the board stands out from its background all round. Every board is wholly in both
/// images. Nothing where the scene that this seed draws has no room.
std::optional<PairedSession> MakePairedSession(const PairedOptions& options, std::uint64_t seed);

/// What the detector would make of a board in an image, as above; nothing where the board is not
/// wholly in it.
std::optional<ImageEdges> BoardInImage(const CameraSpec& spec, const Target& target,
                                       const Rigid3& camera_from_target,
                                       const simulate::Noise& noise);

/// Of one camera, into the detections and in their order.
std::vector<CameraView> ViewsOfCamera(const std::vector<ViewDetection>& detections,
                                      const std::string& camera);

}  // namespace rgbdt::study
