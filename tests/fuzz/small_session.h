#pragma once

// A session of one view whose files are as small as can be.

#include <filesystem>
#include <fstream>
#include <opencv2/core.hpp>
#include <string>

#include "calib/files/image_files.h"
#include "calib/files/points/cloud_files.h"

namespace rgbdt::fuzz {

inline const char* const kSmallRig = R"(name: "small"
lidar { name: "lidar" }
camera { name: "rgb" kind: COLOR width: 4 height: 3 pixel_format: BGR8 pinhole { fx: 4 fy: 4 cx: 2 cy: 1 } }
camera {
  name: "thermal" kind: THERMAL width: 4 height: 3 pixel_format: MONO16
  fisheye { fx: 4 fy: 4 cx: 2 cy: 1 }
  linear { gain_k_per_count: 0.04 offset_k: 1 }
}
target { squares_x: 8 squares_y: 6 square_m: 0.1 width_m: 1 height_m: 0.8 }
)";

/// One whose LIDAR is a scanner on a motor.
inline const char* const kTurnedRig = R"(name: "turned"
lidar {
  name: "lidar"
  turned_scanner {
    motor_from_scanner { quaternion_wxyz: [1, 0, 0, 0] translation_m: [0, 0, 0.05] }
    ticks_per_degree: 1000
  }
}
camera { name: "rgb" kind: COLOR width: 4 height: 3 pixel_format: BGR8 pinhole { fx: 4 fy: 4 cx: 2 cy: 1 } }
target { squares_x: 8 squares_y: 6 square_m: 0.1 width_m: 1 height_m: 0.8 }
)";

inline const char* const kSmallView = R"(cloud: "cloud.pcd"
sweep_utime: 1700000000000000
heldout: true
image {
  camera: "rgb" file: "rgb.png" utime: 1700000000250000 pixel_format: BAYER_RG8
  picked { corner_px: [0, 0, 3, 0, 3, 2, 0, 2] }
  exposure_s: 0.01 frame_number: 7 device_utime: 12
}
image {
  camera: "thermal" file: "thermal.png" emissivity: 0.9 reflected_temperature_k: 290
  planck { r: 15000 b: 1400 f: 1 o: 5 } shutter_correcting: true
}
)";

inline void WriteViewText(const std::filesystem::path& session, const std::string& text) {
  std::ofstream(session / "views/0001/view.textproto", std::ios::binary) << text;
}

inline void WriteSmallSession(const std::filesystem::path& dir) {
  const std::filesystem::path view = dir / "views/0001";
  std::filesystem::create_directories(view);
  std::ofstream(dir / "rig.textproto") << kSmallRig << "lidar { name: \"second\" }\n";
  WritePng(view / "rgb.png", cv::Mat(3, 4, CV_8UC1, 100));
  WritePng(view / "colour.png", cv::Mat(3, 4, CV_8UC3, cv::Scalar(1, 2, 3)));
  WritePng(view / "large.png", cv::Mat(4, 4, CV_8UC1, 100));
  WritePng(view / "thermal.png", cv::Mat(3, 4, CV_16UC1, 8000));
  Cloud cloud;
  cloud.points = {{1, 0, 0}, {2, 0, 0}};
  cloud.lines = 1;
  cloud.beams = 2;
  WritePcd(view / "cloud.pcd", cloud);
  cloud.points[0].x() = 3;
  WritePcd(view / "second.pcd", cloud);
  WriteViewText(dir, kSmallView);
}

}  // namespace rgbdt::fuzz
