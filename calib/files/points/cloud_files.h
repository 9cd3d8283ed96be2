#pragma once

#include <filesystem>
#include <string>

#include "calib/model/cloud.h"
#include "calib/model/rgbdt_cloud.h"

namespace rgbdt {

/// Of a sweep, also of one that a bag holds.
inline constexpr std::size_t kMostSweepPoints = 20'000'000;

/// Reads a sweep: a PCD file (ASCII, binary or binary_compressed), a PLY (ASCII or binary, little
/// endian) or, by its ending, a `.bin` of KITTI's (floats x y z intensity) or `.pcd.bin` of
/// nuScenes' (ring besides). Fields, each of any numeric type:
///  - x y z [m], required. Not finite, or all three 0 (as many drivers write it): nothing returned.
///  - intensity; where the file's largest is above 1, 0..255 (or, above 255, 0..65535) is brought
///    to 0..1.
///  - ring.
///  - utime [us, UTC], or timestamp, time_stamp, time, t or offset_time in whatever unit makes a
///    sweep of them (ns, us, ms, s); these count from `sweep_utime` unless they are times since
///    1970, and are left out where they make none.
///  - line, beam: the place in an organised cloud. Without them an organised cloud is HEIGHT lines
///    of WIDTH beams, but where all rings come in turn: these are the beams then; HEIGHT 1 is a
///    cloud without order.
///  - dir_x dir_y dir_z: unit vector of the beam; origin_x origin_y origin_z [m]: where it starts.
/// What the file does not have stays empty. Throws InputError naming the file, and where it is cut
/// short, inconsistent, without x y z, without a single point that returned or claims more than
/// kMostSweepPoints.
Cloud ReadSweep(const std::filesystem::path& path, Utime sweep_utime = 0);

/// The same from bytes of a PCD; `where` stands for the file in error messages.
Cloud ParsePcd(const std::string& bytes, const std::string& where, Utime sweep_utime = 0);

/// Writes a binary PCD with the fields above, bit for bit what ReadSweep gives back; only those
/// that the cloud has. Throws InputError for a cloud that is empty or whose vectors differ in
/// length.
void WritePcd(const std::filesystem::path& path, const Cloud& cloud);

/// Writes a binary PCD: x y z [m], rgb (packed as PCL does), intensity, utime [us, UTC],
/// temperature [K], temperature_sigma [K], thermal_counts, valid (bit i: camera i saw the point).
/// Comments hold the frame, the cameras with their bits and calibrations' times, the sweep, and the
/// pose map_from_lidar where there is one. Throws InputError where vectors differ in length.
void WritePcd(const std::filesystem::path& path, const RgbdtCloud& cloud);

/// The same as a binary little-endian PLY, with red green blue.
void WritePly(const std::filesystem::path& path, const RgbdtCloud& cloud);

/// Reads a fused cloud from PLY (ascii or binary_little_endian) or PCD, told apart by their first
/// bytes: what WritePly and WritePcd wrote, to the bit (only `seq` is of the bus and not kept), or
/// anybody's file with x y z [m]. Fields besides, each of any numeric type:
///  - red green blue, or r g b: 0 to 255, or real numbers 0 to 1; or packed into rgb or rgba.
///  - intensity, utime (or timestamp, time, t): as in ReadSweep.
///  - temperature or temperature_k [K], temperature_sigma or temperature_sigma_k [K],
///    thermal_counts; valid, if comments name the cameras.
/// Other fields are skipped; what the file does not have is unknown: NaN, 0 0 0, the sweep's time.
/// Points without finite coordinates, or at 0 0 0, are left out. Throws InputError naming the file,
/// the line or byte, and what was expected.
RgbdtCloud ReadFused(const std::filesystem::path& path);

/// The same from bytes; `where` stands for the file in error messages.
RgbdtCloud ParseFused(const std::string& bytes, const std::string& where);

}  // namespace rgbdt
