#pragma once

#include <optional>

#include "calib/camera/intrinsics.h"
#include "calib/solve/camera_views.h"

namespace rgbdt {

/// A camera's lens by its images alone: of the one that was given, only the model is taken.
struct LensByImages {
  IntrinsicsInput input;
  IntrinsicsResult result;  ///< may not have converged
};

/// Nothing where fewer than five images show all of a pattern's corners.
std::optional<LensByImages> FindLensByImages(const Target& target, const CameraViews& views);

/// Whether the images alone contradict the lens that the rig file has, by twice their own sigmas:
/// neither LIDAR nor board has a say in that.
bool ImagesRefute(const LensByImages& lens, const Lens& given);

/// That the images want a fisheye where the rig file has a pinhole, or the other way round. Nothing
/// where they do not, or cannot tell. Its chi2 is the information criterion's (LensAlternative).
std::optional<Cause> OtherModel(const LensByImages& lens, const CameraSpec& camera);

}  // namespace rgbdt
