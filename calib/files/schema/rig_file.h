#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "calib/model/rig.h"

namespace rgbdt {

/// Reads and checks a rig.textproto (schema: calib/files/schema/rig.proto). `text` and `hash` of
/// the result are the file's. Throws InputError with file, line and key; also for a camera without
/// a lens (none at all, or fx and fy left out or 0), unless those may be unknown.
Rig ReadRig(const std::filesystem::path& path, LensNeed lenses = LensNeed::kKnown);

/// The same from text, as it comes over the bus; `where` stands for the file in error messages.
Rig ParseRig(const std::string& text, const std::string& where, LensNeed lenses = LensNeed::kKnown);

/// The rig as rig.textproto, full precision; `text` and `hash` are not looked at.
std::string PrintRig(const Rig& rig);

/// What differs between two rigs that a calibration depends on, a line for each field ("modified:
/// camera[0].pinhole.fx: 600 -> 610"): names of rig and LIDAR, devices, guesses and how warm the
/// surroundings are do not count, but for the model of a LIDAR where both rigs have it.
std::vector<std::string> DifferencesOf(const Rig& a, const Rig& b);

/// Those in one line, the first few of them: rigs that have nothing in common differ in everything.
std::string InOneLine(const std::vector<std::string>& differences);

/// What stands in Rig::hash: FNV-1a, 64 bit, 16 hexadecimal digits.
std::string HashOfRigText(const std::string& text);

}  // namespace rgbdt
