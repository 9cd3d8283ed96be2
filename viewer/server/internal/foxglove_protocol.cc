#include "viewer/server/internal/foxglove_protocol.h"

#include <openssl/evp.h>

#include <boost/beast/http/rfc7230.hpp>
#include <limits>
#include <nlohmann/json.hpp>

#include "viewer/server/internal/message.h"

namespace rgbdt::viewer {
namespace {

using nlohmann::json;

constexpr std::size_t kMostAtOnce = 1000;  // subscriptions of a request

std::string Base64Text(const std::string& bytes) {
  std::string text((bytes.size() + 2) / 3 * 4 + 1, '\0');  // it ends it with a zero
  const int size = EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()),
                                   reinterpret_cast<const unsigned char*>(bytes.data()),
                                   static_cast<int>(bytes.size()));
  text.resize(static_cast<std::size_t>(size));
  return text;
}

json Described(const Channel& channel) {
  return {{"id", channel.id},
          {"topic", channel.topic},
          {"encoding", "protobuf"},
          {"schemaName", channel.schema_name},
          {"schema", Base64Text(*channel.schema)},
          {"schemaEncoding", "protobuf"}};
}

// Names come from the bus: what is no UTF-8 in them must not throw.
std::string Dump(const json& message) {
  return message.dump(-1, ' ', false, json::error_handler_t::replace);
}

[[noreturn]] void RefuseRequest(const std::string& why) { throw MalformedMessage(true, why); }

const json& FieldOf(const json& object, const char* name) {
  if (!object.is_object()) RefuseRequest("no JSON object");
  const auto found = object.find(name);
  if (found == object.end()) RefuseRequest(std::string("no field ") + name);
  return *found;
}

const json& ArrayOf(const json& object, const char* name) {
  const json& array = FieldOf(object, name);
  if (!array.is_array() || array.size() > kMostAtOnce) {
    RefuseRequest(std::string("wrong value of ") + name);
  }
  return array;
}

std::uint32_t Number(const json& value) {
  if (!value.is_number_unsigned() ||
      value.get<std::uint64_t>() > std::numeric_limits<std::uint32_t>::max()) {
    RefuseRequest("wrong value of an id");
  }
  return value.get<std::uint32_t>();
}

}  // namespace

std::string FoxgloveSubprotocol(const std::string& offered) {
  for (const auto& name : boost::beast::http::token_list(offered)) {
    if (name == "foxglove.websocket.v1" || name == "foxglove.sdk.v1") return std::string(name);
  }
  return "";
}

std::string ServerInfoText(const std::string& name) {
  return Dump({{"op", "serverInfo"}, {"name", name}, {"capabilities", json::array()}});
}

std::string AdvertiseText(const std::vector<const Channel*>& channels) {
  json described = json::array();
  for (const Channel* channel : channels) described.push_back(Described(*channel));
  return Dump({{"op", "advertise"}, {"channels", std::move(described)}});
}

std::string UnadvertiseText(const std::vector<std::uint32_t>& ids) {
  return Dump({{"op", "unadvertise"}, {"channelIds", ids}});
}

std::string WarningText(const std::string& warning) {
  return Dump({{"op", "status"}, {"level", 1}, {"message", warning}});
}

std::string MessageHead(std::uint32_t subscription, std::int64_t utime) {
  constexpr std::uint64_t kNanoseconds = 1000;
  std::string head(1, '\x01');
  const auto append = [&](std::uint64_t value, int bytes) {
    for (int i = 0; i < bytes; ++i) head.push_back(static_cast<char>(value >> (8 * i)));
  };
  append(subscription, 4);
  append(static_cast<std::uint64_t>(utime) * kNanoseconds, 8);
  return head;
}

FoxgloveRequest ParseFoxgloveRequest(const std::string& text) {
  const json message = ParseJson(text);
  const json& op = FieldOf(message, "op");
  if (!op.is_string() || op.get_ref<const std::string&>().size() > kMaxMessageString) {
    RefuseRequest("wrong value of op");
  }
  FoxgloveRequest request;
  request.op = op.get<std::string>();
  if (request.op == "subscribe") {
    request.kind = FoxgloveRequest::Kind::kSubscribe;
    for (const json& one : ArrayOf(message, "subscriptions")) {
      request.subscriptions.push_back(
          {Number(FieldOf(one, "id")), Number(FieldOf(one, "channelId"))});
    }
  } else if (request.op == "unsubscribe") {
    request.kind = FoxgloveRequest::Kind::kUnsubscribe;
    for (const json& id : ArrayOf(message, "subscriptionIds")) request.ids.push_back(Number(id));
  }
  return request;
}

}  // namespace rgbdt::viewer
