#include "calib/files/folder_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "calib/model/errors.h"

namespace rgbdt {

FolderLock::FolderLock(std::filesystem::path folder, const std::string& who)
    : folder_(std::move(folder)) {
  std::error_code error;
  made_ = std::filesystem::create_directories(folder_, error);
  if (error) throw InputError("cannot make " + folder_.string() + ": " + error.message());
  descriptor_ = ::open(folder_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor_ < 0 || ::flock(descriptor_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) {
    return;
  }
  ::close(descriptor_);
  throw InputError(folder_.string() + ": another " + who +
                   " writes to it; end that one, or name another folder");
}

FolderLock::~FolderLock() {
  std::error_code ignored;
  if (made_) std::filesystem::remove(folder_, ignored);  // fails where it is not empty
  if (descriptor_ >= 0) ::close(descriptor_);
}

}  // namespace rgbdt
