#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "calib/files/import/pairing.h"
#include "calib/model/image.h"

namespace rgbdt {

/// The images, or the PCD files, that lie in a folder itself, by the endings of their names. Throw
/// InputError where there are none, with what there is instead.
FileList ListImages(const std::filesystem::path& folder);
FileList ListClouds(const std::filesystem::path& folder);

/// What is known of an image once it was read.
struct ImageFacts {
  int width = 0, height = 0;
  PixelFormat format = PixelFormat::kMono8;
  bool grey = false;  ///< of one channel, or of three alike (OneChannelOfGrey)
  bool turned_by_exif = false;
  double dark_over_bright = 0;  ///< of kMono16
  std::string problem;          ///< why it cannot be used; empty: it can
};

/// Of those whose indices are given, in that order.
std::vector<ImageFacts> LookAtImages(const FileList& files, const std::vector<std::size_t>& which);

/// Why each of these clouds cannot be read; empty: it can. Throws InputError for clouds that are in
/// millimetres.
std::vector<std::string> LookAtClouds(const FileList& files, const std::vector<std::size_t>& which);

}  // namespace rgbdt
