#pragma once

#include <optional>
#include <string>
#include <vector>

#include "viewer/server/internal/net.h"
#include "viewer/server/internal/origin.h"

namespace rgbdt::viewer {

using HttpRequest = http::request<http::empty_body>;
using HttpResponse = http::response<http::string_body>;

/// What HTTP requests are answered from.
struct Site {
  HostRule hosts;
  std::string url;                            ///< for whoever came under another name
  std::string page;                           ///< HTML; empty: the build made none
  std::string token;                          ///< empty: there is none
  std::vector<std::string> foxglove_origins;  ///< of pages that may connect as Foxglove does
};

/// The path that the page's WebSocket is at. Foxglove's clients are at "/": they take an address.
inline constexpr char kPagesSocket[] = "/ws";
std::string PathOf(const HttpRequest& request);
/// What a Foxglove client is to be answered to; empty: it offers none that is spoken here.
std::string FoxgloveSubprotocolOf(const HttpRequest& request);

/// The answer to a request; empty where it is a WebSocket's, the page's or a Foxglove client's, and
/// is to be accepted.
std::optional<HttpResponse> AnswerTo(const HttpRequest& request, const Site& site);

/// A sentence for a person. The connection is closed behind it.
HttpResponse PlainAnswer(http::status status, const std::string& sentence);

}  // namespace rgbdt::viewer
