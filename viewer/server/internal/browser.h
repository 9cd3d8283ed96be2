#pragma once

#include <array>
#include <string>
#include <vector>

#include "viewer/server/internal/browser_queue.h"
#include "viewer/server/internal/web_socket.h"

namespace rgbdt::viewer {

/// The page's end in a browser: takes what it says, writes what waits for it.
class Browser final : public WebSocket {
 public:
  Browser(Stream stream, Hub* hub);

  void Offer(const std::vector<SharedPost>& posts);

 private:
  void OnStart() override;
  void OnText(const std::string& text) override;
  void OnWritten() override;

  void OnHello(const nlohmann::json& message);
  void OnWatch(const nlohmann::json& message);
  void OnAck(const nlohmann::json& message);
  void Ask(const nlohmann::json& message);
  void Answer(std::vector<Post> posts);

  void Pump();
  void WriteFrame(BrowserQueue::Outgoing next);

  BrowserQueue queue_;
  bool greeted_ = false;  // it said hello
  bool may_command_ = false;
  BrowserQueue::Outgoing outgoing_;  // being written
  std::array<unsigned char, 4> id_bytes_{};
};

}  // namespace rgbdt::viewer
