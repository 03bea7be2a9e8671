#include "report/page/plotter.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/text.hpp"
#include "report/page/page_file.hpp"

#ifdef ARMWRIGHT_WITH_PAGE
#include <duktape.h>
#endif

namespace armwright {

using nlohmann::json;

#ifdef ARMWRIGHT_WITH_PAGE

struct Plotter::Engine {
  struct Destroyer {
    void operator()(duk_context* context) const { duk_destroy_heap(context); }
  };
  std::unique_ptr<duk_context, Destroyer> context;

  // Calls a function of web/src/plot/main.ts, which puts its functions into the global object
  // `armwright`.
  std::string call(const char* function, std::initializer_list<std::string_view> arguments) {
    duk_context* const duk = context.get();
    duk_push_global_object(duk);
    duk_get_prop_string(duk, -1, "armwright");
    duk_get_prop_string(duk, -1, function);
    for (const std::string_view argument : arguments) {
      duk_push_lstring(duk, argument.data(), argument.size());
    }
    const bool failed = duk_pcall(duk, static_cast<duk_idx_t>(arguments.size())) != 0;
    const std::string result = take_text();
    duk_pop_2(duk);
    if (failed) {
      throw std::runtime_error(fmt::format("the page's code failed in {}(): {}", function, result));
    }
    return result;
  }

  void run(std::string_view code) {
    if (duk_peval_lstring(context.get(), code.data(), code.size()) != 0) {
      throw std::runtime_error("the page's code does not run: " + take_text());
    }
    duk_pop(context.get());
  }

 private:
  std::string take_text() {
    duk_size_t size = 0;
    const char* const text = duk_safe_to_lstring(context.get(), -1, &size);
    std::string copy(text, size);
    duk_pop(context.get());
    return copy;
  }
};

namespace {

[[noreturn]] void fail_fatally(void*, const char* message) {
  // Duktape demands that this function never returns to it.
  throw std::runtime_error(fmt::format("the page's code ended its engine: {}", message));
}

}  // namespace

Plotter::Plotter(std::string_view data) : engine_(std::make_unique<Engine>()) {
  engine_->context.reset(duk_create_heap(nullptr, nullptr, nullptr, nullptr, fail_fatally));
  if (!engine_->context) {
    throw std::bad_alloc();
  }
  engine_->run(get_page_assets().figures);
  for (const json& entry : json::parse(engine_->call("load", {data}))) {
    PlotEntry& added = entries_.emplace_back();
    added.id = entry.at("id");
    added.is_table = entry.at("kind") == "table";
    added.tab = entry.at("tab");
    added.title = entry.at("title");
    added.thesis = entry.at("thesis");
    for (const json& choice : entry.at("choices")) {
      PlotChoice& offered = added.choices.emplace_back();
      offered.id = choice.at("id");
      offered.label = choice.at("label");
      offered.initial = choice.at("initial");
      for (const json& option : choice.at("options")) {
        offered.values.push_back(option.at("value"));
      }
    }
  }
}

std::string Plotter::draw(const std::string& id, const Format& format, const Picks& picks) const {
  const std::string chosen = check(id, picks);
  return engine_->call("draw", {id, format.dark ? "dark" : "light", std::to_string(format.width),
                                std::to_string(format.height), chosen});
}

std::string Plotter::make_csv(const std::string& id, const Picks& picks) const {
  return engine_->call("table", {id, check(id, picks)});
}

#else

struct Plotter::Engine {};

Plotter::Plotter(std::string_view) {
  get_page_assets();
}

std::string Plotter::draw(const std::string&, const Format&, const Picks&) const {
  return {};
}

std::string Plotter::make_csv(const std::string&, const Picks&) const {
  return {};
}

#endif

Plotter::~Plotter() = default;
Plotter::Plotter(Plotter&&) noexcept = default;
Plotter& Plotter::operator=(Plotter&&) noexcept = default;

std::string Plotter::check(const std::string& id, const Picks& picks) const {
  const auto entry = std::ranges::find(entries_, id, &PlotEntry::id);
  if (entry == entries_.end()) {
    std::vector<std::string> ids;
    for (const PlotEntry& one : entries_) {
      ids.push_back(one.id);
    }
    throw Error(ErrorKind::usage, describe_unknown("figure", id, ids));
  }
  for (const auto& [name, value] : picks) {
    const auto choice = std::ranges::find(entry->choices, name, &PlotChoice::id);
    if (choice == entry->choices.end()) {
      std::vector<std::string> names;
      for (const PlotChoice& one : entry->choices) {
        names.push_back(one.id);
      }
      throw Error(ErrorKind::usage, names.empty()
                                        ? fmt::format("figure '{}' has no choices, so none is '{}'",
                                                      id, sanitize(name))
                                        : describe_unknown("choice of figure " + id, name, names));
    }
    if (std::ranges::find(choice->values, value) == choice->values.end()) {
      throw Error(ErrorKind::usage, describe_unknown(fmt::format("{} of figure {}", name, id),
                                                     value, choice->values));
    }
  }
  return json(picks).dump(-1, ' ', false, json::error_handler_t::replace);
}

}  // namespace armwright
