#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <ostream>
#include <string>
#include <vector>

#include "calib/model/rig.h"

namespace rgbdt {

struct NamedLens {
  std::string name;
  CameraSpec spec;
};

inline void PrintTo(const NamedLens& lens, std::ostream* out) { *out << lens.name; }

inline CameraSpec SpecOf(int width, int height, const Lens& lens) {
  CameraSpec spec;
  spec.name = "test";
  spec.width = width;
  spec.height = height;
  spec.lens = lens;
  return spec;
}

/// Lenses from none to strong, of both models.
inline std::vector<NamedLens> Lenses() {
  using Model = Lens::Model;
  return {
      {"ideal_pinhole", SpecOf(640, 480, {Model::kPinhole, 500, 510, 320.3, 239.1, {}})},
      {"five_coefficients",
       SpecOf(640, 480,
              {Model::kPinhole, 530, 531, 317.2, 243.1, {-0.24, 0.11, -6e-4, 5e-4, -0.02}})},
      // Large coefficients that nearly cancel, as fits of OpenCV's rational model give them.
      {"eight_coefficients",
       SpecOf(1280, 960,
              {Model::kPinhole, 620, 622, 643, 471, {6.2, 3.1, 2e-4, -3e-4, 0.12, 6.5, 5.2, 0.8}})},
      {"ideal_fisheye", SpecOf(1000, 1000, {Model::kFisheye, 320, 320, 499.5, 499.5, {}})},
      // shared/real/acfr_vlp16/README.md
      {"acfr_fisheye", SpecOf(1920, 1208,
                              {Model::kFisheye,
                               1176.93,
                               1177.72,
                               962.275,
                               612.725,
                               {-0.0540096, -0.0784275, 0.0959641, -0.0515253}})},
  };
}

inline std::string NameOf(const testing::TestParamInfo<NamedLens>& info) { return info.param.name; }

/// The lens of Lenses() with this name.
inline const CameraSpec& SpecNamed(const std::string& name) {
  static const std::vector<NamedLens> lenses = Lenses();
  return std::find_if(lenses.begin(), lenses.end(),
                      [&](const NamedLens& lens) { return lens.name == name; })
      ->spec;
}

}  // namespace rgbdt
