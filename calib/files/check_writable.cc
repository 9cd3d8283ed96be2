#include "calib/files/check_writable.h"

#include <stdlib.h>  // mkstemp
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>

#include "calib/model/errors.h"

namespace rgbdt {
namespace {

namespace fs = std::filesystem;

// The folder that `path` lies in, or the nearest above it that is there.
fs::path ExistingFolder(const fs::path& path) {
  std::error_code ignored;
  fs::path folder = path.parent_path();
  while (!folder.empty() && !fs::exists(folder, ignored)) folder = folder.parent_path();
  return folder.empty() ? "." : folder;
}

// Returns 0 or errno. A full disk still takes a name, but no bytes.
int TryToWrite(const fs::path& folder) {
  std::string probe = (folder / ".rgbdt-probe-XXXXXX").string();
  const int fd = ::mkstemp(probe.data());
  if (fd < 0) return errno;
  ::unlink(probe.c_str());
  const std::string bytes(4096, '\0');
  const ssize_t written = ::write(fd, bytes.data(), bytes.size());
  const int error = written < 0 ? errno : written == 4096 ? 0 : ENOSPC;
  ::close(fd);
  return error;
}

}  // namespace

void CheckWritable(const fs::path& path) {
  std::error_code ignored;
  const int error = fs::is_directory(path, ignored) ? EISDIR : TryToWrite(ExistingFolder(path));
  if (error != 0) throw InputError("cannot write " + path.string() + ": " + std::strerror(error));
}

}  // namespace rgbdt
