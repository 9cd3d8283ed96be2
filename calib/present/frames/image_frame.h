#pragma once

#include <string>

#include "calib/model/image.h"

namespace rgbdt {

struct ImageFrameOptions {
  int max_width = 1280;  ///< [px] of the JPEG; a wider image is shrunk
  int quality = 80;      ///< of the JPEG, 1 to 100
};

/// A camera's image as an ImageFrame; `view` is empty for the newest, live one. `ack`: the page is
/// to say when it was drawn. Throws InputError for pixels that cannot be shown.
std::string ImageFrame(const Image& image, const std::string& view, bool ack,
                       const ImageFrameOptions& options = {});

/// A ThumbFrame of a camera's image in a view, 240 px wide.
std::string ThumbFrame(const Image& image, const std::string& view);

}  // namespace rgbdt
