#include <vector>

#include "calib/model/errors.h"
#include "services/bus/internal/source.h"

namespace rgbdt {
namespace {

class LcmSource : public Source {
 public:
  explicit LcmSource(lcm_t* lcm) : lcm_(lcm) {}

  void Subscribe(const std::string& channel_regex, const Room& room,
                 Bus::Handler handler) override {
    auto subscriber = std::make_unique<Bus::Handler>(std::move(handler));
    // LCM puts ^ and $ around what it gets, so "A|B" alone would hear "A2" and "2B".
    lcm_subscription_t* subscription =
        lcm_subscribe(lcm_, ("(?:" + channel_regex + ")").c_str(), &OnMessage, subscriber.get());
    if (subscription == nullptr) {
      throw InputError("\"" + channel_regex + "\" is no regular expression");
    }
    lcm_subscription_set_queue_capacity(subscription, static_cast<int>(room.messages));
    subscribers_.push_back(std::move(subscriber));
  }

  int descriptor() const override { return lcm_get_fileno(lcm_); }
  bool Deliver() override { return lcm_handle(lcm_) == 0; }

 private:
  static void OnMessage(const lcm_recv_buf_t* buffer, const char* channel, void* user) {
    (*static_cast<Bus::Handler*>(user))(channel, static_cast<const std::uint8_t*>(buffer->data),
                                        buffer->data_size);
  }

  lcm_t* lcm_;
  std::vector<std::unique_ptr<Bus::Handler>> subscribers_;
};

}  // namespace

std::unique_ptr<Source> MakeLcmSource(lcm_t* lcm) {
  if (lcm_get_fileno(lcm) < 0) return nullptr;
  return std::make_unique<LcmSource>(lcm);
}

}  // namespace rgbdt
