#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "viewer/server/internal/channels.h"

namespace rgbdt::viewer {

// Foxglove's WebSocket protocol (github.com/foxglove/ws-protocol, docs/spec.md), the part of it
// that only shows: no publishing, no parameters, services or assets. Subprotocols
// foxglove.websocket.v1 and foxglove.sdk.v1, which are the same on the wire for this part.

/// The first of those that a client offers (Sec-WebSocket-Protocol) that is spoken here; empty:
/// none.
std::string FoxgloveSubprotocol(const std::string& offered);

std::string ServerInfoText(const std::string& name);
std::string AdvertiseText(const std::vector<const Channel*>& channels);
std::string UnadvertiseText(const std::vector<std::uint32_t>& ids);
/// A warning to be shown to whoever uses the client.
std::string WarningText(const std::string& warning);

/// What stands before a message's bytes: opcode 1, the subscription, the time [us] in ns.
std::string MessageHead(std::uint32_t subscription, std::int64_t utime);

struct FoxgloveRequest {
  enum class Kind { kSubscribe, kUnsubscribe, kOther };
  struct Subscription {
    std::uint32_t id = 0, channel = 0;
  };
  Kind kind = Kind::kOther;
  std::string op;                           ///< as it was written; of kOther it is not spoken here
  std::vector<Subscription> subscriptions;  ///< of kSubscribe
  std::vector<std::uint32_t> ids;           ///< of kUnsubscribe: subscriptions
};

/// What a client says. Throws MalformedMessage (message.h). Fields that are not known are passed
/// over: the protocol may grow.
FoxgloveRequest ParseFoxgloveRequest(const std::string& text);

}  // namespace rgbdt::viewer
