#pragma once

// For calib/files and the viewer: small pieces of HTML.

#include <string>
#include <vector>

#include "calib/model/calibration.h"

namespace rgbdt::html {

/// Text so that it shows as it is, in an element or a quoted attribute.
std::string Escape(const std::string& text);

std::string Base64(const std::string& bytes);

/// A table in a box that scrolls by itself, so that a phone's page does not. Cells are HTML.
std::string Table(const std::vector<std::string>& head,
                  const std::vector<std::vector<std::string>>& rows);

/// The number with so many digits behind the point; "–" where it is not finite.
std::string Number(double value, int decimals);

/// "0.012° and 3.4 mm"
std::string PoseErrorText(const PoseError& error);

/// The page around `body` (HTML), with its style.
std::string Page(const std::string& title, const std::string& body);

}  // namespace rgbdt::html
