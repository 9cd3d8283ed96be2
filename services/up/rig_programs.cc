#include "services/up/rig_programs.h"

#include <algorithm>
#include <array>
#include <set>
#include <utility>

#include "calib/model/errors.h"
#include "calib/model/recording.h"

namespace rgbdt {
namespace {

// What only a session needs, and what only a drive does.
constexpr std::array kOfASession{"detector", "solver", "session"};
constexpr std::array kOfADrive{"monitor", "odometry", "mapper"};

bool Runs(const HostSpec& host, const std::string& name) {
  return std::find(host.runs.begin(), host.runs.end(), name) != host.runs.end();
}

bool HostsLog(const Rig& rig) {
  return std::any_of(rig.hosts.begin(), rig.hosts.end(),
                     [](const HostSpec& host) { return Runs(host, kLogger); });
}

// A program of LCM's, which says nothing in STATUS. A name that is not taken yet each time: what an
// earlier one wrote stays.
Program Logger(const UpOptions& options) {
  Program logger;
  logger.name = kLogger;
  const std::filesystem::path log =
      !options.log.empty()
          ? options.log
          : std::filesystem::path((options.out / "").parent_path().string() + ".lcmlog");
  // LCM's --increment, unlike -i, takes the word behind it for its own.
  logger.arguments = {kLoggerProgram, "-q", "-i"};
  if (!options.url.empty()) logger.arguments.push_back("--lcm-url=" + options.url);
  logger.arguments.push_back(log.string());
  logger.log = options.logs / "logger.log";
  logger.speaks = false;
  return logger;
}

// The rig's hosts with what they run of `all`: a rig file holds for sessions and drives.
std::vector<HostSpec> HostsFor(const Rig& rig, const std::vector<Program>& all) {
  const auto is_here = [&](const std::string& name) {
    return std::any_of(all.begin(), all.end(),
                       [&](const Program& program) { return program.name == name; });
  };
  std::vector<HostSpec> hosts = rig.hosts;
  const auto without = [&](const auto& names) {
    for (const char* name : names) {
      if (is_here(name)) continue;
      for (HostSpec& host : hosts) {
        host.runs.erase(std::remove(host.runs.begin(), host.runs.end(), name), host.runs.end());
      }
    }
  };
  without(kOfASession);
  without(kOfADrive);
  for (const char* name : kOfADrive) {
    const bool named = std::any_of(hosts.begin(), hosts.end(),
                                   [&](const HostSpec& host) { return Runs(host, name); });
    if (named || !is_here(name)) continue;
    for (HostSpec& host : hosts) {
      if (Runs(host, "fuser")) host.runs.emplace_back(name);
    }
  }
  return hosts;
}

template <typename Names>
std::string Listed(const Names& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

std::string NamesOf(const std::vector<Program>& programs) {
  std::vector<std::string> names;
  names.reserve(programs.size());
  for (const Program& program : programs) names.push_back(program.name);
  return Listed(names);
}

// Of sessions and drives, all but the logger.
std::vector<Program> AllPrograms(const Rig& rig, const UpOptions& options) {
  std::vector<Program> all;
  const auto add = [&](Role role, const std::string& name, const std::string& program,
                       const std::vector<std::string>& arguments) {
    Program one;
    one.name = name;
    one.role = role;
    one.arguments.push_back((options.programs / ("rgbdt-" + program)).string());
    one.arguments.insert(one.arguments.end(), arguments.begin(), arguments.end());
    if (!options.url.empty()) {
      one.arguments.emplace_back("--lcm-url");
      one.arguments.push_back(options.url);
    }
    if (!options.key.empty()) {
      one.arguments.emplace_back("--key");
      one.arguments.push_back(options.key);
    }
    one.log = options.logs / (name + ".log");
    all.push_back(std::move(one));
  };
  const std::string file = options.rig.string();
  for (const CameraSpec& camera : rig.cameras) {
    if (!camera.device) continue;
    add(Role::kDriver, "camera-" + camera.name, "camera",
        {"--rig", file, "--camera", camera.name, "--captures",
         (options.out / "").parent_path().string() + ".captures"});
  }
  if (rig.lidar.device.index() != 0) {
    add(Role::kDriver, "lidar", "lidar", {"--rig", file});
    all.back().ends = IsRecording(rig.lidar);
  }
  if (rig.lidar.turned_scanner && rig.lidar.turned_scanner->motor) {
    add(Role::kDriver, "motor", "motor", {"--rig", file});
  }
  if (rig.lidar.turned_scanner) add(Role::kBoth, "assembler", "assembler", {});
  for (const char* name : {"detector", "solver"}) add(Role::kSession, name, name, {});
  add(Role::kDrive, "monitor", "monitor", {options.drive.string()});
  add(Role::kBoth, "fuser", "fuser", {});
  add(Role::kDrive, "odometry", "odometry", {});
  add(Role::kDrive, "mapper", "mapper", {"--out", (options.out / "map.ply").string()});
  add(Role::kSession, "session", "session", {"--rig", file, "--out", options.out.string()});
  all.back().ends = true;
  std::vector<std::string> page;
  if (!options.listen.empty()) page = {"--listen", options.listen};
  if (!options.certificate.empty()) {
    page.insert(page.end(), {"--tls", options.certificate, options.tls_key});
  }
  add(Role::kBoth, "viewer", "viewer", page);
  return all;
}

}  // namespace

std::vector<Program> ProgramsOf(const Rig& rig, const UpOptions& options) {
  const Role other = options.drive.empty() ? Role::kDrive : Role::kSession;
  std::vector<Program> programs = AllPrograms(rig, options);
  programs.erase(std::remove_if(programs.begin(), programs.end(),
                                [&](const Program& program) { return program.role == other; }),
                 programs.end());
  if (!options.log.empty() || HostsLog(rig)) programs.push_back(Logger(options));
  return programs;
}

std::vector<std::string> SpeakersOf(const Rig& rig, const std::set<Role>& roles) {
  std::vector<std::string> names;
  for (const Program& program : AllPrograms(rig, {})) {
    if (roles.count(program.role) > 0 && !program.ends) names.push_back(program.name);
  }
  return names;
}

std::vector<Program> ProgramsOn(const std::string& host, const Rig& rig, std::vector<Program> all) {
  if (rig.hosts.empty()) return all;
  const std::vector<HostSpec> rig_hosts = HostsFor(rig, all);
  std::set<std::string> nobodys;
  for (const Program& program : all) nobodys.insert(program.name);
  std::vector<std::string> hosts;
  const HostSpec* own = nullptr;
  for (const HostSpec& one : rig_hosts) {
    hosts.push_back(one.name);
    if (one.name == host) own = &one;
    for (const std::string& name : one.runs) {
      if (nobodys.erase(name) > 0) continue;
      throw InputError("rig: host \"" + one.name + "\" runs \"" + name +
                       "\", which this rig has not; expected some of " + NamesOf(all));
    }
  }
  nobodys.erase(kLogger);
  if (!nobodys.empty()) {
    throw InputError("rig: no host runs " + Listed(nobodys) +
                     "; name each in one host { name: ... runs: ... }");
  }
  if (own == nullptr) {
    throw InputError("this machine is \"" + host + "\", and the rig's hosts are " + Listed(hosts) +
                     "; say which one it is by --host");
  }
  std::vector<Program> mine;
  for (Program& program : all) {
    const bool asked = program.name == kLogger && !HostsLog(rig);  // by --log, here
    if (asked || Runs(*own, program.name)) mine.push_back(std::move(program));
  }
  return mine;
}

}  // namespace rgbdt
