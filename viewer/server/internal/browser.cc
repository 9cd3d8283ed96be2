#include "viewer/server/internal/browser.h"

#include <set>
#include <utility>

#include "viewer/server/internal/frame_layout.h"
#include "viewer/server/internal/message.h"
#include "viewer/server/internal/steady_seconds.h"

namespace rgbdt::viewer {
namespace {

std::set<std::string> WatchKeys(const nlohmann::json& watch) {
  std::set<std::string> keys;
  if (watch["cloud"].get<bool>()) keys.insert("cloud");
  for (const auto& camera : watch["cameras"]) {
    const auto name = camera.get<std::string>();
    keys.insert("camera/" + name);
    keys.insert("overlay/" + name);
  }
  return keys;
}

}  // namespace

Browser::Browser(Stream stream, Hub* hub) : WebSocket(std::move(stream), hub) {
  if (one_too_many()) return;
  hub->Join(this);
  LeaveBy([this, hub] { hub->Leave(this); });
}

void Browser::OnStart() { StartDeadline(kHelloTime, "no hello"); }

void Browser::OnText(const std::string& text) {
  const nlohmann::json message = ParseMessage(text);
  const auto& type = message["type"].get_ref<const std::string&>();
  if (greeted_ == (type == "hello")) {
    throw MalformedMessage(true, greeted_ ? "hello twice" : "hello must come first");
  }
  if (type == "hello") return OnHello(message);
  if (type == "ack") return OnAck(message);
  if (type == "watch") return OnWatch(message);
  if ((type == "request" || type == "pick" || type == "leave_out") && !may_command_) {
    return Answer({ErrorNotice(kTokenAdvice)});
  }
  Ask(message);
}

void Browser::OnHello(const nlohmann::json& message) {
  const auto kept = hub()->DispatchThenKept();  // not yet greeted: nothing of it comes here
  greeted_ = true;
  StopDeadline();
  may_command_ = hub()->MayCommand(message["token"].get_ref<const std::string&>());
  Post hello;
  hello.topic = "hello";
  hello.make = [frame = hub()->HelloFrame(may_command_)] { return frame; };
  queue_.Replay(std::make_shared<LazyPost>(std::move(hello)));
  for (const SharedPost& post : kept) queue_.Replay(post);
  Pump();
}

void Browser::OnWatch(const nlohmann::json& message) {
  const auto kept = hub()->DispatchThenKept();
  const auto added = queue_.Watch(WatchKeys(message), message["points"].get<std::int64_t>());
  for (const SharedPost& post : kept) {
    if (added.count(post->post().watch) != 0) queue_.Replay(post);
  }
  Ask(message);
}

void Browser::OnAck(const nlohmann::json& message) {
  const auto sent_s = queue_.Acked(message["id"].get<std::uint32_t>());
  if (sent_s) hub()->screen.Add(SteadySeconds() - *sent_s);
  Pump();
}

void Browser::Ask(const nlohmann::json& message) { Answer(hub()->Ask(message)); }

void Browser::Answer(std::vector<Post> posts) {
  for (Post& post : posts) queue_.Offer(std::make_shared<LazyPost>(std::move(post)));
  Pump();
}

void Browser::Offer(const std::vector<SharedPost>& posts) {
  if (!greeted_ || closing()) return;
  for (const SharedPost& post : posts) queue_.Offer(post);
  Pump();
}

void Browser::Pump() {
  std::optional<BrowserQueue::Outgoing> next;
  if (may_write()) next = queue_.Next();
  Tell(queue_.waiting(), queue_.thinned(), queue_.share());
  if (next) WriteFrame(std::move(*next));
}

void Browser::WriteFrame(BrowserQueue::Outgoing next) {
  outgoing_ = std::move(next);
  for (std::size_t i = 0; i < id_bytes_.size(); ++i) {
    id_bytes_[i] = static_cast<unsigned char>(outgoing_.id >> (8 * i));
  }
  const std::array<net::const_buffer, 2> buffers = {
      net::buffer(id_bytes_),
      net::buffer(outgoing_.frame->data() + kIdBytes, outgoing_.bytes - kIdBytes)};
  Write(buffers, false);
}

void Browser::OnWritten() {
  outgoing_ = {};
  Pump();
}

}  // namespace rgbdt::viewer
