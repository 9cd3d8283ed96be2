#pragma once

#include <string>
#include <vector>

namespace rgbdt {

/// How a calibration is found. "auto": boards are found in images and clouds without clicks and
/// without a guess; their edges and planes, seen by all cameras, are solved for together. "plane":
/// found the same way, then the LIDAR's points are laid on the board planes that the camera sees
/// (Unnikrishnan and Hebert 2005); the field's usual rival. "paper": Krishnan, Stinnett and
/// Saripalli (2015), from picked or detected corners and a hand-measured guess; the reference.
inline constexpr const char* kAutoMethod = "auto";
inline constexpr const char* kPlaneMethod = "plane";
inline constexpr const char* kPaperMethod = "paper";

/// For command lines: their names, and what stands beside these.
inline const std::vector<std::string> kMethodNames = {kAutoMethod, kPlaneMethod, kPaperMethod};
inline constexpr const char* kMethodHelp =
    "auto, the board is detected automatically; plane, the same boards by their planes alone\n"
    "(Unnikrishnan and Hebert 2005); paper, the reference (Krishnan et al. 2015)";

/// Throws InputError with the names that there are.
void RequireMethod(const std::string& method);

}  // namespace rgbdt
