// Draws the page's figures as SVG without a browser. A small JavaScript engine (Duktape) runs the
// same code as the page, so every figure has only one implementation. That code has no access to
// files, network or clock.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace armwright {

// A choice that a figure offers, such as the test case.
struct PlotChoice {
  std::string id;  // "case"
  std::string label;
  std::vector<std::string> values;
  std::string initial;
};

// A figure or a table of the page.
struct PlotEntry {
  std::string id;  // "distance-response"
  bool is_table = false;
  std::string tab;
  std::string title;
  std::string thesis;  // the same figure in the thesis, "Fig. 6.4"; or empty
  std::vector<PlotChoice> choices;
};

// The figures of one page. One thread at a time may use it.
class Plotter {
 public:
  // `data` is as for make_page_html(). Throws Error{usage} if this build has no page.
  explicit Plotter(std::string_view data);
  ~Plotter();
  Plotter(Plotter&&) noexcept;
  Plotter& operator=(Plotter&&) noexcept;

  const std::vector<PlotEntry>& entries() const { return entries_; }

  // Values by the id of their choice. A choice without a value has its initial one.
  using Picks = std::map<std::string, std::string>;
  struct Format {
    bool dark = false;
    int width = 0;   // pixels; 0: the figure's own width, 640 for most
    int height = 0;  // pixels; 0: the figure's own height, 400 for most
  };
  // Both throw Error{usage} for an unknown id, an unknown choice or an unknown value.
  std::string draw(const std::string& id, const Format& format, const Picks& picks) const;
  std::string make_csv(const std::string& id, const Picks& picks) const;

 private:
  struct Engine;
  std::string check(const std::string& id, const Picks& picks) const;
  std::unique_ptr<Engine> engine_;
  std::vector<PlotEntry> entries_;
};

}  // namespace armwright
