#include "calib/present/report/html.h"

#include "calib/model/printable.h"
#include "calib/model/text.h"

namespace rgbdt::html {
namespace {

// Read outdoors on a laptop or a phone: black on white or white on black, large, no pale greys.
// Colour never stands alone; every verdict has its word.
constexpr char kStyle[] = R"(
:root { color-scheme: light dark; --fore: #000; --back: #fff; --soft: #f0f0ec; --line: #8a8a84;
  --good: #00591f; --caution: #7a3c00; --bad: #a00000; }
@media (prefers-color-scheme: dark) { :root { --fore: #fff; --back: #111; --soft: #1f2022;
  --line: #8d9096; --good: #7fe39a; --caution: #ffc266; --bad: #ff9a91; } }
* { box-sizing: border-box; }
body { margin: 0 auto; max-width: 62rem; padding: 1rem; color: var(--fore);
  background: var(--back); font: 1.0625rem/1.5 system-ui, sans-serif; }
h1 { font-size: 1.6rem; line-height: 1.2; } h2 { font-size: 1.35rem; margin: 2.2rem 0 .5rem; }
h3 { font-size: 1.05rem; margin: 1.4rem 0 .3rem; }
.verdict { border-left: .5rem solid; padding: .6rem .9rem; background: var(--soft); }
.verdict p { margin: .2rem 0; color: var(--fore); }
.verdict strong { font-size: 1.2rem; }
.verdict.good, .verdict.usable { border-color: var(--good); }
strong.good, .good strong, strong.usable, .usable strong { color: var(--good); }
.verdict.doubtful { border-color: var(--caution); }
strong.doubtful, .doubtful strong { color: var(--caution); }
.verdict.bad { border-color: var(--bad); } strong.bad, .bad strong { color: var(--bad); }
td strong { font-weight: inherit; }
.scroll { overflow-x: auto; max-width: 100%; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
th, td { text-align: left; padding: .25rem .9rem .25rem 0; border-bottom: 1px solid var(--line);
  vertical-align: top; }
th { font-weight: 600; } th[scope="row"] { min-width: 6rem; font-weight: inherit; }
pre { overflow-x: auto; background: var(--soft); padding: .7rem; font-size: .95rem; }
figure { margin: 1.2rem 0; } img { max-width: 100%; height: auto; display: block; }
)";

const char* IconOf(Grade mark) {
  switch (mark) {
    case Grade::kGood:
    case Grade::kUsable:
      return "✓ ";
    case Grade::kDoubtful:
      return "! ";
    case Grade::kBad:
      return "✗ ";
    case Grade::kNone:
      break;
  }
  return "";
}

std::string CellHtml(const Cell& cell) {
  if (cell.mark == Grade::kNone) return Escape(cell.text);
  return std::string("<strong class=\"") + NameOf(cell.mark) + "\">" + IconOf(cell.mark) +
         Escape(cell.text) + "</strong>";
}

}  // namespace

std::string Escape(const std::string& text) {
  std::string out;
  for (const char c : PrintableText(text, "\n\t")) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&#39;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string Base64(const std::string& bytes) {
  static constexpr char kDigits[] =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  const auto byte = [&](std::size_t i) -> unsigned {
    return i < bytes.size() ? static_cast<unsigned char>(bytes[i]) : 0u;
  };
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const unsigned group = byte(i) << 16 | byte(i + 1) << 8 | byte(i + 2);
    out += kDigits[group >> 18];
    out += kDigits[group >> 12 & 63];
    out += i + 1 < bytes.size() ? kDigits[group >> 6 & 63] : '=';
    out += i + 2 < bytes.size() ? kDigits[group & 63] : '=';
  }
  return out;
}

std::string Heading(int level, const std::string& text) {
  const std::string tag = "h" + std::to_string(level);
  return "<" + tag + ">" + Escape(text) + "</" + tag + ">\n";
}

std::string Paragraph(const std::string& text) { return "<p>" + Escape(text) + "</p>\n"; }

std::string VerdictBox(const Verdict& verdict) {
  std::string out = std::string("<div class=\"verdict ") + NameOf(verdict.grade) +
                    "\">\n<p><strong>" + Escape(verdict.headline) + "</strong></p>\n";
  for (const std::string& reason : verdict.reasons) out += Paragraph(reason);
  return out + "</div>\n";
}

std::string TableBox(const Table& table) {
  std::string out = Heading(3, table.title);
  for (const std::string& note : table.notes) out += Paragraph(note);
  if (table.rows.empty()) return out;
  out += "<div class=\"scroll\"><table>\n<thead><tr>";
  for (const std::string& name : table.head) out += "<th scope=\"col\">" + Escape(name) + "</th>";
  out += "</tr></thead>\n<tbody>\n";
  for (const Row& row : table.rows) {
    out += "<tr>";
    for (const Cell& cell : row) {
      out += &cell == &row.front() ? "<th scope=\"row\">" + Escape(cell.text) + "</th>"
                                   : "<td>" + CellHtml(cell) + "</td>";
    }
    out += "</tr>\n";
  }
  return out + "</tbody></table></div>\n";
}

std::string Page(const std::string& title, const std::string& body) {
  return "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
         "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; "
         "style-src 'unsafe-inline'; img-src data:\">\n<title>" +
         Escape(ValidUtf8(title)) + "</title>\n<style>" + kStyle + "</style>\n</head>\n<body>\n" +
         ValidUtf8(body) + "</body>\n</html>\n";
}

}  // namespace rgbdt::html
