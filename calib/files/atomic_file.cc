#include "calib/files/atomic_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <utility>

#include "calib/model/descriptor.h"
#include "calib/model/errors.h"

namespace rgbdt {
namespace {

[[noreturn]] void Fail(const std::string& what, const std::filesystem::path& path, int error) {
  throw InputError("cannot " + what + " " + path.string() + ": " + std::strerror(error));
}

/// One that is open for reading.
class RegularFile {
 public:
  // Without O_NONBLOCK a pipe that nobody writes to is waited for.
  explicit RegularFile(const std::filesystem::path& path)
      : path_(path), file_(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {
    if (file_.get() < 0) Fail("read", path, errno);
    struct stat status {};
    if (::fstat(file_.get(), &status) != 0) Fail("read", path, errno);
    if (S_ISDIR(status.st_mode)) Fail("read", path, EISDIR);
    if (!S_ISREG(status.st_mode)) {
      throw InputError("cannot read " + path.string() +
                       ": it is a pipe, a socket or a device; expected a file");
    }
    size_ = static_cast<std::uintmax_t>(status.st_size);
  }

  std::uintmax_t size() const { return size_; }

  std::string Read(std::uintmax_t most_bytes) const {
    std::string bytes;
    std::string buffer(1 << 16, '\0');
    bytes.reserve(static_cast<std::size_t>(std::min(size_, most_bytes)));
    while (bytes.size() < most_bytes) {
      const auto wanted = std::min<std::uintmax_t>(buffer.size(), most_bytes - bytes.size());
      const ssize_t n = ::read(file_.get(), buffer.data(), static_cast<std::size_t>(wanted));
      if (n < 0 && errno == EINTR) continue;
      if (n < 0) Fail("read", path_, errno);
      if (n == 0) break;
      bytes.append(buffer, 0, static_cast<std::size_t>(n));
    }
    return bytes;
  }

 private:
  const std::filesystem::path& path_;
  Descriptor file_;
  std::uintmax_t size_ = 0;
};

// Returns 0 or errno.
int WriteAll(int fd, std::string_view bytes) {
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t n = ::write(fd, bytes.data() + done, bytes.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return errno;
    done += static_cast<std::size_t>(n);
  }
  return 0;
}

// So that the rename itself survives a power cut. Some file systems refuse: nothing is lost then.
void SyncFolder(const std::filesystem::path& folder) {
  Descriptor fd(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (fd.get() >= 0) ::fsync(fd.get());
}

std::filesystem::path FolderOf(const std::filesystem::path& path) {
  return path.has_parent_path() ? path.parent_path() : ".";
}

}  // namespace

AtomicFile::AtomicFile(std::filesystem::path path) : path_(std::move(path)) {
  const std::filesystem::path folder = FolderOf(path_);
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) Fail("create the folder", folder, error.value());

  static std::atomic<unsigned> count{0};
  const std::string name = ".tmp-" + std::to_string(::getpid()) + "-";
  int why = 0;
  do {  // one may be left over of a process that was killed and had this number
    const std::filesystem::path temporary = folder / (name + std::to_string(count++));
    descriptor_ = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    why = descriptor_ < 0 ? errno : 0;
    if (why == 0) temporary_ = temporary;
  } while (why == EEXIST);
  if (why != 0) Fail("write", path_, why);
}

AtomicFile::~AtomicFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
}

void AtomicFile::Write(std::string_view bytes) {
  if (const int error = WriteAll(descriptor_, bytes)) Fail("write", path_, error);
}

void AtomicFile::Commit() {
  if (::fsync(descriptor_) != 0) Fail("write", path_, errno);
  if (::close(std::exchange(descriptor_, -1)) != 0) Fail("write", path_, errno);
  if (::rename(temporary_.c_str(), path_.c_str()) != 0) Fail("write", path_, errno);
  temporary_.clear();
  SyncFolder(FolderOf(path_));
}

void WriteFileAtomically(const std::filesystem::path& path, const std::string& bytes) {
  AtomicFile file(path);
  file.Write(bytes);
  file.Commit();
}

void Rename(const std::filesystem::path& from, const std::filesystem::path& to) {
  if (::rename(from.c_str(), to.c_str()) != 0) {
    Fail("rename " + from.string() + " to", to, errno);
  }
  SyncFolder(to.has_parent_path() ? to.parent_path() : ".");
}

std::string ReadWholeFile(const std::filesystem::path& path, std::uintmax_t most_bytes) {
  const RegularFile file(path);
  if (file.size() > most_bytes) {
    throw InputError("cannot read " + path.string() + ": it has " + std::to_string(file.size()) +
                     " bytes; expected at most " + std::to_string(most_bytes));
  }
  // Files of the kernel's own say that they are empty.
  const bool sized = file.size() > 0;
  return file.Read(sized ? file.size() : most_bytes);
}

std::string ReadFileHead(const std::filesystem::path& path, std::size_t head_bytes) {
  return RegularFile(path).Read(head_bytes);
}

}  // namespace rgbdt
