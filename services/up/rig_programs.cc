#include "services/up/rig_programs.h"

#include <utility>

namespace rgbdt {

std::vector<Program> ProgramsOf(const Rig& rig, const UpOptions& options) {
  std::vector<Program> all;
  const auto add = [&](const std::string& name, const std::string& program,
                       const std::vector<std::string>& arguments) {
    Program one;
    one.name = name;
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
    add("camera-" + camera.name, "camera", {"--rig", file, "--camera", camera.name});
  }
  if (rig.lidar.device.index() != 0) {
    add("lidar", "lidar", {"--rig", file});
    all.back().ends = true;  // a recording does; it is not to be played again
  }
  if (rig.lidar.turned_scanner && rig.lidar.turned_scanner->motor) {
    add("motor", "motor", {"--rig", file});
  }
  if (rig.lidar.turned_scanner) add("assembler", "assembler", {});
  for (const char* name : {"detector", "solver", "fuser"}) add(name, name, {});
  add("session", "session", {"--rig", file, "--out", options.out.string()});
  all.back().ends = true;
  std::vector<std::string> page;
  if (!options.listen.empty()) page = {"--listen", options.listen};
  if (!options.certificate.empty()) {
    page.insert(page.end(), {"--tls", options.certificate, options.tls_key});
  }
  add("viewer", "viewer", page);
  return all;
}

}  // namespace rgbdt
