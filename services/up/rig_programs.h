#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "calib/model/rig.h"

namespace rgbdt {

inline constexpr const char* kLogger = "logger";             ///< as a process
inline constexpr const char* kLoggerProgram = "lcm-logger";  ///< what it runs: LCM's own

/// What a process is there for.
enum class Role {
  kDriver,   ///< a device of the rig
  kSession,  ///< the rig is calibrated
  kDrive,    ///< it drives
  kBoth,     ///< either
};

/// A program to be run.
struct Program {
  std::string name;                    ///< as its STATUS calls it: "camera-rgb"
  std::vector<std::string> arguments;  ///< the program's path first
  std::filesystem::path log;           ///< what it prints is added to this file
  bool ends = false;                   ///< where it says that it is done, it is for good
  bool speaks = true;                  ///< it sends STATUS
  Role role = Role::kBoth;
};

/// How a rig's processes are called.
struct UpOptions {
  std::filesystem::path programs;  ///< the folder where rgbdt-assembler and the others are
  std::filesystem::path rig;       ///< rig.textproto
  std::filesystem::path out;       ///< the session's directory, or the folder of a drive's map
  /// Directory of the calibrated session whose rig drives; empty: it is to be calibrated.
  std::filesystem::path drive;
  std::filesystem::path logs;        ///< a folder
  std::string listen;                ///< of the viewer; empty: its usual address
  std::string certificate, tls_key;  ///< of the viewer's TLS; empty: its own choice
  std::string url;                   ///< of the bus; empty: LCM_DEFAULT_URL
  std::string key;                   ///< file of the rig's key; empty: RGBDT_KEY, or else none
  /// What is said on the bus goes here, by lcm-logger; each start of it appends .00, .01 or so.
  /// Empty: no logger, unless the rig's hosts have one, which writes beside `out`.
  std::filesystem::path log;
};

/// The processes of a rig, as systemd's rgbdt.target has them: a driver for each device that the
/// rig names, assembler (of a turned scanner), detector, solver, fuser, a session that the page
/// leads, the viewer, and a logger where one is asked for. Of a drive monitor, fuser, odometry and
/// mapper in place of detector, solver, fuser and session.
std::vector<Program> ProgramsOf(const Rig& rig, const UpOptions& options);

/// Names of a rig's processes of these roles that send STATUS for as long as the rig is up.
std::vector<std::string> SpeakersOf(const Rig& rig, const std::set<Role>& roles);

/// Those of all of a rig's programs that run on `host`, as the rig's hosts say; without any: all.
/// What only a drive has runs beside the fuser where no host names it.
/// Throws InputError where the rig has other hosts, where a host runs what the rig has not, or
/// where a program is nobody's.
std::vector<Program> ProgramsOn(const std::string& host, const Rig& rig, std::vector<Program> all);

}  // namespace rgbdt
