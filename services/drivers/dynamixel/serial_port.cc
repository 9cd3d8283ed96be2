#include "services/drivers/dynamixel/serial_port.h"

// The kernel's termios2 takes any baud rate as a number; <termios.h> knows only a list of them
// and cannot be included beside it.
#include <asm/termbits.h>
#include <fcntl.h>
#include <linux/serial.h>
#include <poll.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "services/runtime/device_thread.h"

namespace rgbdt {
namespace {

constexpr std::int64_t kWriteTimeoutUs = 1'000'000;

std::string Advice(int error, const std::string& path) {
  switch (error) {
    case EACCES:
    case EPERM:
      return "; no permission: `sudo usermod -aG dialout $USER`, then log out and in again";
    case ENOENT:
    case ENODEV:
    case ENXIO:
      return "; is it plugged in? `ls /dev/serial/by-id` shows what is there";
    case EBUSY:
      return "; another program has it: `sudo fuser -v " + path + "` says which";
    default:
      return "";
  }
}

}  // namespace

SerialPort::SerialPort(const std::string& path, int baud) : path_(path) {
  Open();
  try {
    Configure(baud);
  } catch (...) {
    close(fd_);
    throw;
  }
}

SerialPort::~SerialPort() {
  // On a pseudo-terminal the mark would outlive this process.
  ioctl(fd_, TIOCNXCL);
  close(fd_);
}

void SerialPort::Fail(const std::string& what) const {
  const int error = errno;
  throw DeviceError("serial port " + path_ + ": " + what + ": " + std::strerror(error) +
                    Advice(error, path_));
}

void SerialPort::Open() {
  fd_ = open(path_.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (fd_ < 0) Fail("cannot be opened");
}

void SerialPort::Configure(int baud) {
  // The lock also keeps out who may open the port nevertheless (root).
  if (flock(fd_, LOCK_EX | LOCK_NB) != 0) {
    errno = EBUSY;
    Fail("cannot be opened");
  }
  termios2 settings{};
  if (ioctl(fd_, TCGETS2, &settings) != 0) Fail("is not a serial port");
  ioctl(fd_, TIOCEXCL);
  settings.c_iflag = IGNPAR;
  settings.c_oflag = 0;
  settings.c_lflag = 0;
  settings.c_cflag = CS8 | CREAD | CLOCAL | BOTHER;
  settings.c_ispeed = settings.c_ospeed = static_cast<speed_t>(baud);
  settings.c_cc[VMIN] = 0;
  settings.c_cc[VTIME] = 0;
  if (ioctl(fd_, TCSETS2, &settings) != 0) {
    Fail("does not take " + std::to_string(baud) + " baud");
  }
  // USB adapters otherwise keep a short answer for 16 ms. Not all drivers know of it.
  serial_struct serial{};
  if (ioctl(fd_, TIOCGSERIAL, &serial) == 0) {
    serial.flags |= ASYNC_LOW_LATENCY;
    ioctl(fd_, TIOCSSERIAL, &serial);
  }
  Discard();
}

bool SerialPort::Wait(short events, std::int64_t timeout_us) {
  pollfd waiting{fd_, events, 0};
  const timespec timeout{timeout_us / 1'000'000, timeout_us % 1'000'000 * 1000};
  const int ready = ppoll(&waiting, 1, &timeout, nullptr);
  if (ready < 0 && errno != EINTR) Fail("cannot be waited for");
  if (ready > 0 && (waiting.revents & (POLLHUP | POLLERR | POLLNVAL)) != 0) {
    errno = ENODEV;
    Fail("has gone");
  }
  return ready > 0;
}

void SerialPort::Write(const std::vector<std::uint8_t>& bytes) {
  for (std::size_t sent = 0; sent < bytes.size();) {
    const ssize_t now = write(fd_, bytes.data() + sent, bytes.size() - sent);
    if (now > 0) {
      sent += static_cast<std::size_t>(now);
    } else if (now == 0 || errno == EAGAIN) {
      errno = ETIMEDOUT;
      if (!Wait(POLLOUT, kWriteTimeoutUs)) Fail("takes nothing more");
    } else if (errno != EINTR) {
      Fail("cannot be written");
    }
  }
}

std::vector<std::uint8_t> SerialPort::Read(std::int64_t timeout_us) {
  std::vector<std::uint8_t> bytes(1024);
  ssize_t size = 0;
  if (Wait(POLLIN, timeout_us)) size = read(fd_, bytes.data(), bytes.size());
  if (size < 0 && errno != EAGAIN && errno != EINTR) Fail("cannot be read");
  bytes.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
  return bytes;
}

void SerialPort::Discard() {
  constexpr int kMaxReads = 64;  // a device that never stops talking is not waited for
  for (int i = 0; i < kMaxReads && !Read(0).empty(); ++i) {
  }
}

}  // namespace rgbdt
