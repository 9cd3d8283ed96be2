#pragma once

#include <functional>
#include <string>

#include "calib/model/time.h"
#include "services/bus/bus.h"
#include "services/bus/signature.h"

namespace rgbdt {

/// A bus for a process with a key: what commands, decides and reports (IsSignedChannel) goes out
/// signed, and what comes in there unsigned, wrongly signed or once more does not reach handlers;
/// it is counted and named. All else passes as it is.
class SignedBus : public Bus {
 public:
  using WallClock = std::function<Utime()>;  ///< [us, UTC]

  /// `bus` outlives it, and it outlives the bus' deliveries.
  SignedBus(Bus* bus, const BusKey& key, WallClock clock);

  void Publish(const std::string& channel, const Bytes& bytes) override;
  void Subscribe(const std::string& channel_regex, Handler handler) override;
  Malformed malformed() const override { return bus_->malformed(); }
  LinkReport links() const override { return bus_->links(); }
  Unsigned refused() const override { return refused_; }
  Utime arrived() const override { return bus_->arrived(); }

 private:
  void Refuse(const std::string& channel, const std::string& why);

  Bus* bus_;
  BusKey key_;
  MessageSigner signer_;
  WallClock clock_;
  Unsigned refused_;
};

}  // namespace rgbdt
