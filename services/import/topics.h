#pragma once

#include <string>
#include <utility>
#include <vector>

#include "services/import/survey.h"

namespace rgbdt {

/// What a person asks for; what is empty is seen from the bag.
struct TopicWishes {
  std::vector<std::pair<std::string, std::string>> images;  ///< name (or empty), topic
  std::vector<std::pair<std::string, std::string>> clouds;  ///< likewise; the reference first
  bool clouds_alone = false;  ///< no camera is needed, and none is chosen
  bool one_lidar = false;     ///< of several LIDARs none is chosen unless it is asked for
};

struct TopicChoice {
  struct Camera {
    std::string name;  ///< of the camera: from the topic, "rgb" of /rgb/image_raw
    const BagSurvey::Topic* images = nullptr;
    const BagSurvey::Topic* info = nullptr;  ///< its CameraInfo; none: it has none
  };
  struct Lidar {
    std::string name;  ///< "lidar", or of several from the topic as a camera's: "front"
    const BagSurvey::Topic* clouds = nullptr;  ///< or packets
  };
  std::vector<Camera> cameras;
  Lidar lidar;  ///< the reference, in whose frame poses are
  std::vector<Lidar> further_lidars;
  std::vector<std::string>
      left_out;  ///< a line for each topic of images or clouds that is not taken: why
};

/// Which topics are cameras and which are LIDARs. Of what one camera publishes several times, the
/// raw images are taken, or else the least changed ones. Depth and rectified images are none unless
/// asked for, nor are clouds with colours or of a depth camera, what is computed of others' clouds,
/// and packets, where there are other clouds. Each frame is a LIDAR. Points into `survey`. Throws
/// InputError: no images, no clouds or several topics of one frame, a wish for what is not there.
TopicChoice ChooseTopics(const BagSurvey& survey, const TopicWishes& wishes);

/// What the LIDAR of these packets says of itself: the topic `metadata` beside them, or else the
/// only one; none: there is none, or there are several.
const BagSurvey::Topic* MetadataOf(const BagSurvey& survey, const BagSurvey::Topic& packets);

}  // namespace rgbdt
