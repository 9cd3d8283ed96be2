// Aravis against rgbdt doctor, which shares no code with it.
//   aravis_camera serve INTERFACE SERIAL   simulates a GigE Vision camera
//   aravis_camera hold                     takes control of the first camera found
// Prints "ready" and stays until its standard input ends.
#include <arv.h>

#include <cstdio>
#include <cstring>

namespace {

int Stay() {
  std::puts("ready");
  std::fflush(stdout);
  while (std::getchar() != EOF) {
  }
  return 0;
}

int Serve(const char* interface, const char* serial) {
  ArvGvFakeCamera* camera = arv_gv_fake_camera_new(interface, serial);
  const int code = arv_gv_fake_camera_is_running(camera) ? Stay() : 1;
  g_object_unref(camera);
  return code;
}

int Hold() {
  GError* error = nullptr;
  ArvCamera* camera = arv_camera_new(nullptr, &error);
  if (camera == nullptr) {
    std::fprintf(stderr, "aravis_camera: %s\n", error != nullptr ? error->message : "no camera");
    return 1;
  }
  const int code = Stay();
  g_object_unref(camera);
  return code;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 4 && std::strcmp(argv[1], "serve") == 0) return Serve(argv[2], argv[3]);
  if (argc == 2 && std::strcmp(argv[1], "hold") == 0) return Hold();
  std::fputs("Usage: aravis_camera serve INTERFACE SERIAL | hold\n", stderr);
  return 1;
}
