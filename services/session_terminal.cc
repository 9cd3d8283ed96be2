#include "services/session_terminal.h"

#include <poll.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>

#include "calib/model/errors.h"
#include "services/posix/clock.h"

namespace rgbdt {

ProgressPrinter::ProgressPrinter() : began_(SteadyUtime()) {}

void ProgressPrinter::operator()(const SessionProgress& progress) {
  const int quarter = static_cast<int>(progress.fraction * 4);
  if (progress.step == step_ && progress.text == text_ && quarter == quarter_) return;
  step_ = progress.step;
  text_ = progress.text;
  quarter_ = quarter;
  const double done = (progress.step - 1 + progress.fraction) / progress.steps;
  std::string remaining;
  if (done > 0.05) {
    const double seconds = ToSeconds(SteadyUtime() - began_) * (1 - done) / done;
    remaining = ", about " + std::to_string(std::lround(seconds)) + " s left";
  }
  std::printf("[%d/%d] %s, %.0f%%%s\n", progress.step, progress.steps, progress.text.c_str(),
              100 * progress.fraction, remaining.c_str());
  std::fflush(stdout);
}

bool Person::BoardStands() {
  if (!asked_) {
    std::printf("Put the board where the next view wants it, step aside, then press Enter.\n");
    std::fflush(stdout);
    asked_ = true;
  }
  pollfd input{STDIN_FILENO, POLLIN, 0};
  if (poll(&input, 1, 0) <= 0) return false;
  char key = 0;
  if (read(STDIN_FILENO, &key, 1) != 1) {
    throw InputError("standard input has ended, nobody can press Enter; leave out --by-hand");
  }
  if (key != '\n') return false;
  asked_ = false;
  return true;
}

}  // namespace rgbdt
