// `armwright list engines`.

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "base/text.hpp"
#include "cli/list/list_views.hpp"
#include "cli/terminal/table.hpp"

namespace armwright {
namespace {

using nlohmann::json;

// "scalar, sse2, avx2; default avx2"
std::string describe_simd() {
  return fmt::format("{}; default {}", join(supported_simd_names(), ", "),
                     to_string(find_best_simd()));
}

std::string explain(const EngineRow& row, const Style& style) {
  Table table({{"choice", false}, {"flag", false}, {"here", false}});
  if (row.simd) {
    table.add_row({"SIMD level", "--simd LEVEL", describe_simd()});
    table.add_row({"precision in training", "--precision NAME",
                   join(precision_names(), ", ") + "; default double"});
  }
  const std::string none =
      "  It has no choice of SIMD level or precision: it computes in double.\n";
  return format_title(style, row.name, row.summary) +
         (row.simd ? "\n" + table.format(style, 2) : none);
}

json to_json(const EngineRow& row) {
  json simd = nullptr;
  json precisions = {"double"};
  if (row.simd) {
    simd = {{"supported", supported_simd_names()}, {"chosen", to_string(find_best_simd())}};
    precisions = precision_names();
  }
  return {{"name", row.name}, {"summary", row.summary}, {"precisions", precisions}, {"simd", simd}};
}

}  // namespace

ListKind make_engine_kind(std::span<const EngineRow> table) {
  const auto list = [table] {
    std::vector<ListItem> items;
    for (const EngineRow& row : table) {
      items.push_back(
          {row.name, row.summary + (row.simd ? "; SIMD here: " + describe_simd() : "")});
    }
    for (const MissingEngine& missing : missing_engine_table()) {
      items.push_back({missing.name, "not available: " + missing.reason});
    }
    return items;
  };
  return {
      .name = "engines",
      .list = list,
      .explain = [table](const std::string& name,
                         const Style& style) { return explain(find_engine(name, table), style); },
      .explain_as_json =
          [table](const std::string& name) { return to_json(find_engine(name, table)); },
      .list_as_json =
          [table] {
            json all = json::array();
            for (const EngineRow& row : table) {
              all.push_back(to_json(row));
            }
            return all;
          }};
}

}  // namespace armwright
