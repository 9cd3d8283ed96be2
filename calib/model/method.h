#pragma once

#include <string>
#include <vector>

namespace rgbdt {

/// How a calibration is found. "auto": boards are found in images and clouds without clicks and
/// without a guess; their edges and planes, seen by all cameras, are solved for together. "plane":
/// found the same way, then the LIDAR's points are laid on the board planes that the camera sees
/// (Unnikrishnan and Hebert 2005); the field's usual rival. "paper": Krishnan, Stinnett and
/// Saripalli (2015), from picked or detected corners and a hand-measured guess; the reference.
/// Published methods to compare with, for sessions on disk: "line-scan", one line of the scanner on
/// board planes (Zhang and Pless 2004); "bearing-angle", the board's outline corners picked in a
/// bearing-angle image (Scaramuzza et al. 2007); "single-shot", planes of image and cloud matched
/// by themselves (Geiger et al. 2012).
inline constexpr const char* kAutoMethod = "auto";
inline constexpr const char* kPlaneMethod = "plane";
inline constexpr const char* kPaperMethod = "paper";
inline constexpr const char* kLineScanMethod = "line-scan";
inline constexpr const char* kBearingAngleMethod = "bearing-angle";
inline constexpr const char* kSingleShotMethod = "single-shot";

/// For command lines: their names, and what stands beside these.
inline const std::vector<std::string> kMethodNames = {kAutoMethod,         kPlaneMethod,
                                                      kPaperMethod,        kLineScanMethod,
                                                      kBearingAngleMethod, kSingleShotMethod};
inline constexpr const char* kMethodHelp =
    "auto, the board is detected automatically; plane, the same boards by their planes alone\n"
    "(Unnikrishnan and Hebert 2005); paper, the reference (Krishnan et al. 2015); line-scan, one\n"
    "line of the scanner on board planes (Zhang and Pless 2004); bearing-angle, outline corners\n"
    "in a bearing-angle image (Scaramuzza et al. 2007); single-shot, planes matched by themselves\n"
    "(Geiger et al. 2012). Without a target (natural, mi, nmi, gom, edge-grid): rgbdt refine";

/// The same for what works on the bus.
inline const std::vector<std::string> kBusMethodNames = {kAutoMethod, kPlaneMethod, kPaperMethod};
inline constexpr const char* kBusMethodHelp =
    "auto, the board is detected automatically; plane, the same boards by their planes alone\n"
    "(Unnikrishnan and Hebert 2005); paper, the reference (Krishnan et al. 2015)";

/// Throws InputError with the names that there are.
void RequireMethod(const std::string& method);

}  // namespace rgbdt
