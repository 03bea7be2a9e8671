// Writes the Python program that starts cocopp on an export.

#include <fmt/format.h>

#include <set>

#include "base/text.hpp"
#include "report/formats/export_files.hpp"
#include "report/formats/formats.hpp"

namespace armwright {
namespace {

// The testbed is a subclass because cocopp looks its settings up by the name of a class. Groups of
// functions, the reference algorithm and the list of names for the pages' menus belong to COCO's
// own functions, so they are left out. cocopp's tables need two numbers of variables, which may be
// equal.
constexpr const char* kScript = R"(#!/usr/bin/env python3
"""Makes cocopp's pages of this export.

    python3 {script} [OPTION ...]     with cocopp's own options, as in -o FOLDER

cocopp does not know the suite '{suite}'. This program tells it the suite and the names of its functions.
"""
import pathlib
import sys

import cocopp
from cocopp import testbedsettings

FUNCTIONS = {{{functions}}}
DIMENSIONS = [{dimensions}]


class ArmwrightTestbed(testbedsettings.GECCOBBOBTestbed):
    """Functions of an export of armwright."""

    def __init__(self, target_values):
        ends = (DIMENSIONS[0], DIMENSIONS[-1])
        numbers = (min(FUNCTIONS), max(FUNCTIONS))
        own = dict(
            name="{suite}", short_names=FUNCTIONS, functions_with_legend=numbers, first_function_number=numbers[0],
            last_function_number=numbers[1], dimensions_to_display=DIMENSIONS, goto_dimension=ends[1],
            rldDimsOfInterest=ends, tabDimsOfInterest=ends, flex_navigation_json_file="",
            reference_algorithm_filename="", reference_algorithm_displayname="",
            plots_on_main_html_page=[f"pprldmany_{{d:02d}}D_noiselessall.svg" for d in DIMENSIONS])
        for key, value in {{**self.settings, **own}}.items():
            setattr(self, key, value)
        self.instantiate_attributes(target_values)

    def filter(self, dsl):
        return dsl

    def info(self, fun_number=None):
        return self.__doc__ if fun_number is None else f"{{fun_number}} {{FUNCTIONS[fun_number]}}"


testbedsettings.ArmwrightTestbed = ArmwrightTestbed
testbedsettings.suite_to_testbed["{suite}"] = "ArmwrightTestbed"
folders = [str(folder) for folder in sorted(pathlib.Path(__file__).resolve().parent.iterdir()) if folder.is_dir()
           and list(folder.glob("*.info"))]
cocopp.main(sys.argv[1:] + folders)
)";

}  // namespace

std::string make_coco_script(std::span<const ExportFunction> functions) {
  std::vector<std::string> names;
  std::set<std::size_t> dimensions;
  for (const ExportFunction& function : functions) {
    // matplotlib and LaTeX give other characters a meaning.
    names.push_back(fmt::format("{}: \"{}\"", function.id, escape_file_name(function.name)));
    for (const ProblemRuns* problem : function.problems) {
      dimensions.insert(problem->names.variables.size());
    }
  }
  std::vector<std::string> numbers;
  for (const std::size_t dimension : dimensions) {
    numbers.push_back(std::to_string(dimension));
  }
  return fmt::format(fmt::runtime(kScript), fmt::arg("script", kCocoScript),
                     fmt::arg("suite", kCocoSuite), fmt::arg("functions", join(names, ", ")),
                     fmt::arg("dimensions", join(numbers, ", ")));
}

}  // namespace armwright
