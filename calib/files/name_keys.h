#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "calib/model/time.h"

namespace rgbdt {

/// A file's name without its ending, of a `.pcd.bin` without both.
std::string StemOf(const std::filesystem::path& file);

/// The time since 1970 that a file's name holds, as recorders write it: seconds with or without a
/// fraction (1700000000.25, 1700000000_250000000), or a whole number of milli-, micro- or
/// nanoseconds; 2001 to 2099. Dates count, too, with or without a fraction: 2023-05-14-10-15-23,
/// 20230514_101523.250; of which zone is not known, they are taken for UTC. Absent: none.
std::optional<Utime> TimeInName(const std::string& stem);

/// The number by which each of these names of one folder is told from the others: "frame_0012_rgb8"
/// and "frame_0013_rgb8" give "12" and "13". Empty for names that are built otherwise than most.
/// `sole`: no other number in them changes, so it is the one that is meant.
struct NameNumbers {
  std::vector<std::string> numbers;
  bool sole = true;
};
NameNumbers NumbersInNames(const std::vector<std::string>& stems);

}  // namespace rgbdt
