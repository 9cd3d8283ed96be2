#pragma once

#include <string>

#include "calib/model/time.h"
#include "services/nodes/session_node.h"

namespace rgbdt {

/// On stdout, a line for each new text and for each quarter of a long step: how far, and how long
/// still.
class ProgressPrinter {
 public:
  ProgressPrinter();
  void operator()(const SessionProgress& progress);

 private:
  Utime began_;
  int step_ = 0;
  int quarter_ = -1;
  std::string text_;
};

/// Who carries the board, at the keyboard.
class Person {
 public:
  /// Asks once for each pose; true once Enter was pressed. Never waits. Throws InputError where
  /// there is nobody: standard input has ended.
  bool BoardStands();

 private:
  bool asked_ = false;
};

}  // namespace rgbdt
