#pragma once

#include <string>
#include <utility>
#include <vector>

#include "services/import/survey.h"

namespace rgbdt {

/// What a person asks for; what is empty is seen from the bag.
struct TopicWishes {
  std::vector<std::pair<std::string, std::string>> images;  ///< name (or empty), topic
  std::string cloud;
  bool clouds_alone = false;  ///< no camera is needed, and none is chosen
};

struct TopicChoice {
  struct Camera {
    std::string name;  ///< of the camera: from the topic, "rgb" of /rgb/image_raw
    const BagSurvey::Topic* images = nullptr;
    const BagSurvey::Topic* info = nullptr;  ///< its CameraInfo; none: it has none
  };
  std::vector<Camera> cameras;
  const BagSurvey::Topic* cloud = nullptr;
  std::vector<std::string>
      left_out;  ///< a line for each topic of images or clouds that is not taken: why
};

/// Which topics are cameras and which is the LIDAR. Of what one camera publishes several times, the
/// raw images are taken, or else the least changed ones. Depth and rectified images are none unless
/// asked for, nor is a cloud with colours the LIDAR's where there is another. Points into `survey`.
/// Throws InputError: no images, no clouds or several topics of them, a wish for what is not there.
TopicChoice ChooseTopics(const BagSurvey& survey, const TopicWishes& wishes);

/// What the LIDAR of these packets says of itself: the topic `metadata` beside them, or else the
/// only one; none: there is none, or there are several.
const BagSurvey::Topic* MetadataOf(const BagSurvey& survey, const BagSurvey::Topic& packets);

}  // namespace rgbdt
