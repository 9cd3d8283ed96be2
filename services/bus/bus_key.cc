#include "services/bus/bus_key.h"

#include <fcntl.h>
#include <sodium.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "calib/model/descriptor.h"
#include "calib/model/errors.h"

namespace rgbdt {
namespace {

constexpr std::size_t kDigits = 2 * sizeof(BusKey::bytes);
constexpr mode_t kOwnerOnly = 0600;
constexpr mode_t kTooOpen = 0037;  // others at all, or the group more than to read

[[noreturn]] void Fail(const std::filesystem::path& file, const std::string& what) {
  throw InputError(file.string() + ": " + what);
}

std::string Hexadecimal(const BusKey& key) {
  std::string digits(kDigits + 1, '\0');
  sodium_bin2hex(digits.data(), digits.size(), key.bytes.data(), key.bytes.size());
  digits.back() = '\n';
  return digits;
}

// A pipe that nobody writes to is not waited for.
std::string ReadDigits(const std::filesystem::path& file) {
  const Descriptor in(open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  struct stat status {};
  if (!in || fstat(in.get(), &status) != 0) Fail(file, std::strerror(errno));
  if (!S_ISREG(status.st_mode)) Fail(file, "is no regular file; expected a key of rgbdt key");
  if ((status.st_mode & kTooOpen) != 0) {
    Fail(file, "others than its owner may read or change this key; chmod 600 " + file.string());
  }
  std::string digits(kDigits + 2, '\0');  // one more than there is to be
  const ssize_t got = read(in.get(), digits.data(), digits.size());
  if (got < 0) Fail(file, std::strerror(errno));
  digits.resize(static_cast<std::size_t>(got));
  if (!digits.empty() && digits.back() == '\n') digits.pop_back();
  return digits;
}

}  // namespace

void WriteNewBusKey(const std::filesystem::path& file) {
  if (sodium_init() < 0) Fail(file, "libsodium finds no random numbers");
  BusKey key;
  randombytes_buf(key.bytes.data(), key.bytes.size());
  const Descriptor out(open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, kOwnerOnly));
  if (!out && errno == EEXIST) {
    Fail(file, "exists already and is left as it is; name another file, or remove this one first");
  }
  if (!out) Fail(file, std::strerror(errno));
  const std::string digits = Hexadecimal(key);
  const bool written =
      write(out.get(), digits.data(), digits.size()) == static_cast<ssize_t>(digits.size()) &&
      fsync(out.get()) == 0;
  if (written) return;
  const std::string why = std::strerror(errno);
  unlink(file.c_str());
  Fail(file, "cannot be written: " + why);
}

BusKey ReadBusKey(const std::filesystem::path& file) {
  if (sodium_init() < 0) Fail(file, "libsodium does not start");
  const std::string digits = ReadDigits(file);
  BusKey key;
  std::size_t bytes = 0;
  const char* end = nullptr;
  const bool good = sodium_hex2bin(key.bytes.data(), key.bytes.size(), digits.data(), digits.size(),
                                   nullptr, &bytes, &end) == 0 &&
                    bytes == key.bytes.size() && digits.size() == kDigits;
  if (!good) {
    Fail(file, "is no key: expected a line of 64 hexadecimal digits, as rgbdt key writes it");
  }
  return key;
}

std::filesystem::path BusKeyFile(const std::string& given) {
  if (!given.empty()) return given;
  const char* environment = std::getenv("RGBDT_KEY");
  return environment == nullptr ? "" : environment;
}

}  // namespace rgbdt
