#include "calib/model/view_detection.h"

namespace rgbdt {

std::string BriefReport(const ViewDetection& detection) {
  std::string text;
  for (const ImageDetection& image : detection.images) {
    text += image.camera + ": " + (image.usable() ? "board found" : image.why_not) + "; ";
  }
  const CloudDetection& cloud = detection.cloud;
  return text + "cloud: " + (cloud.why_not.empty() ? "board found" : cloud.why_not);
}

}  // namespace rgbdt
