#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calib/model/calibration.h"
#include "calib/model/lens.h"
#include "calib/solve/camera_views.h"
#include "calib/solve/guess_cameras.h"
#include "calib/solve/options.h"

namespace rgbdt {

/// Why a camera's images and clouds do not go together.
struct Disagreement {
  std::optional<Lens> lens;   ///< by the views' own corners: with it far more of them agree
  std::string contradiction;  ///< images stand beside other views' clouds; empty: they do not
  std::vector<Cause>
      causes;  ///< the likeliest first: what was given wrong in scale, the lens model
};

/// Where less than three quarters of the views, of which both image and cloud show the board, agree
/// on a first guess: what makes them agree, if anything does. Tried are images beside the clouds of
/// the views before and after, up to three away; all that images measure at another scale, as
/// distances between boards ask for; the lens that the images themselves say (CalibrateIntrinsics).
/// `views`: as they were before the guess.
Disagreement WhyViewsDisagree(const Target& target, const CalibrateOptions& options,
                              const CameraViews& views, const FirstGuess& guess);

}  // namespace rgbdt
