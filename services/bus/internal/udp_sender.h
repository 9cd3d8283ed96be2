#pragma once

#include <netinet/in.h>

#include <mutex>
#include <string>

#include "calib/model/descriptor.h"
#include "calib/model/time.h"
#include "services/bus/bus_url.h"
#include "services/bus/internal/sent_messages.h"

namespace rgbdt {

/// Sends on a bus that leaves the machine, as LCM does but in datagrams that fit an Ethernet's
/// frame, and repeats what receivers ask for. Any thread may call.
class UdpSender {
 public:
  /// After a message the Beat says that it was sent: it may be lost, and with it the sign that one
  /// is missing. Shortly after, then after longer pauses, then once a second.
  static constexpr Utime kFirstBeat = 20'000;

  /// Throws InputError: what the kernel refuses.
  explicit UdpSender(const BusUrl& url);

  /// Throws InputError where it cannot be sent.
  void Publish(const std::string& channel, const Bytes& bytes);

  /// What a receiver asks of this sender or of another one, which is then not ours to answer.
  void Answer(const RepairRequest& request);
  void Ask(const RepairRequest& request);
  void BeatIfDue(Utime now);
  Utime NextBeat() const;
  /// A moment more for who lost the last messages.
  bool WaitsForRequests(Utime now) const;

 private:
  void SendControl(const Bytes& payload);
  void SendBeat();

  mutable std::mutex mutex_;  // of all below: a Beat's numbers are those of what went before it
  Descriptor socket_;
  sockaddr_in group_;
  std::string host_;
  std::uint64_t id_;
  SentMessages sent_;
  std::uint64_t datagrams_ = 0;
  Utime published_ = 0, beaten_ = 0, beat_at_ = 0, pause_ = kFirstBeat;
};

}  // namespace rgbdt
