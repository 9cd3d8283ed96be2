#include "services/bus/signed_bus.h"

#include <memory>
#include <utility>

#include "calib/model/errors.h"
#include "services/messages/limits.h"

namespace rgbdt {

SignedBus::SignedBus(Bus* bus, const BusKey& key, WallClock clock)
    : bus_(bus), key_(key), signer_(key), clock_(std::move(clock)) {}

void SignedBus::Publish(const std::string& channel, const Bytes& bytes) {
  if (!IsSignedChannel(channel)) return bus_->Publish(channel, bytes);
  if (bytes.size() + kSignatureBytes > kMaxMessageBytes) {
    throw InputError("the message has " + std::to_string(bytes.size()) +
                     " bytes; signed, the bus carries " +
                     std::to_string(kMaxMessageBytes - kSignatureBytes));
  }
  Bytes message = bytes;
  signer_.Sign(channel, clock_(), &message);
  bus_->Publish(channel, message);
}

// Each subscriber has a check of its own: it gets a message once, whoever else got it before.
void SignedBus::Subscribe(const std::string& channel_regex, Handler handler) {
  const auto check = std::make_shared<SignatureCheck>(key_);
  bus_->Subscribe(channel_regex, [this, check, handler = std::move(handler)](
                                     const std::string& channel, const std::uint8_t* data,
                                     std::size_t size) {
    if (!IsSignedChannel(channel)) return handler(channel, data, size);
    const Utime arrival = bus_->arrived();
    const std::string why = check->WhyNot(channel, data, size, arrival != 0 ? arrival : clock_());
    if (!why.empty()) return Refuse(channel, why);
    handler(channel, data, size - kSignatureBytes);
  });
}

void SignedBus::Refuse(const std::string& channel, const std::string& why) {
  ++refused_.count;
  refused_.newest = channel + " " + why;
}

}  // namespace rgbdt
