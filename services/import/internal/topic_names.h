#pragma once

#include <string>
#include <vector>

namespace rgbdt {

/// A topic's name taken apart: "/cam/rgb/image_raw" is the leaf "image_raw" in the space
/// "/cam/rgb", and says what the images are ("image_raw"), not whose. "/ir/left_image" are the
/// "image" of its own "left".
struct TopicParts {
  std::string space, leaf, images, own;
};
/// `compressed`: a transport at its end ("/compressed") does not count.
TopicParts SplitTopic(std::string name, bool compressed);

/// 1 to 28 characters: with a number behind it, too, it can be a sensor's.
std::string ShortName(const std::string& name);

/// The last part of each path, of a-z, 0-9 and _. Of those that end alike with the nearest part
/// above in which most differ: "/front/rgb" and "/rear/rgb" are front_rgb and rear_rgb,
/// "/front/camera" and "/rear/camera" front and rear. A few may be alike still.
std::vector<std::string> TellApart(const std::vector<std::string>& paths);

}  // namespace rgbdt
