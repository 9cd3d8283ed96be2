#pragma once

// What the fields of a file of points mean (cloud_files.h).

#include <Eigen/Core>
#include <string>
#include <vector>

#include "calib/files/points/internal/record_table.h"
#include "calib/model/time.h"

namespace rgbdt {

/// Three fields as one vector. Throws InputError where one is missing.
std::vector<Eigen::Vector3f> ReadVectors(const records::Table& table, const std::string& x,
                                         const std::string& y, const std::string& z);

/// The field intensity, brought to 0 to 1.
std::vector<float> ReadIntensity(const records::Table& table);

/// The field utime, timestamp, time_stamp, time, t or offset_time [us, UTC]; empty where there is
/// none, and where those of a hundred points or more are all the same or make no sweep in whatever
/// unit (of up to 60 s). Times that are since 2001 in s, ms, us or ns are that. Else drivers count
/// in seconds where numbers are of floating point and in nanoseconds where they are whole, or in
/// what makes a far more usual sweep (0.1 s). A miss needs no time.
std::vector<Utime> ReadUtime(const records::Table& table, Utime sweep_utime,
                             const std::string& where);

}  // namespace rgbdt
