#include "calib/files/folder_lock.h"

#include <fcntl.h>
#include <sys/file.h>

#include <cerrno>
#include <cstring>
#include <system_error>

#include "calib/model/errors.h"

namespace rgbdt {

FolderLock::FolderLock(std::filesystem::path folder, const std::string& who)
    : folder_(std::move(folder)) {
  std::error_code error;
  made_ = std::filesystem::create_directories(folder_, error);
  if (error) throw InputError("cannot make " + folder_.string() + ": " + error.message());
  descriptor_ = Descriptor(::open(folder_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!descriptor_) {
    throw InputError("cannot open " + folder_.string() + ": " + std::strerror(errno));
  }
  if (::flock(descriptor_.get(), LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;
  throw InputError(folder_.string() + ": another " + who +
                   " writes to it; end that one, or name another folder");
}

FolderLock::~FolderLock() {
  std::error_code ignored;
  if (made_) std::filesystem::remove(folder_, ignored);  // fails where it is not empty
}

}  // namespace rgbdt
