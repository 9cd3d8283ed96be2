#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace rgbdt {

/// Something said of a view, or of a view by one camera.
struct Said {
  std::string camera;  ///< empty: not by one camera
  std::string view;    ///< empty: not of a view
  std::string text;
};

/// What is said alike, only once: texts that are the same but for the view's name and for numbers,
/// of several views or cameras. `what` says what became of the view: "rgb: view 0003 rejected:
/// TEXT"; "rgb, thermal: 6 views rejected (0001, 0002, ...), 0001: TEXT".
std::vector<std::string> SaidOnce(const std::vector<Said>& all, const std::string& what);

/// What is said alike most often.
struct SaidAlike {
  std::size_t count = 0;
  Said first;  ///< empty where nothing is said
};
SaidAlike MostSaid(const std::vector<Said>& all);

/// Lines of the form "view NAME: TEXT"; others are of no view.
std::vector<Said> OfViews(const std::vector<std::string>& lines);

}  // namespace rgbdt
