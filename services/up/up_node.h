#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "services/runtime/node.h"
#include "services/runtime/periodic.h"
#include "services/up/supervisor.h"

namespace rgbdt {

/// STATUS -> a table, once a second: what each process of the rig does. Runs the processes
/// (Supervisor), for as long as it lives.
class UpNode : public Node {
 public:
  using Show = std::function<void(const std::string& table)>;

  /// `name`: as its own STATUS has it, one of a machine's.
  UpNode(std::vector<Program> programs, Supervisor::Tell tell, Show show, std::string name = "up");

  std::string name() const override { return name_; }
  std::vector<std::string> Subscriptions() const override { return {"STATUS"}; }
  Messages Handle(const Message& message) override;
  Messages Advance(Utime now) override;
  Status GetStatus() const override;

  /// A line for each process: whether it runs, messages that came each second, how many it lost or
  /// refused, how often it was started anew, and what it says.
  std::string Table() const;
  void Stop() { supervisor_.Stop(); }

 private:
  struct Heard {
    Status status;
    Utime when = 0;
    double rate = 0;  // messages that came in a second
  };

  Supervisor supervisor_;
  Show show_;
  std::string name_;
  Periodic show_period_{kMicrosecondsPerSecond};
  Utime now_ = 0;
  std::map<std::string, Heard> heard_;  // of the processes that it runs
};

}  // namespace rgbdt
