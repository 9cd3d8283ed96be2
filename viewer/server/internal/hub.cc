#include "viewer/server/internal/hub.h"

#include <algorithm>
#include <utility>

#include "calib/model/errors.h"
#include "calib/present/layout/frame.h"
#include "viewer/server/internal/browser.h"

namespace rgbdt::viewer {

const char* const kTokenAdvice =
    "To command the rig, open the address with the token that rgbdt-viewer printed.";

Post ErrorNotice(const std::string& text) {
  Post notice;
  notice.topic = "notice";
  notice.kept = false;
  notice.make = [text] {
    return JsonFrame({{"type", "notice"}, {"level", "error"}, {"text", text}});
  };
  return notice;
}

Hub::Hub(const ServerOptions& options, Server::OnMessage on_message)
    : hello_(options.hello), on_message_(std::move(on_message)) {
  site.page = options.page;
  site.token = options.token;
  site.foxglove_origins = options.foxglove_origins;
}

void Hub::Leave(Browser* browser) {
  browsers_.erase(std::remove(browsers_.begin(), browsers_.end(), browser), browsers_.end());
}

void Hub::Offer(const std::vector<SharedPost>& posts) {
  if (posts.empty()) return;
  for (Browser* browser : browsers_) browser->Offer(posts);
}

void Hub::Dispatch() { Offer(posts.Take().sent); }

std::vector<SharedPost> Hub::DispatchThenKept() {
  PostStore::Taken taken = posts.Take();
  Offer(taken.sent);
  return std::move(taken.kept);
}

std::string Hub::HelloFrame(bool may_command) const {
  nlohmann::json hello = hello_;
  hello["type"] = "hello";
  hello["may_command"] = may_command;
  hello["why_not"] = may_command ? "" : kTokenAdvice;
  return JsonFrame(hello);
}

bool Hub::MayCommand(const std::string& token) const {
  return site.token.empty() || SameToken(token, site.token);
}

std::vector<Post> Hub::Ask(const nlohmann::json& message) const {
  if (!on_message_) return {};
  std::vector<Post> answer;
  try {
    return on_message_(message);
  } catch (const std::exception& error) {  // an InputError's words are for a person
    answer.push_back(ErrorNotice(error.what()));
  } catch (...) {
    answer.push_back(ErrorNotice("That failed for an unknown reason."));
  }
  return answer;
}

}  // namespace rgbdt::viewer
