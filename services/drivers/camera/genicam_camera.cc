#include "services/drivers/camera/genicam_camera.h"

#include <arv.h>

#include <atomic>
#include <cmath>
#include <cstdlib>

#include "services/drivers/camera/internal/frame_format.h"
#include "services/runtime/device_thread.h"

namespace rgbdt {
namespace {

template <typename T>
struct Unref {
  void operator()(T* object) const { g_object_unref(object); }
};
template <typename T>
using Owned = std::unique_ptr<T, Unref<T>>;

// What Aravis says went wrong.
class Error {
 public:
  ~Error() { g_clear_error(&error_); }
  // For Aravis' last argument; what was there before goes.
  GError** out() {
    g_clear_error(&error_);
    return &error_;
  }
  explicit operator bool() const { return error_ != nullptr; }
  std::string text() const { return error_ != nullptr ? error_->message : "no reason given"; }

 private:
  GError* error_ = nullptr;
};

const char* ProblemOf(ArvBufferStatus status) {
  switch (status) {
    case ARV_BUFFER_STATUS_SUCCESS:
      return "";
    case ARV_BUFFER_STATUS_TIMEOUT:
      return "not all of its packets came in time";
    case ARV_BUFFER_STATUS_MISSING_PACKETS:
      return "packets are missing";
    case ARV_BUFFER_STATUS_WRONG_PACKET_ID:
      return "a packet has a wrong number";
    case ARV_BUFFER_STATUS_SIZE_MISMATCH:
      return "it is larger than the camera said";
    default:
      return "it was broken off";
  }
}

std::string NameOf(const CameraDevice& device) {
  if (!device.serial.empty()) return "with serial " + device.serial;
  if (!device.address.empty()) return "at " + device.address;
  return "\"" + device.id + "\"";
}

// What Aravis opens a camera by.
std::string IdOf(const CameraDevice& device) {
  if (!device.address.empty()) return device.address;
  if (!device.id.empty()) return device.id;
  arv_update_device_list();
  std::string others;
  for (unsigned int i = 0; i < arv_get_n_devices(); ++i) {
    const char* serial = arv_get_device_serial_nbr(i);
    if (serial == nullptr) continue;
    if (device.serial == serial) return arv_get_device_id(i);
    others += (others.empty() ? "" : ", ") + std::string(serial);
  }
  throw DeviceError(
      "no camera " + NameOf(device) + " answers" +
      (others.empty() ? "" : " (there are: " + others + ")") +
      "; is it powered and in this machine's subnet? `rgbdt doctor --rig FILE` looks");
}

// The same word, or the same number but for the device's own steps.
bool Agree(const std::string& asked, const std::string& got) {
  if (asked == got) return true;
  char* asked_end = nullptr;
  char* got_end = nullptr;
  const double a = g_ascii_strtod(asked.c_str(), &asked_end);
  const double b = g_ascii_strtod(got.c_str(), &got_end);
  if (asked_end != asked.c_str() + asked.size() || got_end != got.c_str() + got.size())
    return false;
  return !asked.empty() && !got.empty() && std::abs(a - b) <= 1e-4 * std::abs(a);
}

}  // namespace

struct GenicamCamera::Impl {
  explicit Impl(const CameraSpec& camera_spec)
      : spec(camera_spec), device_spec(camera_spec.device.value()) {
    Open();
    SetAll();
    StartStream();
  }

  ~Impl() {
    // The camera may be gone: nothing to be done about what fails here.
    if (camera) arv_camera_stop_acquisition(camera.get(), Error().out());
    if (device != nullptr) g_signal_handlers_disconnect_by_data(device, this);
  }

  void Open() {
    Error error;
    camera.reset(arv_camera_new(IdOf(device_spec).c_str(), error.out()));
    if (!camera) {
      throw DeviceError("no camera " + NameOf(device_spec) + ": " + error.text() +
                        "; is it powered and in this machine's subnet? `rgbdt doctor --rig FILE` "
                        "looks");
    }
    device = arv_camera_get_device(camera.get());
    if (ARV_IS_GV_DEVICE(device) && arv_gv_device_is_controller(ARV_GV_DEVICE(device)) == FALSE) {
      throw DeviceError("the camera " + NameOf(device_spec) +
                        " is controlled by another program; end that, or wait some seconds if it "
                        "has just ended");
    }
    g_signal_connect(device, "control-lost", G_CALLBACK(&Impl::OnLost), this);
  }

  static void OnLost(ArvDevice*, Impl* self) { self->lost = true; }

  bool Lists(const std::string& name) const {
    for (const auto& [listed, value] : device_spec.features) {
      if (listed == name) return true;
    }
    return false;
  }

  bool Has(const char* name) const { return arv_device_get_feature(device, name) != nullptr; }

  // Unless the rig file lists it itself.
  void SetUnlessListed(const char* name, const std::string& value) {
    if (Has(name) && !Lists(name)) Set(name, value);
  }

  void SetAll() {
    SetUnlessListed("Width", std::to_string(spec.width));
    SetUnlessListed("Height", std::to_string(spec.height));
    SetUnlessListed("PixelFormat", GenicamName(spec.format));
    SetUnlessListed("AcquisitionMode", "Continuous");
    if (ARV_IS_GV_DEVICE(device)) SetPacketSize();
    for (const auto& [name, value] : device_spec.features) Set(name, value);
    SetTrigger();
  }

  void SetPacketSize() {
    Error error;
    if (device_spec.packet_bytes > 0) {
      arv_camera_gv_set_packet_size(camera.get(), device_spec.packet_bytes, error.out());
    } else {
      arv_camera_gv_auto_packet_size(camera.get(), error.out());
    }
    if (error) warnings.push_back("the packets' size was not taken: " + error.text());
  }

  void SetTrigger() {
    using Trigger = CameraDevice::Trigger;
    if (device_spec.trigger == Trigger::kFree) {
      SetUnlessListed("TriggerMode", "Off");
      return;
    }
    SetUnlessListed("TriggerSelector", "FrameStart");
    SetUnlessListed("TriggerMode", "On");
    SetUnlessListed("TriggerSource",
                    device_spec.trigger == Trigger::kSoftware ? "Software" : "Line1");
  }

  // Sets a feature of any type and reads it back.
  void Set(const std::string& name, const std::string& value) {
    ArvGcNode* node = arv_device_get_feature(device, name.c_str());
    if (!ARV_IS_GC_FEATURE_NODE(node)) {
      warnings.push_back("it has no feature " + name +
                         "; `arv-tool-0.8 features` lists what it has");
      return;
    }
    Error error;
    if (ARV_IS_GC_COMMAND(node)) {
      arv_device_execute_command(device, name.c_str(), error.out());
      if (error) warnings.push_back(name + " was refused: " + error.text());
      return;
    }
    ArvGcFeatureNode* feature = ARV_GC_FEATURE_NODE(node);
    arv_gc_feature_node_set_value_from_string(feature, value.c_str(), error.out());
    if (error) {
      warnings.push_back(name + " = " + value + " was refused: " + error.text());
      return;
    }
    Error reading;
    const char* got = arv_gc_feature_node_get_value_as_string(feature, reading.out());
    if (reading || got == nullptr) {
      warnings.push_back(name + " cannot be read back: " + reading.text());
    } else if (!Agree(value, got)) {
      warnings.push_back(name + " is " + got + " after it was set to " + value);
    }
  }

  void StartStream() {
    Error error;
    stream.reset(arv_camera_create_stream(camera.get(), nullptr, nullptr, error.out()));
    if (!stream) throw DeviceError("its stream cannot be opened: " + error.text());
    if (ARV_IS_GV_STREAM(stream.get())) {
      g_object_set(stream.get(), "socket-buffer", ARV_GV_STREAM_SOCKET_BUFFER_FIXED,
                   "socket-buffer-size", kSocketBytes, nullptr);
    }
    const guint payload = arv_camera_get_payload(camera.get(), error.out());
    if (error) throw DeviceError("it does not say how large its frames are: " + error.text());
    for (int i = 0; i < kBuffers; ++i) {
      arv_stream_push_buffer(stream.get(), arv_buffer_new_allocate(payload));
    }
    arv_camera_start_acquisition(camera.get(), error.out());
    if (error) throw DeviceError("it does not start: " + error.text());
  }

  CameraSpec spec;
  CameraDevice device_spec;
  std::vector<std::string> warnings;
  std::atomic<bool> lost{false};
  Owned<ArvCamera> camera;
  ArvDevice* device = nullptr;  // the camera's
  Owned<ArvStream> stream;      // goes before the camera
};

GenicamCamera::GenicamCamera(const CameraSpec& spec) : impl_(std::make_unique<Impl>(spec)) {}

GenicamCamera::~GenicamCamera() = default;

const std::vector<std::string>& GenicamCamera::warnings() const { return impl_->warnings; }

bool GenicamCamera::Next(int timeout_ms,
                         const std::function<void(const CameraFrame& frame)>& take) {
  if (impl_->lost) {
    throw DeviceError("the camera " + NameOf(impl_->device_spec) +
                      " is lost: it does not answer any more; is it unplugged?");
  }
  ArvBuffer* buffer = arv_stream_timeout_pop_buffer(
      impl_->stream.get(), static_cast<guint64>(timeout_ms) * kMicrosecondsPerSecond / 1000);
  if (buffer == nullptr) return false;
  CameraFrame frame;
  const ArvBufferStatus status = arv_buffer_get_status(buffer);
  frame.problem = ProblemOf(status);
  frame.number = static_cast<std::int64_t>(arv_buffer_get_frame_id(buffer));
  frame.device_utime = static_cast<Utime>(arv_buffer_get_timestamp(buffer) / 1000);
  frame.arrival_utime = static_cast<Utime>(arv_buffer_get_system_timestamp(buffer) / 1000);
  if (status == ARV_BUFFER_STATUS_SUCCESS) {
    frame.data = arv_buffer_get_data(buffer, &frame.size);
    frame.width = arv_buffer_get_image_width(buffer);
    frame.height = arv_buffer_get_image_height(buffer);
    frame.format = arv_buffer_get_image_pixel_format(buffer);
  }
  const auto give_back = [&](void*) { arv_stream_push_buffer(impl_->stream.get(), buffer); };
  const std::unique_ptr<ArvBuffer, decltype(give_back)> guard(buffer, give_back);
  take(frame);
  return true;
}

void GenicamCamera::Trigger() {
  Error error;
  arv_camera_software_trigger(impl_->camera.get(), error.out());
  if (error) throw DeviceError("the camera does not take a trigger: " + error.text());
}

std::optional<double> GenicamCamera::ExposureSeconds() {
  Error error;
  const double microseconds = arv_camera_get_exposure_time(impl_->camera.get(), error.out());
  if (error || !(microseconds > 0)) return std::nullopt;
  return microseconds * 1e-6;
}

std::optional<double> GenicamCamera::TemperatureCelsius() {
  if (!impl_->Has("DeviceTemperature")) return std::nullopt;
  Error error;
  const double celsius =
      arv_device_get_float_feature_value(impl_->device, "DeviceTemperature", error.out());
  if (error) return std::nullopt;
  return celsius;
}

bool GenicamCamera::FollowsPtp() {
  for (const char* name : {"PtpStatus", "GevIEEE1588Status"}) {
    if (!impl_->Has(name)) continue;
    Error error;
    const char* status = arv_device_get_string_feature_value(impl_->device, name, error.out());
    if (!error && status != nullptr && std::string(status) == "Slave") return true;
  }
  return false;
}

}  // namespace rgbdt
