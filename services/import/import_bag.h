#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "calib/files/import/folders.h"
#include "calib/model/rig.h"
#include "calib/model/view_detection.h"
#include "services/import/moments.h"

namespace rgbdt {

struct RigWishes {
  Target board;
  std::vector<Folders::LensFile> lenses;  ///< in place of the bag's CameraInfo
  std::optional<Lens::Model> model;       ///< of lenses that neither says
};

/// The rig that a bag tells of, and a line for each of its parts.
struct BagRig {
  Rig rig;
  std::vector<std::string> lines;
};

/// Of each camera its first image, its lens and, by tf_static, its guess. Throws InputError: images
/// that cannot be read, a lens of another size or of a model that we do not have, a camera without
/// a lens of which no model is wanted.
BagRig ReadRig(BagReader* bag, const BagSurvey& survey, const TopicChoice& choice,
               const RigWishes& wishes);

/// One image of a camera, by its place. Throws InputError: unreadable, or of another size or kind
/// than the camera's.
Image ReadImage(BagReader* bag, const TopicChoice::Camera& camera, const CameraSpec& spec,
                const Stamped& stamped);

/// The same whatever the camera's size and colours are; of a colour camera 8 bit. Throws InputError
/// where it is unreadable.
Image ReadImageAsItIs(BagReader* bag, const TopicChoice::Camera& camera, CameraKind kind,
                      const Stamped& stamped);

/// Points' times that are of another clock than their header's, as of a LIDAR that counts since it
/// was switched on, moved so that the first is the header's. False: they are of the header's clock.
bool ByHeadersClock(Cloud* cloud);

/// Of a chosen topic of clouds the one at a place of `stamped`. Throws InputError where it cannot
/// be read.
using CloudReader = std::function<Cloud(const Stamped&)>;

/// Clouds that are messages; of a Livox, those within half a second of it as one. Both arguments
/// outlive it.
CloudReader CloudMessages(BagReader* bag, const BagSurvey::Topic& topic);

/// Reads the moments and writes them as views 0001, 0002, ... and last the rig; what cannot be read
/// is told in `left_over`. Every third view is held out. `read_clouds` are the LIDARs', the
/// reference's first. Gives how many views there are. Throws InputError where there is none, and
/// what WriteView throws.
std::size_t WriteMoments(BagReader* bag, const TopicChoice& choice, const Rig& rig,
                         const std::vector<Moment>& moments,
                         const std::vector<CloudReader>& read_clouds,
                         const std::filesystem::path& dir,
                         const std::function<void(const std::string&)>& progress,
                         std::vector<std::string>* left_over);

}  // namespace rgbdt
