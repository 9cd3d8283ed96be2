#include "calib/files/own_folder.h"

#include "calib/model/errors.h"

namespace rgbdt {

std::filesystem::path OwnFolder(const std::filesystem::path& folder, const std::string& name) {
  std::filesystem::path path = folder / name;
  std::error_code ignored;
  if (std::filesystem::is_symlink(path, ignored)) {
    throw InputError("cannot write to " + path.string() +
                     ": it is a symbolic link, which may lead out of the session; put a folder in "
                     "its place");
  }
  return path;
}

}  // namespace rgbdt
