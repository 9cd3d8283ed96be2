#include "calib/model/view_detection.h"

namespace rgbdt {

std::string BriefReport(const ViewDetection& detection) {
  std::string text;
  for (const ImageDetection& image : detection.images) {
    text += image.camera + ": " + (image.usable() ? "board found" : image.why_not) + "; ";
  }
  const CloudDetection& cloud = detection.cloud;
  text += "cloud: " + (cloud.why_not.empty() ? "board found" : cloud.why_not);
  for (const LidarDetection& further : detection.further_clouds) {
    const std::string& why_not = further.cloud.why_not;
    text += "; cloud of " + further.lidar + ": " + (why_not.empty() ? "board found" : why_not);
  }
  return text;
}

}  // namespace rgbdt
