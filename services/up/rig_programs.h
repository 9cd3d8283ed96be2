#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "calib/model/rig.h"

namespace rgbdt {

/// A program to be run.
struct Program {
  std::string name;                    ///< as its STATUS calls it: "camera-rgb"
  std::vector<std::string> arguments;  ///< the program's path first
  std::filesystem::path log;           ///< what it prints is added to this file
  bool ends = false;                   ///< exit code 0 means that it is done, for good
};

/// How a rig's processes are called.
struct UpOptions {
  std::filesystem::path programs;    ///< the folder where rgbdt-assembler and the others are
  std::filesystem::path rig;         ///< rig.textproto
  std::filesystem::path out;         ///< the session's directory
  std::filesystem::path logs;        ///< a folder
  std::string listen;                ///< of the viewer; empty: its usual address
  std::string certificate, tls_key;  ///< of the viewer's TLS; empty: its own choice
  std::string url;                   ///< of the bus; empty: LCM_DEFAULT_URL
  std::string key;                   ///< file of the rig's key; empty: RGBDT_KEY, or else none
};

/// The processes of a rig, as systemd's rgbdt.target has them: a driver for each device that the
/// rig names, assembler (of a turned scanner), detector, solver, fuser, a session that the page
/// leads, the viewer.
std::vector<Program> ProgramsOf(const Rig& rig, const UpOptions& options);

}  // namespace rgbdt
