// A request to the viewer's server, parsed as its connection does it. The raw bytes go through
// viewer_socket.cc; here, without a connection, many more are tried.
#include "tests/fuzz/fuzz.h"
#include "viewer/server/internal/http_answer.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rgbdt;
  using namespace rgbdt::viewer;
  fuzz::Input input(data, size);
  const bool open = input.Byte() % 2 == 1;
  Site site;
  site.hosts = RuleFor(open ? "0.0.0.0" : "127.0.0.1", 8080);
  site.url = "http://localhost:8080";
  site.page = "<html></html>";
  const std::string bytes = input.Rest();
  http::request_parser<http::empty_body> parser;
  parser.header_limit(8 * 1024);
  beast::error_code error;
  parser.put(net::buffer(bytes), error);
  if (error || !parser.is_header_done()) return 0;
  const auto answer = AnswerTo(parser.get(), site);
  if (!answer) {
    const auto& request = parser.get();
    const bool program = PathOf(request) != kPagesSocket && !FoxgloveSubprotocolOf(request).empty();
    fuzz::Require(request.count(http::field::host) == 1, "one Host of who may connect");
    fuzz::Require(request.count(http::field::origin) == 1 ||
                      (program && request.count(http::field::origin) == 0),
                  "one Origin of a page that may connect, none of a program");
  }
  return 0;
}
