#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "calib/model/time.h"
#include "services/bus/link_report.h"
#include "services/messages/bytes.h"

namespace rgbdt {

/// Datagrams that were no messages, or contradicted each other. They were dropped.
struct Malformed {
  std::int64_t count = 0;
  std::string newest;  ///< "10.0.0.2:40000: a fragment beyond its message's end"
};

/// Messages that a process with a key did not take (signed_bus.h).
struct Unsigned {
  std::int64_t count = 0;
  std::string newest;  ///< "SESSION_COMMAND is not signed; ..."
};

/// A publish-subscribe bus of named channels.
class Bus {
 public:
  using Handler =
      std::function<void(const std::string& channel, const std::uint8_t* data, std::size_t size)>;
  virtual ~Bus() = default;
  /// Throws InputError where the message cannot be sent.
  virtual void Publish(const std::string& channel, const Bytes& bytes) = 0;
  /// `channel_regex` must match the whole channel name. Throws InputError if it is none.
  virtual void Subscribe(const std::string& channel_regex, Handler handler) = 0;
  virtual Malformed malformed() const { return {}; }
  virtual LinkReport links() const { return {}; }
  virtual Unsigned refused() const { return {}; }
  /// When the message that a handler has just got reached this machine [us, UTC, wall clock]; 0:
  /// it did not wait.
  virtual Utime arrived() const { return 0; }
};

/// Delivers within one process, in the order published: a message published by a handler waits
/// until those before it are delivered. Subscribers get a message in the order they subscribed,
/// and what is published from then on.
class MemoryBus : public Bus {
 public:
  MemoryBus();
  ~MemoryBus() override;
  void Publish(const std::string& channel, const Bytes& bytes) override;
  void Subscribe(const std::string& channel_regex, Handler handler) override;
  /// Delivers until nothing waits. Not from within a handler. An exception of a handler comes out
  /// here; that message counts as delivered, the others still wait.
  void Run();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// LCM. An empty URL means LCM_DEFAULT_URL or LCM's default, with a receive buffer of 32 MiB asked
/// for where the URL says none. What a udpm bus carries is received by code of our own, as LCM's
/// believes whatever a datagram says; LCM sends, and reads file:// URLs. With ttl=0 the bus hears
/// this machine only. With a higher one we send, too: in datagrams that fit an Ethernet's frame,
/// of which a receiver that is an LcmBus asks for those that were lost; it so has each sender's
/// messages in order. Exceptions of handlers never reach C code.
class LcmBus : public Bus {
 public:
  /// Throws InputError: which URL, why, and what to do.
  explicit LcmBus(const std::string& url);
  ~LcmBus() override;
  void Publish(const std::string& channel, const Bytes& bytes) override;
  void Subscribe(const std::string& channel_regex, Handler handler) override;
  Malformed malformed() const override;
  LinkReport links() const override;
  Utime arrived() const override;
  /// Who subscribes from now on wants what is new rather than all: of images more than 20 MiB and
  /// of clouds more than 8 MiB do not wait for their handlers, the oldest go.
  void WantNewest();
  /// Whether a message waits for its handler.
  bool waits() const;
  /// Waits up to `timeout_ms` for messages and delivers what is there, but for no longer than some
  /// 100 ms, so that the caller's clock keeps running under load. False: none came.
  bool Run(int timeout_ms);
  /// Nothing will come any more: the end of a file:// URL's log.
  bool ended() const;
  /// Exceptions that handlers let out; each was caught here and its message is gone.
  std::int64_t handler_failures() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The URL that LcmBus opens: LCM_DEFAULT_URL or LCM's default for an empty one, with
/// recv_buf_size added to a udpm one that has none.
std::string CompleteUrl(const std::string& url);

/// Empty if this host grants LCM's sockets the 32 MiB that large messages need; otherwise one line:
/// what follows and the command.
std::string ReceiveBufferAdvice();

}  // namespace rgbdt
