#include "services/bags/internal/bag_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "calib/model/errors.h"
#include "services/bags/printable.h"

namespace rgbdt::bags {
namespace {

[[noreturn]] void ThrowErrno(const std::string& path) {
  throw InputError("cannot read " + path + ": " + std::strerror(errno));
}

// ROS 2's types have "msg/" in the middle: the messages that we read are the same in both.
std::string PlainType(std::string type) {
  const std::size_t middle = type.find("/msg/");
  if (middle != std::string::npos) type.erase(middle, 4);
  return type;
}

}  // namespace

BagFile::BagFile(const std::filesystem::path& path)
    : path_(path.string()), descriptor_(open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {
  struct stat status = {};
  if (!descriptor_ || fstat(descriptor_.get(), &status) != 0) ThrowErrno(path_);
  if (!S_ISREG(status.st_mode)) {
    throw InputError("cannot read " + path_ + ": it is no regular file; expected a bag");
  }
  size_ = status.st_size;
}

std::size_t BagFile::Read(std::int64_t from, void* to, std::size_t bytes) const {
  std::size_t done = 0;
  while (done < bytes) {
    const ssize_t got = pread(descriptor_.get(), static_cast<char*>(to) + done, bytes - done,
                              from + static_cast<std::int64_t>(done));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw DiskError("cannot read " + path_ + ": " + std::strerror(errno));
    if (got == 0) break;
    done += static_cast<std::size_t>(got);
  }
  return done;
}

bool BagFile::ReadAll(std::int64_t from, std::size_t bytes, std::vector<std::uint8_t>* to) const {
  if (from < 0 || from > size_ || static_cast<std::uint64_t>(size_ - from) < bytes) return false;
  to->resize(bytes);
  return Read(from, to->data(), bytes) == bytes;
}

std::size_t TopicList::Add(const std::string& name, const std::string& type, BagEncoding encoding) {
  const BagTopic topic{Printable(name), PlainType(Printable(type)), encoding};
  const std::string key =
      topic.name + '\n' + topic.type + '\n' + std::to_string(static_cast<int>(encoding));
  const auto [found, is_new] = index_.try_emplace(key, topics_.size());
  if (!is_new) return found->second;
  if (topics_.size() == kMostBagTopics) {
    throw InputError("the bag has more than " + std::to_string(kMostBagTopics) +
                     " topics; is it damaged?");
  }
  topics_.push_back(topic);
  return found->second;
}

void Problems::Add(const std::string& line) {
  constexpr std::size_t kMost = 10;
  if (lines_.size() < kMost) {
    lines_.push_back(line);
    return;
  }
  if (++more_ == 1) lines_.emplace_back();
  lines_.back() = "and " + std::to_string(more_) + " more like these";
}

}  // namespace rgbdt::bags
