#include "services/up/supervisor.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <thread>
#include <utility>

#include "calib/model/descriptor.h"
#include "calib/model/errors.h"
#include "services/command_line/exit_codes.h"

namespace rgbdt {
namespace {

constexpr int kCannotRun = 127;

Descriptor OpenLog(const std::filesystem::path& path) {
  std::error_code ignored;
  std::filesystem::create_directories(path.parent_path(), ignored);
  // Without O_NONBLOCK a pipe that nobody reads is waited for.
  Descriptor log(open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC | O_NONBLOCK, 0666));
  if (!log) throw InputError("cannot write " + path.string() + ": " + std::strerror(errno));
  return log;
}

// Between fork and exec: nothing that takes memory or a lock.
[[noreturn]] void Become(char* const* arguments, int log, pid_t parent) {
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (getppid() != parent) _exit(0);  // it was too late for that
  setpgid(0, 0);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  const int nothing = open("/dev/null", O_RDONLY);
  if (nothing >= 0) dup2(nothing, STDIN_FILENO);
  dup2(log, STDOUT_FILENO);
  dup2(log, STDERR_FILENO);
  execvp(arguments[0], arguments);
  _exit(kCannotRun);
}

pid_t Spawn(Program* program) {
  const Descriptor log = OpenLog(program->log);
  std::vector<char*> arguments;
  for (std::string& word : program->arguments) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  const pid_t parent = getpid();
  const pid_t pid = fork();
  if (pid == 0) Become(arguments.data(), log.get(), parent);
  if (pid < 0) throw InputError(std::string("cannot be started: ") + std::strerror(errno));
  return pid;
}

// The last line of a log, of at most so many bytes.
std::string LastLine(const std::filesystem::path& path) {
  constexpr off_t kBytes = 500;
  const Descriptor log(open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (!log) return "";
  const off_t size = lseek(log.get(), 0, SEEK_END);
  std::string text(static_cast<std::size_t>(std::clamp<off_t>(size, 0, kBytes)), ' ');
  const ssize_t read =
      pread(log.get(), text.data(), text.size(), std::max<off_t>(0, size - kBytes));
  text.resize(static_cast<std::size_t>(std::max<ssize_t>(read, 0)));
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text.substr(text.rfind('\n') + 1);
}

std::string HowItEnded(const Program& program, int status) {
  if (WIFSIGNALED(status)) {
    return std::string("was killed by SIG") + sigabbrev_np(WTERMSIG(status));
  }
  if (WEXITSTATUS(status) == kCannotRun) return "cannot be run: " + program.arguments.front();
  const std::string last = WEXITSTATUS(status) == 0 ? "" : LastLine(program.log);
  return "ended with exit code " + std::to_string(WEXITSTATUS(status)) +
         (last.empty() ? "" : ": " + last);
}

// A session that is saved ends by its verdict.
bool IsDone(int status) {
  if (!WIFEXITED(status)) return false;
  const auto code = static_cast<ExitCode>(WEXITSTATUS(status));
  return code == ExitCode::kDone || code == ExitCode::kDoubtful || code == ExitCode::kDoNotUse;
}

}  // namespace

Supervisor::Supervisor(std::vector<Program> programs, Tell tell) : tell_(std::move(tell)) {
  signal(SIGCHLD, SIG_DFL);  // where it was inherited as ignored, no child could be waited for
  for (Program& program : programs) {
    children_.emplace_back();
    children_.back().program = std::move(program);
    OpenLog(children_.back().program.log);  // what cannot be written is noticed now
  }
}

Utime Supervisor::PauseAfter(int failures) {
  if (failures <= 1) return 0;
  const int doublings = std::min(failures - 2, 10);
  return std::min(kLongestPause, kFirstPause << doublings);
}

void Supervisor::Advance(Utime now) {
  for (Child& child : children_) {
    int status = 0;
    if (child.pid != 0 && waitpid(child.pid, &status, WNOHANG) == child.pid) {
      Ended(&child, status, now);
    }
    if (child.pid == 0 && !child.done && (child.starts == 0 || now >= child.next_start)) {
      Start(&child, now);
    }
  }
}

void Supervisor::Start(Child* child, Utime now) {
  ++child->starts;
  child->started = now;
  try {
    child->pid = Spawn(&child->program);
    tell_(child->program.name + ": started, pid " + std::to_string(child->pid));
  } catch (const InputError& e) {
    child->how_it_ended = e.what();
    child->next_start = now + PauseAfter(++child->failures + 1);
    tell_(child->program.name + ": " + child->how_it_ended);
  }
}

void Supervisor::Ended(Child* child, int status, Utime now) {
  child->pid = 0;
  child->how_it_ended = HowItEnded(child->program, status);
  child->done = child->program.ends && IsDone(status);
  if (now - child->started >= kSound) child->failures = 0;
  const Utime pause = PauseAfter(++child->failures);
  child->next_start = now + pause;
  char when[64] = "";
  if (!child->done) std::snprintf(when, sizeof(when), "; again in %.1f s", ToSeconds(pause));
  tell_(child->program.name + ": " + child->how_it_ended + when);
}

void Supervisor::Stop() {
  using Clock = std::chrono::steady_clock;
  for (const Child& child : children_) {
    if (child.pid != 0) kill(child.pid, SIGTERM);
  }
  const auto end = Clock::now() + std::chrono::microseconds(kPatience);
  for (Child& child : children_) {
    int status = 0;
    while (child.pid != 0 && waitpid(child.pid, &status, WNOHANG) == 0) {
      if (Clock::now() > end) kill(child.pid, SIGKILL);
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    if (child.pid != 0) tell_(child.program.name + ": " + HowItEnded(child.program, status));
    child.pid = 0;
    child.done = true;
  }
}

}  // namespace rgbdt
