#include "tests/hardware/dynamixel_peer.h"

#include <asm/termbits.h>
#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <stdexcept>

namespace rgbdt::test {
namespace {

// The control table of the Dynamixel Pro.
constexpr int kReturnDelay = 9, kOperatingMode = 11, kMaxPosition = 36, kMinPosition = 40;
constexpr int kTorqueEnable = 562, kGoalPosition = 596, kGoalVelocity = 600;
constexpr int kGoalAcceleration = 606, kPresentPosition = 611, kHardwareError = 892;
constexpr int kTableEnd = 893;
constexpr double kTicksPerTurn = 501923, kTurnsPerMinuteAUnit = 0.00199234;
constexpr double kTurnsPerMinute2AUnit = 58000 * kTurnsPerMinuteAUnit;

double Now() {
  timespec now{};
  clock_gettime(CLOCK_REALTIME, &now);
  return static_cast<double>(now.tv_sec) * 1e6 + static_cast<double>(now.tv_nsec) / 1e3;
}

// Sleeps most of the time and watches the clock for the rest: the scheduler is not as exact.
void WaitUntil(double utime) {
  constexpr double kWatched = 80;
  const double sleep_us = utime - Now() - kWatched;
  if (sleep_us > 0) usleep(static_cast<useconds_t>(sleep_us));
  while (Now() < utime) {
  }
}

// A servo does nothing else: it wakes up exactly when it is to, and before all others. Where that
// priority may not be had it has to do without.
void TakePriority() {
  prctl(PR_SET_TIMERSLACK, 1UL);
  sched_param priority{};
  priority.sched_priority = 1;
  pthread_setschedparam(pthread_self(), SCHED_RR, &priority);
}

unsigned Crc(const PeerBytes& bytes, std::size_t size) {
  unsigned crc = 0;
  for (std::size_t i = 0; i < size; ++i) {
    for (unsigned mask = 0x80; mask != 0; mask >>= 1) {
      const bool top = (crc & 0x8000) != 0;
      const bool bit = (bytes[i] & mask) != 0;
      crc = (crc << 1) & 0xFFFF;
      if (top != bit) crc ^= 0x8005;
    }
  }
  return crc;
}

PeerBytes LittleEndian(std::int64_t value, int size) {
  PeerBytes bytes;
  for (; size > 0; --size, value >>= 8) bytes.push_back(static_cast<std::uint8_t>(value & 0xFF));
  return bytes;
}

std::int64_t Number(const PeerBytes& bytes) {
  std::int64_t value = bytes.back() < 0x80 ? 0 : -1;
  for (auto byte = bytes.rbegin(); byte != bytes.rend(); ++byte) value = value * 256 + *byte;
  return value;
}

}  // namespace

PeerBytes PeerStatusPacket(int id, int error, const PeerBytes& parameters) {
  PeerBytes packet = {0xFF,
                      0xFF,
                      0xFD,
                      0x00,
                      static_cast<std::uint8_t>(id),
                      0,
                      0,
                      0x55,
                      static_cast<std::uint8_t>(error)};
  int run = 0;  // how much of FF FF FD the last bytes are
  for (const std::uint8_t byte : parameters) {
    packet.push_back(byte);
    if (run == 2 && byte == 0xFD) {
      packet.push_back(0xFD);
      run = 0;
    } else {
      run = byte == 0xFF ? std::min(run + 1, 2) : 0;
    }
  }
  packet[5] = static_cast<std::uint8_t>((packet.size() - 5) & 0xFF);  // 7 before, 2 to come
  packet[6] = static_cast<std::uint8_t>((packet.size() - 5) >> 8);
  const unsigned crc = Crc(packet, packet.size());
  packet.push_back(static_cast<std::uint8_t>(crc & 0xFF));
  packet.push_back(static_cast<std::uint8_t>(crc >> 8));
  return packet;
}

std::optional<PeerInstruction> PeerTakeInstruction(PeerBytes* stream) {
  const PeerBytes header = {0xFF, 0xFF, 0xFD, 0x00};
  for (;;) {
    const auto begin = std::search(stream->begin(), stream->end(), header.begin(), header.end());
    if (stream->end() - begin < 10) return std::nullopt;
    stream->erase(stream->begin(), begin);
    const std::size_t size = 7u + (*stream)[5] + 256u * (*stream)[6];
    if (stream->size() < size) return std::nullopt;
    const PeerBytes packet(stream->begin(), stream->begin() + static_cast<std::ptrdiff_t>(size));
    stream->erase(stream->begin(), stream->begin() + static_cast<std::ptrdiff_t>(size));
    if (Crc(packet, size - 2) != packet[size - 2] + 256u * packet[size - 1]) continue;
    PeerInstruction found{packet[4], packet[7], {}};
    for (std::size_t i = 8; i < size - 2; ++i) {
      const bool stuffed = packet[i] == 0xFD && packet[i - 1] == 0xFD && packet[i - 2] == 0xFF &&
                           packet[i - 3] == 0xFF;
      if (!stuffed) found.parameters.push_back(packet[i]);
    }
    return found;
  }
}

DynamixelPeer::DynamixelPeer(const Options& options)
    : options_(options), motion_(options.position) {
  const auto put = [this](int address, std::int64_t value, int size) {
    for (const std::uint8_t byte : LittleEndian(value, size)) table_[address++] = byte;
  };
  put(0, options.model, 2);
  put(kReturnDelay, options.return_delay, 1);
  put(kOperatingMode, options.operating_mode, 1);
  put(kMaxPosition, options.max_position, 4);
  put(kMinPosition, options.min_position, 4);
  PlugIn();
}

DynamixelPeer::~DynamixelPeer() {
  Unplug();
  if (!options_.link.empty()) unlink(options_.link.c_str());
}

void DynamixelPeer::PlugIn() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    master_ = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
    char name[64];
    if (master_ < 0 || grantpt(master_) != 0 || unlockpt(master_) != 0 ||
        ptsname_r(master_, name, sizeof name) != 0) {
      throw std::runtime_error("no pseudo-terminal to be had");
    }
    // Kept open, so that the line stands when the driver is not there; raw, so that it echoes not.
    slave_ = open(name, O_RDWR | O_NOCTTY | O_CLOEXEC);
    termios2 raw{};
    ioctl(slave_, TCGETS2, &raw);
    raw.c_iflag = raw.c_oflag = raw.c_lflag = 0;
    ioctl(slave_, TCSETS2, &raw);
    port_ = name;
    if (!options_.link.empty()) {
      unlink(options_.link.c_str());
      if (symlink(name, options_.link.c_str()) != 0) throw std::runtime_error(options_.link);
      port_ = options_.link;
    }
  }
  stopping_ = false;
  thread_ = std::thread([this] { Run(); });
}

void DynamixelPeer::Unplug() {
  stopping_ = true;
  if (!thread_.joinable()) return;
  thread_.join();
  const std::lock_guard<std::mutex> lock(mutex_);
  close(master_);
  close(slave_);
  master_ = slave_ = -1;
}

std::string DynamixelPeer::port() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return port_;
}

void DynamixelPeer::SetFaults(const Faults& faults) {
  const std::lock_guard<std::mutex> lock(mutex_);
  faults_ = faults;
  if (faults.hardware_error != 0) {
    table_[kTorqueEnable] = 0;
    state_.torque = false;
    motion_.Stop(Now());
  }
  if (state_.torque && faults.stall_at) Move();
}

DynamixelPeer::State DynamixelPeer::state() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  State state = state_;
  state.return_delay = table_.at(kReturnDelay);
  return state;
}

double DynamixelPeer::TrueTicksAt(double utime) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return motion_.PositionAt(utime);
}

double DynamixelPeer::TrueSpeedAt(double utime) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return motion_.VelocityAt(utime);
}

// The line's baud rate is what the driver has set: 10 bits a byte.
double DynamixelPeer::ByteUs() const {
  termios2 line{};
  ioctl(slave_, TCGETS2, &line);
  return line.c_ospeed > 0 ? 1e7 / line.c_ospeed : 0;
}

void DynamixelPeer::Run() {
  constexpr int kWaitMs = 5;
  PeerBytes stream;
  TakePriority();
  while (!stopping_) {
    pollfd waiting{master_, POLLIN, 0};
    if (poll(&waiting, 1, kWaitMs) <= 0) continue;
    std::uint8_t bytes[256];
    const ssize_t size = read(master_, bytes, sizeof bytes);
    const double came = Now();
    if (size <= 0) continue;
    stream.insert(stream.end(), bytes, bytes + size);
    while (const auto instruction = PeerTakeInstruction(&stream)) {
      WaitUntil(came + static_cast<double>(size) * ByteUs());
      Answer(*instruction);
    }
  }
}

void DynamixelPeer::Answer(const PeerInstruction& instruction) {
  constexpr int kPing = 1, kRead = 2, kWrite = 3;
  if (instruction.id != options_.id) return;
  WaitUntil(Now() + options_.sample_latency_us);
  std::unique_lock<std::mutex> lock(mutex_);
  if (faults_.silent) return;
  const PeerBytes& in = instruction.parameters;
  const int address = in.size() >= 2 ? in[0] + 256 * in[1] : 0;
  int error = 0;
  PeerBytes out;
  if (instruction.instruction == kPing) {
    out = {table_[0], table_[1], 38};
  } else if (instruction.instruction == kRead && in.size() == 4) {
    out = Read(address, in[2] + 256 * in[3]);
    if (out.empty()) error = 7;
  } else if (instruction.instruction == kWrite && in.size() > 2) {
    error = Write(address, PeerBytes(in.begin() + 2, in.end()));
  } else {
    error = 2;
  }
  if (faults_.hardware_error != 0) error |= 0x80;
  const double delay_us = options_.reply_latency_us + 2 * table_[kReturnDelay];
  lock.unlock();
  WaitUntil(Now() + delay_us);
  Reply(error, out);
}

void DynamixelPeer::Reply(int error, const PeerBytes& parameters) {
  PeerBytes packet = PeerStatusPacket(options_.id, error, parameters);
  Faults faults;
  int number = 0;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    faults = faults_;
    number = ++state_.answers;
  }
  if (faults.bad_checksum_every > 0 && number % faults.bad_checksum_every == 0) packet.back() ^= 1;
  WaitUntil(Now() + static_cast<double>(packet.size()) * ByteUs());
  const PeerBytes rubbish = {0xFF, 0xFF, 0xFD, 0x00, 0x01, 0xFF, 0x00, 0x55, 0x12};
  PeerBytes sent;
  for (int i = 0; i < faults.noise_bytes; ++i) {
    sent.push_back(rubbish[static_cast<std::size_t>(number + i) % rubbish.size()]);
  }
  sent.insert(sent.end(), packet.begin(), packet.end());
  if (write(master_, sent.data(), sent.size()) < 0) stopping_ = true;
}

PeerBytes DynamixelPeer::Read(int address, int size) const {
  if (size < 1 || address + size > kTableEnd) return {};
  if (address == kPresentPosition) return LittleEndian(std::lround(motion_.PositionAt(Now())), 4);
  if (address == kHardwareError) return LittleEndian(faults_.hardware_error, 1);
  PeerBytes value;
  for (int i = 0; i < size; ++i) {
    const auto byte = table_.find(address + i);
    value.push_back(byte == table_.end() ? 0 : byte->second);
  }
  return value;
}

int DynamixelPeer::Write(int address, const PeerBytes& value) {
  constexpr int kAccess = 7, kLimit = 6, kEndOfEeprom = 562;
  if (address < 7 || (address < kEndOfEeprom && state_.torque)) return kAccess;
  const std::int64_t number = Number(value);
  if (address == kGoalPosition &&
      (number < options_.min_position || number > options_.max_position)) {
    return kLimit;
  }
  for (std::size_t i = 0; i < value.size(); ++i) table_[address + static_cast<int>(i)] = value[i];
  if (address == kTorqueEnable) {
    state_.torque = number != 0 && faults_.hardware_error == 0;
    if (!state_.torque) motion_.Stop(Now());
  }
  if (address == kGoalPosition) {
    state_.goal = number;
    if (state_.torque) ++state_.moves;
  }
  if (state_.torque) Move();
  return 0;
}

void DynamixelPeer::Move() {
  const double ticks_per_second = kTicksPerTurn / 60 * kTurnsPerMinuteAUnit;
  const double ticks_per_second2 = kTicksPerTurn / 3600 * kTurnsPerMinute2AUnit;
  const double speed = static_cast<double>(Number(Read(kGoalVelocity, 4))) * ticks_per_second;
  const double acceleration =
      static_cast<double>(Number(Read(kGoalAcceleration, 4))) * ticks_per_second2;
  if (speed <= 0 || acceleration <= 0) return;
  const double goal = static_cast<double>(Number(Read(kGoalPosition, 4)));
  motion_.GoTo(goal, Now(), speed, acceleration, faults_.stall_at);
}

}  // namespace rgbdt::test
