#include <cstdio>
#include <memory>

#include "services/bus/bus_key.h"
#include "services/rgbdt/verbs.h"

namespace rgbdt {
namespace {

int RunKey(const std::string& file) {
  WriteNewBusKey(file);
  std::printf("wrote %s, readable for you alone; give every process of the rig --key %s\n",
              file.c_str(), file.c_str());
  return 0;
}

}  // namespace

void AddKey(CommandLine* program) {
  auto file = std::make_shared<std::string>();
  CommandLine* verb = program->Verb(
      "key",
      "Makes a rig's key. Processes that are given it (--key) sign what commands the\n"
      "rig, and ignore what is not signed with it. All of a rig's processes share one,\n"
      "on all its machines; who has it may command the rig. A file that is there\n"
      "already is not written over.\n"
      "Example: rgbdt key rig.key && rgbdt up rig.textproto --key rig.key",
      [file] { return RunKey(*file); });
  verb->Required("FILE", file.get(), "the key to write");
}

}  // namespace rgbdt
