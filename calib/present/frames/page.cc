#include "calib/present/frames/page.h"

#include <algorithm>
#include <stdexcept>

#include "calib/model/text.h"
#include "calib/present/report/html.h"

// The build names the page's file, where it made one.
#ifdef RGBDT_VIEWER_PAGE
__asm__(
    ".pushsection .rodata\n"
    ".global rgbdt_viewer_page_begin\n"
    ".global rgbdt_viewer_page_end\n"
    "rgbdt_viewer_page_begin:\n"
    ".incbin \"" RGBDT_VIEWER_PAGE
    "\"\n"
    "rgbdt_viewer_page_end:\n"
    ".byte 0\n"
    ".popsection\n");
extern "C" const char rgbdt_viewer_page_begin[];
extern "C" const char rgbdt_viewer_page_end[];
#endif

namespace rgbdt {
namespace {

// Where the page wants its frames: before its own script.
constexpr std::string_view kPlace = "<!--rgbdt-frames-->";
// Before its end is what is shown without JavaScript.
constexpr std::string_view kPlainPlace = "</noscript>";

std::string ScriptOf(const NamedFrame& frame) {
  return "<script type=\"application/x-rgbdt-frames\" data-topic=\"" +
         html::Escape(ValidUtf8(frame.topic)) + "\">" + html::Base64(frame.bytes) + "</script>\n";
}

}  // namespace

std::string_view ViewerPage() {
#ifdef RGBDT_VIEWER_PAGE
  return {rgbdt_viewer_page_begin,
          static_cast<std::size_t>(rgbdt_viewer_page_end - rgbdt_viewer_page_begin)};
#else
  return {};
#endif
}

std::string PageWithFrames(std::string_view page, const std::vector<NamedFrame>& frames,
                           const std::string& plain_text) {
  const std::size_t place = page.find(kPlace);
  if (place == std::string_view::npos) {
    throw std::logic_error("the viewer's page has no place for frames: " + std::string(kPlace));
  }
  std::string out(page.substr(0, place));
  for (const NamedFrame& frame : frames) out += ScriptOf(frame);
  const std::string_view rest = page.substr(place + kPlace.size());
  const std::size_t without_script = std::min(rest.rfind(kPlainPlace), rest.size());
  out.append(rest.substr(0, without_script));
  if (!plain_text.empty()) out += "<pre>" + html::Escape(ValidUtf8(plain_text)) + "</pre>";
  return out.append(rest.substr(without_script));
}

}  // namespace rgbdt
