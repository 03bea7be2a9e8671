// The page's figures as SVG, without a browser: the very code that draws them in the page runs in a
// small JavaScript engine here (Duktape), so there is one drawing of every figure. That code has
// no access to files, network or clock.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace armwright {

struct PlotChoice {
  std::string id;  // "case"
  std::string label;
  std::vector<std::string> values;
  std::string initial;
};

struct PlotEntry {
  std::string id;  // "distance-response"
  bool is_table = false;
  std::string tab;
  std::string title;
  std::string thesis;  // its counterpart: "Fig. 6.4"; or empty
  std::vector<PlotChoice> choices;
};

class Plotter {
 public:
  // `data`: as for make_page_html().
  explicit Plotter(std::string_view data);
  ~Plotter();
  Plotter(Plotter&&) noexcept;
  Plotter& operator=(Plotter&&) noexcept;

  const std::vector<PlotEntry>& entries() const { return entries_; }

  using Picks = std::map<std::string, std::string>;  // of choices, those that are not the initial
  struct Format {
    bool dark = false;
    int width = 0;  // pixels; 0: the figure's own, 640 x 400 for most
    int height = 0;
  };
  // Error{usage} for an id that is not there, a choice or value that it does not have.
  std::string draw(const std::string& id, const Format& format, const Picks& picks) const;
  std::string make_csv(const std::string& id, const Picks& picks) const;

 private:
  struct Engine;
  std::string check(const std::string& id, const Picks& picks) const;
  std::unique_ptr<Engine> engine_;
  std::vector<PlotEntry> entries_;
};

}  // namespace armwright
