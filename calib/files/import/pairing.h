#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "calib/model/time.h"

namespace rgbdt {

/// A folder and the names of its files that count, sorted with numbers as numbers.
struct FileList {
  std::filesystem::path folder;
  std::vector<std::string> names;
  std::string what = "image";  ///< each of them is, for messages: "image" or "cloud"
};

struct PairOptions {
  bool in_order = false;     ///< the first with the first and so on, whatever they are called
  double max_apart_s = 0.1;  ///< of names that are times [s]
};

/// How files of two folders were paired.
enum class PairedBy { kName, kNumber, kTime, kOrder };

/// Which cloud belongs to which image, or to which cloud of a further LIDAR.
struct Pairs {
  PairedBy by = PairedBy::kName;
  std::vector<std::optional<std::size_t>> cloud_of;  ///< of each image
  std::vector<Utime> image_utime, cloud_utime;       ///< where names are times: theirs; or else 0
  std::size_t count = 0;

  /// Why the others have none: "no cloud of the same name".
  std::string why_not;
};

/// Pairs by time where most names of both folders are times (the nearest of each other, so each
/// once and in order), and otherwise by the names without their endings or the numbers in them,
/// whichever pairs more. Throws InputError where nothing pairs, or the counts differ that are to be
/// paired in order.
Pairs PairFiles(const FileList& images, const FileList& clouds, const PairOptions& options);

/// "by name", "by number", "by time", "in order".
std::string NameOf(PairedBy by);

}  // namespace rgbdt
