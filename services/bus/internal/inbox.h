#pragma once

#include <cstdint>
#include <deque>
#include <list>
#include <map>
#include <mutex>
#include <regex>
#include <string>
#include <vector>

#include "calib/model/descriptor.h"
#include "services/bus/bus.h"
#include "services/bus/internal/reassembly.h"
#include "services/bus/internal/source.h"

namespace rgbdt {

/// Messages on their way from the thread that receives them to the one that handles them, in the
/// order in which they came. Where there is no room for one, the oldest image that waits gives way;
/// where none waits, the new message is missed: of a subscriber's queue, or, where so many bytes
/// wait that another message would make them more than `max_bytes`, of all. The last kForSmall
/// bytes are for messages of at most kSmall, so that images and clouds leave room for commands.
/// Where a subscriber wants the newest, the oldest of its queue give way, whatever they are. Each
/// leaves a gap in its sender's numbers.
class Inbox {
 public:
  static constexpr std::size_t kMaxBytes = std::size_t{256} << 20;
  static constexpr std::size_t kForSmall = std::size_t{16} << 20, kSmall = std::size_t{64} << 10;

  /// Throws InputError where the kernel gives no descriptor.
  explicit Inbox(std::size_t max_bytes = kMaxBytes);

  // Of any thread.
  bool IsWanted(const std::string& channel);
  void Add(WholeMessage message);
  void AddMalformed(const std::string& what);
  Malformed malformed() const;

  // Of the thread that handles.
  /// Throws InputError where `channel_regex` is none.
  void Subscribe(const std::string& channel_regex, const Room& room, Bus::Handler handler);
  int descriptor() const { return waits_.get(); }  ///< readable while a message waits
  void DeliverOne();
  Utime arrived() const { return arrived_; }  ///< when the newest delivered one was added

 private:
  struct Subscriber {
    std::regex regex;
    Room room;
    Bus::Handler handler;
    std::size_t waiting = 0, bytes = 0;
  };
  struct Waiting {
    WholeMessage message;
    std::vector<Subscriber*> to;
    Utime arrived = 0;
  };
  using Queue = std::list<Waiting>;

  const std::vector<Subscriber*>& Hearing(const std::string& channel);
  Queue::iterator Oldest(const Subscriber& of, bool image);
  bool MakeRoom(std::size_t bytes, Subscriber* subscriber);
  bool MakeRoom(std::size_t bytes);
  void LeaveOut(Queue::iterator waiting, Subscriber* subscriber);
  Queue Remove(Queue::iterator waiting);
  void Signal();

  mutable std::mutex mutex_;  // of all below but the handlers
  Descriptor waits_;
  std::deque<Subscriber> subscribers_;  // their addresses stay
  std::map<std::string, std::vector<Subscriber*>> hearing_;
  Queue waiting_;
  bool signalled_ = false;             // waits_ is readable
  std::size_t images_ = 0;             // of them
  std::size_t max_bytes_, bytes_ = 0;  // of those that wait
  Malformed malformed_;
  Utime arrived_ = 0;  // of the thread that handles
};

}  // namespace rgbdt
