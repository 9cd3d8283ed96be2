#include "viewer/server/internal/http_answer.h"

#include <algorithm>
#include <boost/beast/websocket/rfc6455.hpp>

#include "viewer/server/internal/foxglove_protocol.h"

namespace rgbdt::viewer {
namespace {

// The page is one file: its scripts and styles stand in it, its worker is made from a blob. It
// speaks to this server's WebSocket, by the name that it came under, and to nobody else; some
// browsers do not take 'self' for a WebSocket.
std::string PagePolicy(const std::string& host, bool tls) {
  const std::string plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789.:-[]";
  const bool is_plain = host.find_first_not_of(plain) == std::string::npos;
  return "default-src 'none'; script-src 'unsafe-inline' blob:; worker-src blob:; "
         "style-src 'unsafe-inline'; img-src blob: data:; connect-src 'self'" +
         (is_plain ? (tls ? " wss://" : " ws://") + host : "") +
         "; font-src data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";
}

constexpr const char* kNoPage =
    "<!DOCTYPE html><html lang=\"en\"><head><meta charset=\"utf-8\"><title>rgbdt-viewer</title>"
    "</head><body><h1>rgbdt-viewer runs, but has no page</h1><p>It was built without Node. Install "
    "the packages nodejs and npm and build again.</p></body></html>\n";

HttpResponse Answer(http::status status, const char* content_type, std::string body) {
  HttpResponse answer(status, 11);
  answer.set(http::field::content_type, content_type);
  answer.set("X-Content-Type-Options", "nosniff");
  answer.set("Referrer-Policy", "no-referrer");
  answer.set(http::field::cache_control, "no-store");
  answer.keep_alive(false);
  answer.body() = std::move(body);
  answer.prepare_payload();
  return answer;
}

HttpResponse PageAnswer(const Site& site, const std::string& host) {
  HttpResponse answer =
      Answer(http::status::ok, "text/html; charset=utf-8", site.page.empty() ? kNoPage : site.page);
  answer.set("Content-Security-Policy", PagePolicy(host, site.hosts.tls));
  return answer;
}

// Of a field that may stand there once; empty: it does not, or it does several times.
std::string Only(const HttpRequest& request, http::field field) {
  return request.count(field) == 1 ? std::string(request[field]) : std::string();
}

std::optional<HttpResponse> AnswerToUpgrade(const HttpRequest& request, const std::string& host,
                                            bool tls) {
  if (!beast::websocket::is_upgrade(request)) {
    return PlainAnswer(http::status::upgrade_required, "This address is the page's WebSocket.");
  }
  if (!OriginIsHost(Only(request, http::field::origin), host, tls)) {
    return PlainAnswer(http::status::forbidden, "Only this server's own page may connect.");
  }
  return std::nullopt;
}

// "abc" of "/?x=1&token=abc"
std::string TokenOf(const HttpRequest& request) {
  const std::string target(request.target());
  const std::string name = "token=";
  std::size_t at = target.find('?');
  while (at != std::string::npos) {
    const std::size_t begin = at + 1, end = target.find('&', begin);
    if (target.compare(begin, name.size(), name) == 0) {
      return target.substr(begin + name.size(), end - begin - name.size());
    }
    at = end;
  }
  return "";
}

// A browser names the page that asks, always: who names none is a program, which could name any.
bool MayStream(const HttpRequest& request, const std::string& host, const Site& site) {
  if (request.count(http::field::origin) == 0) return true;
  if (!site.token.empty() && SameToken(TokenOf(request), site.token)) return true;
  const std::string origin = Only(request, http::field::origin);
  if (OriginIsHost(origin, host, site.hosts.tls)) return true;
  const auto& others = site.foxglove_origins;
  return std::find(others.begin(), others.end(), origin) != others.end();
}

std::optional<HttpResponse> AnswerToFoxglove(const HttpRequest& request, const std::string& host,
                                             const Site& site) {
  if (FoxgloveSubprotocolOf(request).empty()) {
    return PlainAnswer(http::status::bad_request,
                       "This WebSocket speaks foxglove.websocket.v1 and foxglove.sdk.v1.");
  }
  if (!MayStream(request, host, site)) {
    return PlainAnswer(http::status::forbidden,
                       "A page of another site may connect where rgbdt-viewer was started with "
                       "--foxglove-origin ORIGIN, or with the token in the address.");
  }
  return std::nullopt;
}

std::optional<HttpResponse> GetAnswer(const HttpRequest& request, const Site& site) {
  const std::string host = Only(request, http::field::host);
  if (!site.hosts.Allows(host)) {
    return PlainAnswer(http::status::forbidden,
                       "This server is not known under that name. Open " + site.url + " instead.");
  }
  const std::string path = PathOf(request);
  if (path == kPagesSocket) return AnswerToUpgrade(request, host, site.hosts.tls);
  if (path == "/" && beast::websocket::is_upgrade(request)) {
    return AnswerToFoxglove(request, host, site);
  }
  if (path == "/" || path == "/index.html") return PageAnswer(site, host);
  return PlainAnswer(http::status::not_found, "There is only the page at " + site.url + ".");
}

}  // namespace

std::string PathOf(const HttpRequest& request) {
  const std::string target(request.target());
  return target.substr(0, target.find('?'));
}

std::string FoxgloveSubprotocolOf(const HttpRequest& request) {
  return FoxgloveSubprotocol(Only(request, http::field::sec_websocket_protocol));
}

HttpResponse PlainAnswer(http::status status, const std::string& sentence) {
  return Answer(status, "text/plain; charset=utf-8", sentence + "\n");
}

std::optional<HttpResponse> AnswerTo(const HttpRequest& request, const Site& site) {
  const bool head = request.method() == http::verb::head;
  if (!head && request.method() != http::verb::get) {
    HttpResponse answer =
        PlainAnswer(http::status::method_not_allowed, "There is only GET and HEAD.");
    answer.set(http::field::allow, "GET, HEAD");
    return answer;
  }
  std::optional<HttpResponse> answer = GetAnswer(request, site);
  if (head && answer) answer->body().clear();  // its Content-Length stays what GET would say
  return answer;
}

}  // namespace rgbdt::viewer
