#pragma once

#include <optional>
#include <string>

#include "viewer/server/internal/net.h"
#include "viewer/server/internal/origin.h"

namespace rgbdt::viewer {

using HttpRequest = http::request<http::empty_body>;
using HttpResponse = http::response<http::string_body>;

/// What HTTP requests are answered from.
struct Site {
  HostRule hosts;
  std::string url;   ///< for whoever came under another name
  std::string page;  ///< HTML; empty: the build made none
};

/// The answer to a request; empty where it is the WebSocket's and is to be accepted.
std::optional<HttpResponse> AnswerTo(const HttpRequest& request, const Site& site);

/// A sentence for a person. The connection is closed behind it.
HttpResponse PlainAnswer(http::status status, const std::string& sentence);

}  // namespace rgbdt::viewer
