// A GigE Vision camera that serves frames from a file over the real protocol, by Aravis' fake
// camera. See Usage().

#include <arv.h>
#include <sys/stat.h>

#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace {

volatile std::sig_atomic_t stop_requested = 0;

void OnSignal(int) { stop_requested = 1; }

int Usage() {
  std::fputs(
      "usage: fake_camera ADDRESS SERIAL FRAMES\n"
      "Serves, at ADDRESS of this host, the frames that lie one after the other in the file "
      "FRAMES,\n"
      "round and round, as large as whoever controls it asks. A file that is replaced is read\n"
      "again. Until SIGTERM.\n",
      stderr);
  return 2;
}

// The file's bytes, whatever is in it now.
class Frames {
 public:
  explicit Frames(std::string path) : path_(std::move(path)) { Reload(); }

  // Reads the file again if it is another one.
  void Reload() {
    struct stat now {};
    if (stat(path_.c_str(), &now) != 0) return;
    if (now.st_ino == inode_ && now.st_mtim.tv_nsec == nanoseconds_) return;
    inode_ = now.st_ino;
    nanoseconds_ = now.st_mtim.tv_nsec;
    std::ifstream file(path_, std::ios::binary);
    std::vector<char> bytes((std::istreambuf_iterator<char>(file)), {});
    const std::lock_guard<std::mutex> lock(mutex_);
    bytes_ = std::move(bytes);
  }

  void CopyNext(void* to, std::size_t size) {
    const std::lock_guard<std::mutex> lock(mutex_);
    const std::size_t count = size > 0 ? bytes_.size() / size : 0;
    if (count == 0) {
      std::memset(to, 0, size);
      return;
    }
    std::memcpy(to, bytes_.data() + next_++ % count * size, size);
  }

 private:
  std::string path_;
  ino_t inode_ = 0;
  long nanoseconds_ = 0;
  std::mutex mutex_;
  std::vector<char> bytes_;
  std::size_t next_ = 0;
};

void Fill(ArvBuffer* buffer, void* frames, guint32 /*exposure_us*/, guint32 /*gain*/,
          ArvPixelFormat format) {
  // The buffer's own size reads 0 while it is filled.
  const auto width = static_cast<std::size_t>(arv_buffer_get_image_width(buffer));
  const auto height = static_cast<std::size_t>(arv_buffer_get_image_height(buffer));
  const std::size_t bytes = width * height * ARV_PIXEL_FORMAT_BIT_PER_PIXEL(format) / 8;
  size_t ignored = 0;
  auto* data = const_cast<void*>(arv_buffer_get_data(buffer, &ignored));
  if (data != nullptr) static_cast<Frames*>(frames)->CopyNext(data, bytes);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) return Usage();
  struct sigaction action {};
  action.sa_handler = OnSignal;
  sigaction(SIGTERM, &action, nullptr);
  sigaction(SIGINT, &action, nullptr);
  Frames frames(argv[3]);
  ArvGvFakeCamera* camera = arv_gv_fake_camera_new(argv[1], argv[2]);
  if (camera == nullptr || arv_gv_fake_camera_is_running(camera) == FALSE) {
    std::fprintf(stderr, "fake_camera: cannot serve at %s\n", argv[1]);
    return 1;
  }
  arv_fake_camera_set_fill_pattern(arv_gv_fake_camera_get_fake_camera(camera), Fill, &frames);
  std::puts("ready");
  std::fflush(stdout);
  while (stop_requested == 0) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    frames.Reload();
  }
  g_object_unref(camera);
  return 0;
}
