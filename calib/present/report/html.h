#pragma once

// Small pieces of HTML. Text goes in as it is and comes out escaped, unless it is called HTML.

#include <string>

#include "calib/present/report/table.h"
#include "calib/present/report/verdict.h"

namespace rgbdt::html {

/// Text so that it shows as it is, in an element or a quoted attribute.
std::string Escape(const std::string& text);

std::string Base64(const std::string& bytes);

std::string Heading(int level, const std::string& text);
std::string Paragraph(const std::string& text);
std::string VerdictBox(const Verdict& verdict);

/// Title, notes and the table, in a box that scrolls by itself, so that a phone's page does not.
std::string TableBox(const Table& table);

/// The page around `body` (HTML), with its style; bytes that are no UTF-8 are replaced.
std::string Page(const std::string& title, const std::string& body);

}  // namespace rgbdt::html
