#pragma once

#include <memory>
#include <string>
#include <utility>

#include "services/bus/bus.h"
#include "services/runtime/node_runner.h"

namespace rgbdt::test {

/// A process's own connection to a bus: what it subscribed to ends with it.
class Connection : public Bus {
 public:
  explicit Connection(Bus* bus) : bus_(bus) {}
  ~Connection() override { *open_ = false; }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;
  void Publish(const std::string& channel, const Bytes& bytes) override {
    bus_->Publish(channel, bytes);
  }
  void Subscribe(const std::string& channel_regex, Handler handler) override {
    bus_->Subscribe(channel_regex,
                    [open = open_, handler = std::move(handler)](
                        const std::string& channel, const std::uint8_t* data, std::size_t size) {
                      if (*open) handler(channel, data, size);
                    });
  }

 private:
  Bus* bus_;
  std::shared_ptr<bool> open_ = std::make_shared<bool>(true);
};

/// A node on a bus that can be killed (destroyed) at any moment and started anew.
template <typename NodeType>
struct Process {
  template <typename... Arguments>
  explicit Process(Bus* bus, Arguments&&... arguments)
      : node(std::forward<Arguments>(arguments)...), connection(bus), runner(&node, &connection) {}

  NodeType node;
  Connection connection;
  NodeRunner runner;
};

}  // namespace rgbdt::test
