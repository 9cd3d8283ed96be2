#include <vector>

#include "tests/fuzz/seeds/seeds.h"

namespace rgbdt::fuzz {
namespace {

using Inputs = std::map<std::string, std::string>;

const std::vector<std::string>& ViewerMessages() {
  static const std::vector<std::string> messages = {
      R"({"type":"hello","token":"secret"})",
      R"({"type":"watch","cloud":true,"cameras":["rgb","ir"],"overlay_cloud":false,"points":1000})",
      R"({"type":"ack","id":1})",
      R"({"type":"view","view":"0001"})",
      R"({"type":"leave_out","views":["0001","0004"]})",
      R"({"type":"request","request":"capture","heldout":true})",
      R"({"type":"pick","camera":"rgb","image_utime":1700000000000000,)"
      R"("corners":[[0,1.5],[-2,3],[1e3,4],[5,6]]})"};
  return messages;
}

const std::vector<std::string>& FoxgloveMessages() {
  static const std::vector<std::string> messages = {
      R"({"op":"subscribe","subscriptions":[{"id":0,"channelId":1},{"id":1,"channelId":2}]})",
      R"({"op":"unsubscribe","subscriptionIds":[0,1]})", R"({"op":"getParameters"})"};
  return messages;
}

// A client's frame (RFC 6455, 5.2), masked by zeros, so that what it says can be read.
std::string Frame(int opcode, const std::string& text, bool last = true) {
  std::string bytes{static_cast<char>((last ? 0x80 : 0) | opcode)};
  if (text.size() < 126) {
    bytes += static_cast<char>(0x80 | text.size());
  } else {
    bytes += '\xfe';
    bytes += Piece(text).substr(0, 2);
  }
  return bytes + std::string(4, '\0') + text;
}

void AddViewerMessages(Inputs* seeds) {
  for (std::size_t i = 0; i < ViewerMessages().size(); ++i) {
    (*seeds)["message" + std::to_string(i)] = ViewerMessages()[i];
  }
  (*seeds)["array"] = "[1]";
  (*seeds)["deep"] = std::string(200, '[');
  (*seeds)["large"] = R"({"type":"ack","id":18446744073709551615})";
  (*seeds)["field"] = R"({"type":"ack","id":1,"more":null})";
  (*seeds)["less"] = R"({"type":"ack"})";
  (*seeds)["unknown"] = R"({"type":"shutdown"})";
  (*seeds)["untyped"] = R"({"id":1})";
}

void AddFoxgloveMessages(Inputs* seeds) {
  for (std::size_t i = 0; i < FoxgloveMessages().size(); ++i) {
    (*seeds)["message" + std::to_string(i)] = FoxgloveMessages()[i];
  }
  (*seeds)["large"] = R"({"op":"unsubscribe","subscriptionIds":[4294967296]})";
  (*seeds)["half"] = R"({"op":"subscribe","subscriptions":[{"id":0}]})";
  (*seeds)["array"] = "[1]";
}

void AddRequests(Inputs* seeds) {
  const std::string host = "Host: localhost:8080\r\n", end = "\r\n";
  const std::string upgrade =
      "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
      "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n";
  const std::string get = "GET / HTTP/1.1\r\n", socket = "GET /ws HTTP/1.1\r\n";
  const std::string origin = "Origin: http://localhost:8080\r\n";
  Inputs requests;
  requests["page"] = get + host + end;
  requests["index"] = "GET /index.html?x HTTP/1.1\r\n" + host + end;
  requests["head"] = "HEAD / HTTP/1.1\r\n" + host + end;
  requests["post"] = "POST / HTTP/1.1\r\n" + host + "Content-Length: 3\r\n" + end + "abc";
  requests["nothing"] = "GET /secret HTTP/1.1\r\n" + host + end;
  requests["rebound"] = get + "Host: evil.example\r\n" + end;
  requests["numbers"] = get + "Host: 127.0.0.1:8080\r\n" + end;
  requests["six"] = get + "Host: [::1]:8080\r\n" + end;
  requests["six_open"] = get + "Host: [fe80::1\r\n" + end;
  requests["port"] = get + "Host: localhost:99999\r\n" + end;
  requests["twice"] = get + host + host + end;
  requests["hostless"] = get + end;
  requests["socket"] = socket + host + origin + upgrade + end;
  requests["no_upgrade"] = socket + host + origin + end;
  requests["other_origin"] = socket + host + "Origin: http://evil.example\r\n" + upgrade + end;
  const std::string foxglove = "Sec-WebSocket-Protocol: foxglove.websocket.v1\r\n";
  requests["foxglove"] = get + host + upgrade + foxglove + end;
  requests["foxglove_page"] = get + host + "Origin: file://\r\n" + upgrade + foxglove + end;
  requests["foxglove_token"] =
      "GET /?token=secret HTTP/1.1\r\n" + host + "Origin: file://\r\n" + upgrade + foxglove + end;
  requests["rubbish"] = "\x16\x03\x01\x02";
  for (const auto& [name, request] : requests) {
    (*seeds)[name] = std::string(1, '\0') + request;
    (*seeds)[name + "_open"] = '\1' + request;
  }
}

void AddSockets(Inputs* seeds) {
  const std::string hello = '\1' + Frame(1, ViewerMessages()[0]);
  (*seeds)["hello"] = hello;
  for (std::size_t i = 0; i < ViewerMessages().size(); ++i) {
    (*seeds)["message" + std::to_string(i)] = hello + Frame(1, ViewerMessages()[i]);
  }
  (*seeds)["first"] = '\1' + Frame(1, ViewerMessages()[2]);
  (*seeds)["stranger"] =
      '\1' + Frame(1, R"({"type":"hello","token":"guess"})") + Frame(1, ViewerMessages()[5]);
  (*seeds)["pieces"] = hello + Frame(1, R"({"type":"ack",)", false) + Frame(0, R"("id":1})");
  (*seeds)["binary"] = hello + Frame(2, "abc");
  (*seeds)["ping"] = hello + Frame(9, "are you there") + Frame(10, "");
  (*seeds)["close"] = hello + Frame(8, "\x03\xe8 done");
  (*seeds)["not_json"] = hello + Frame(1, "{");
  (*seeds)["not_utf8"] = hello + Frame(1, "\xff\xfe");
  (*seeds)["reserved"] = hello + Frame(0x73, "x");
  (*seeds)["huge"] = hello + std::string("\x81\xff\x7f\xff\xff\xff\xff\xff\xff\xff\0\0\0\0", 14);
  const std::string subscribed = '\3' + Frame(1, FoxgloveMessages()[0]);
  (*seeds)["foxglove"] = subscribed;
  (*seeds)["foxglove_ends"] = subscribed + Frame(1, FoxgloveMessages()[1]);
  (*seeds)["foxglove_twice"] = subscribed + Frame(1, FoxgloveMessages()[0]);
  (*seeds)["foxglove_more"] = '\3' + Frame(1, FoxgloveMessages()[2]);
  (*seeds)["foxglove_binary"] = subscribed + Frame(2, std::string("\x01\x01\0\0\0abc", 8));
  (*seeds)["foxglove_not_json"] = subscribed + Frame(1, "{");
  (*seeds)["http"] = std::string(1, '\0') + "GET / HTTP/1.1\r\nHost: localhost\r\n\r\n";
  (*seeds)["bad_http"] = std::string(1, '\0') + "\x16\x03\x01\x02\r\n\r\n";
}

}  // namespace

void AddViewerSeeds(Seeds* seeds) {
  AddViewerMessages(&(*seeds)["viewer_message"]);
  AddFoxgloveMessages(&(*seeds)["viewer_foxglove"]);
  AddRequests(&(*seeds)["viewer_http"]);
  AddSockets(&(*seeds)["viewer_socket"]);
}

}  // namespace rgbdt::fuzz
