#include "calib/present/frames/page.h"

#include <gmock/gmock.h>

#include <stdexcept>

#include "calib/files/atomic_file.h"

namespace rgbdt {
namespace {

constexpr char kPage[] = "<html><head><!--rgbdt-frames--><script>go()</script></head></html>";

std::string FromBase64(const std::string& text) {
  static const std::string kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  unsigned group = 0;
  int bits = 0;
  for (const char c : text) {
    if (c == '=') break;
    const std::size_t digit = kDigits.find(c);
    if (digit == std::string::npos) throw std::runtime_error("no base64");
    group = group << 6 | static_cast<unsigned>(digit);
    bits += 6;
    if (bits < 8) continue;
    bits -= 8;
    bytes += static_cast<char>(group >> bits & 255);
  }
  return bytes;
}

// As a browser takes it: an element ends at the first "</script".
std::vector<std::string> FramesIn(const std::string& page) {
  std::vector<std::string> frames;
  const std::string begin = "<script type=\"application/x-rgbdt-frames\"";
  for (std::size_t at = page.find(begin); at != std::string::npos; at = page.find(begin, at)) {
    at = page.find('>', at) + 1;
    frames.push_back(FromBase64(page.substr(at, page.find("</script", at) - at)));
  }
  return frames;
}

TEST(Page, IsTheFileThatTheBuildMade) {
  const std::string file = RGBDT_VIEWER_PAGE;
  EXPECT_TRUE(ViewerPage() == (file.empty() ? "" : ReadWholeFile(file)));
}

TEST(PageWithFrames, FramesComeBackByteForByteBeforeThePagesScript) {
  std::string all;
  for (int i = 0; i < 256; ++i) all += static_cast<char>(i);
  const std::vector<std::string> bytes = {"", "</script><script>alert(1)</script>", all, "a", "ab"};
  std::vector<NamedFrame> frames;
  for (const std::string& frame : bytes) frames.push_back({"session", frame});
  const std::string page = PageWithFrames(kPage, frames, "");
  EXPECT_EQ(FramesIn(page), bytes);
  EXPECT_GT(page.find("<script>go()"), page.rfind("application/x-rgbdt-frames"));
  EXPECT_EQ(page.find("alert"), std::string::npos);
}

TEST(PageWithFrames, NoTopicIsMarkup) {
  const std::string page = PageWithFrames(kPage, {{"\"></script><b>\xff", "frame"}}, "");
  EXPECT_EQ(page.find("<b>"), std::string::npos);
  EXPECT_EQ(page.find('\xff'), std::string::npos);
  EXPECT_EQ(FramesIn(page), std::vector<std::string>{"frame"});
}

TEST(PageWithFrames, SaysInWordsWhatItShowsWithoutJavaScript) {
  const std::string page = std::string(kPage) + "<noscript>It needs JavaScript.</noscript>";
  EXPECT_NE(
      PageWithFrames(page, {}, "good, 2 < 3 \xff")
          .find("<noscript>It needs JavaScript.<pre>good, 2 &lt; 3 \xEF\xBF\xBD</pre></noscript>"),
      std::string::npos);
}

TEST(PageWithFrames, WithoutFramesOrAPlace) {
  EXPECT_EQ(PageWithFrames(kPage, {}, ""), "<html><head><script>go()</script></head></html>");
  EXPECT_THROW(PageWithFrames("<html></html>", {}, ""), std::logic_error);
}

}  // namespace
}  // namespace rgbdt
