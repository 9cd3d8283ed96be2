#pragma once

#include <functional>
#include <string>
#include <vector>

#include "calib/model/rig.h"
#include "services/import/topics.h"

namespace rgbdt {

/// Farther than this no corner's place may move within a second, on average over the corners [px]:
/// what detection allows during a sweep.
inline constexpr double kStillForSecondPx = 0.5;

/// A board of which one image of a camera told where it is.
struct BoardLook {
  Utime utime = 0;
  std::vector<Eigen::Vector2d> corners;  ///< inner ones [px], NaN where one was not seen
};

/// How far the board moved between two looks [px]: the rms over corners seen in both, whichever way
/// round the board was read; infinite where fewer than half were.
double Moved(const BoardLook& a, const BoardLook& b);

/// Of these looks at most `views`, the first and then always the one that is farthest from all
/// chosen before, as far as it differs by more than 0.5% of the image's width; indices, in order.
std::vector<std::size_t> SpreadOver(const std::vector<BoardLook>& looks, int image_width,
                                    std::size_t views);

/// When the board stood still.
struct StillMoments {
  std::vector<Utime> times;  ///< in order; the middle of each stand that was chosen
  std::size_t looks = 0;     ///< images looked at
  std::size_t found = 0;     ///< in which the board was found
  std::size_t stands = 0;    ///< times that it stood still for a second or longer
  std::string why;           ///< where it was not found: of the last image
};

/// Looks for the board in a camera's images, once a second. Where two looks a second apart show it
/// in the same place, and so does an image between them, it stood still; stands are spread over
/// views as by SpreadOver. What cannot be read counts as not found. `progress` gets 0 to 1.
StillMoments FindStillMoments(BagReader* bag, const TopicChoice::Camera& camera,
                              const CameraSpec& spec, const Target& board, std::size_t views,
                              const std::function<void(double)>& progress);

}  // namespace rgbdt
