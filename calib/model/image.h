#pragma once

#include <opencv2/core/mat.hpp>
#include <string>

#include "calib/model/time.h"

namespace rgbdt {

/// How pixels lie in memory. The numbers are those of the `image_t` message: never renumber.
enum class PixelFormat {
  kMono8 = 1,     ///< CV_8UC1
  kMono16 = 2,    ///< CV_16UC1, 14-bit sensors included
  kBayerRg8 = 3,  ///< CV_8UC1 mosaic; the first row begins R G, the second G B (GenICam's name)
  kBayerGr8 = 4,
  kBayerGb8 = 5,
  kBayerBg8 = 6,
  kBgr8 = 7,  ///< CV_8UC3, OpenCV's order; what a colour PNG or JPEG decodes to
  kJpeg = 8,  ///< only on the wire: decoded on receipt
  kPng = 9,   ///< only on the wire: decoded on receipt
};

/// How counts become temperature.
struct Radiometry {
  enum class Kind {
    kNone = 0,    ///< counts only: no temperature
    kLinear = 1,  ///< kelvin = gain * counts + offset
    kPlanck = 2,  ///< kelvin = B / ln(R / (counts - O) + F)
  };
  Kind kind = Kind::kNone;
  double gain = 0;    ///< [K per count]
  double offset = 0;  ///< [K]
  double r = 0, b = 0, f = 1, o = 0;
  double emissivity = 1;               ///< of the surfaces looked at, 0 to 1
  double reflected_temperature_k = 0;  ///< [K]; what is reflected where emissivity < 1; 0: unknown
};

/// One frame of one camera.
struct Image {
  std::string camera;  ///< name in the rig
  Utime utime = 0;     ///< middle of the exposure, sensors' clock
  std::int64_t seq = 0;
  std::int64_t frame_number = 0;  ///< the device's own count
  Utime device_utime = 0;         ///< the device's own clock [us], its own epoch; 0: unknown
  double exposure_s = 0;          ///< 0: unknown
  PixelFormat format = PixelFormat::kMono8;
  cv::Mat pixels;                   ///< of the type that `format` says
  Radiometry radiometry;            ///< thermal cameras
  bool shutter_correcting = false;  ///< thermal: taken while the shutter corrects (FFC); not used
};

}  // namespace rgbdt
