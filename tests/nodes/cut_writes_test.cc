// A session's folder after a process that was killed at any of its writes, as where the power goes:
// what there was is there, the new view is there whole or not at all, and it can be gone on with.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <map>

#include "calib/files/atomic_file.h"
#include "calib/files/session/session_dir.h"
#include "services/nodes/earlier_views.h"
#include "tests/nodes/session_world.h"
#include "tests/unit/files/test_data.h"

namespace {

int calls_left = 0;  // until the process dies; 0: it does not

void Count() {
  if (calls_left > 0 && --calls_left == 0) _exit(7);
}

}  // namespace

// In place of the C library's, for all that is linked here. The last write is cut in its middle.
extern "C" ssize_t write(int file, const void* bytes, std::size_t size) {
  if (calls_left == 1) syscall(SYS_write, file, bytes, size / 2);
  Count();
  return syscall(SYS_write, file, bytes, size);
}

extern "C" int rename(const char* from, const char* to) noexcept {
  Count();
  return static_cast<int>(syscall(SYS_renameat2, AT_FDCWD, from, AT_FDCWD, to, 0));
}

extern "C" int unlink(const char* path) noexcept {
  Count();
  return static_cast<int>(syscall(SYS_unlinkat, AT_FDCWD, path, 0));
}

extern "C" int fsync(int file) {
  Count();
  return calls_left > 0 ? 0 : static_cast<int>(syscall(SYS_fsync, file));
}

namespace rgbdt {
namespace {

namespace fs = std::filesystem;

using test::TinyRig;
using ::testing::AnyOf;
using ::testing::ElementsAre;

View ViewOf(const std::string& name) {
  View view;
  view.name = name;
  view.cloud = test::SweepOfTwo(test::kStart).cloud;
  for (const CameraSpec& camera : TinyRig().cameras) {
    view.images.push_back(test::Blank(camera, test::kStart));
  }
  return view;
}

ViewDetection DetectionOf(const std::string& name) {
  ViewDetection detection;
  detection.view = name;
  detection.sweep_utime = test::kStart;
  detection.cloud.why_not = "made up";
  return detection;
}

void Take(const fs::path& session, const std::string& name) {
  WriteView(session, ViewOf(name));
  WriteDetection(session, DetectionOf(name));
}

std::map<std::string, std::string> Contents(const fs::path& folder) {
  std::map<std::string, std::string> contents;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    contents[fs::relative(entry.path(), folder)] =
        entry.is_regular_file() ? ReadWholeFile(entry.path()) : "";
  }
  return contents;
}

// Whether a process that does this lives until its end, though it dies at such a call of its own.
template <typename Do>
bool Outlives(int call, Do work) {
  const pid_t pid = fork();
  if (pid == 0) {
    calls_left = call;
    try {
      work();
    } catch (const std::exception& e) {
      std::fputs(e.what(), stderr);
      _exit(1);
    }
    _exit(0);
  }
  int status = 0;
  waitpid(pid, &status, 0);
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_THAT(WEXITSTATUS(status), AnyOf(0, 7)) << "call " << call;
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

class CutWrites : public ::testing::Test {
 protected:
  CutWrites() {
    WriteRig(dir_ / "before", TinyRig());
    Take(dir_ / "before", "0001");
  }
  // A folder as it was before.
  fs::path Anew() const {
    fs::remove_all(dir_ / "now");
    fs::copy(dir_ / "before", dir_ / "now", fs::copy_options::recursive);
    return dir_ / "now";
  }

  test::TempDir dir_;
};

TEST_F(CutWrites, ANewViewIsThereWholeOrNotAtAllAndTheSessionGoesOn) {
  const auto before = Contents(dir_ / "before/views/0001");
  int call = 1, absent = 0, undetected = 0;
  for (bool lived = false; !lived && call < 1000; ++call) {
    SCOPED_TRACE("call " + std::to_string(call));
    const fs::path session = Anew();
    lived = Outlives(call, [&] { Take(session, "0002"); });
    EarlierViews views = ReadEarlierViews(session, TinyRig());
    EXPECT_EQ(views.detected.count("0001"), 1U);
    for (const std::string& name : OpenSession(session).views) {
      EXPECT_EQ(ReadView({session, TinyRig(), {name}}, name).images.size(),
                TinyRig().cameras.size());
    }
    absent += OpenSession(session).views.size() == 1 ? 1 : 0;
    undetected += static_cast<int>(views.undetected.size());
    if (views.detected.size() == 1U) {
      EXPECT_FALSE(lived);
      for (const std::string& name : views.undetected) SetViewAside(session, name);
      Take(session, "0002");
      views = ReadEarlierViews(session, TinyRig());
    }
    EXPECT_EQ(views.detected.size(), 2U);
    EXPECT_TRUE(views.undetected.empty());
    EXPECT_EQ(Contents(session / "views/0001"), before);
    EXPECT_THAT(OpenSession(session).views, ElementsAre("0001", "0002"));
  }
  EXPECT_LT(call, 1000);
  EXPECT_GT(absent, 10) << "of so many writes";
  EXPECT_GT(undetected, 2);
}

TEST_F(CutWrites, AViewThatIsWrittenOnceMoreStays) {
  View picked = ViewOf("0001");
  CornerSelection picks;
  picks.camera = picked.images[0].camera;
  picks.image_utime = picked.images[0].utime;
  picks.corners = {{{1, 1}, {9, 1}, {9, 9}, {1, 9}}};
  picked.picks.push_back(picks);
  int call = 1, without = 0;
  for (bool lived = false; !lived && call < 1000; ++call) {
    SCOPED_TRACE("call " + std::to_string(call));
    const fs::path session = Anew();
    lived = Outlives(call, [&] { WriteView(session, picked); });
    const View view = ReadView({session, TinyRig(), {"0001"}}, "0001");
    without += view.picks.empty() ? 1 : 0;
    EXPECT_EQ(view.cloud.points.size(), picked.cloud.points.size());
    ASSERT_EQ(view.images.size(), picked.images.size());
    EXPECT_EQ(ReadEarlierViews(session, TinyRig()).detected.size(), 1U);
    EXPECT_TRUE(!lived || view.picks.size() == 1U);
  }
  EXPECT_LT(call, 1000);
  EXPECT_GT(without, 5);
}

// Once more from the start each time, as a person does.
TEST_F(CutWrites, ResultsOfAnEarlierRunAreNotLostWithThoseOfANewOne) {
  const auto run = [](const fs::path& session, const std::string& what) {
    SetResultsAside(session);
    for (const char* name : {"calibration.textproto", "report.json", "report.html"}) {
      WriteFileAtomically(session / name, what);
    }
  };
  run(dir_ / "before", "old");
  const auto read = [](const fs::path& file) {
    return fs::exists(file) ? ReadWholeFile(file) : "";
  };
  int call = 1;
  for (bool lived = false; !lived && call < 1000; ++call) {
    SCOPED_TRACE("call " + std::to_string(call));
    const fs::path session = Anew();
    lived = Outlives(call, [&] { run(session, "new"); });
    const std::string now = read(session / "calibration.textproto");
    const std::string kept = read(session / "calibration.previous.textproto");
    EXPECT_THAT(now, AnyOf("", "old", "new"));
    EXPECT_THAT(kept, AnyOf("", "old"));
    EXPECT_TRUE(now == "old" || kept == "old") << "the old one is lost";
    if (lived) continue;
    run(session, "newer");
    EXPECT_EQ(read(session / "calibration.textproto"), "newer");
    EXPECT_THAT(read(session / "calibration.previous.textproto"), AnyOf("old", "new"));
  }
  EXPECT_LT(call, 1000);
}

}  // namespace
}  // namespace rgbdt
