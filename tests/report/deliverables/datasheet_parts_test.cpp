#include "report/deliverables/datasheet_parts.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace armwright {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

TEST(HtmlTable, EscapesEveryTextInElementsAndAttributes) {
  const std::string hostile = "<b>\"&";
  const std::vector<std::string> heads = {"", hostile};
  const std::vector<std::vector<HtmlCell>> rows = {{{hostile}, {"1", "met"}}};
  EXPECT_EQ(make_table(heads, rows),
            "<table>\n<tr><th title=\"\"></th>"
            "<th title=\"&lt;b&gt;&quot;&amp;\">&lt;b&gt;&quot;&amp;</th></tr>\n"
            "<tr><th title=\"&lt;b&gt;&quot;&amp;\">&lt;b&gt;&quot;&amp;</th>"
            "<td class=\"met\" title=\"1\">1</td></tr>\n</table>\n");
}

TEST(HtmlTable, LeavesOutFactsWithoutText) {
  const std::vector<std::pair<std::string, std::string>> facts = {{"a", ""}, {"b<", "c&"}};
  EXPECT_EQ(make_fact_list(facts), "<dl>\n<dt>b&lt;</dt><dd>c&amp;</dd>\n</dl>\n");
}

TEST(LineFigure, TicksAreRoundNumbersUpToTheLargest) {
  EXPECT_THAT(make_ticks(1), ElementsAre(0, 0.2, 0.4, testing::DoubleEq(0.6), 0.8, 1));
  EXPECT_THAT(make_ticks(28.5), ElementsAre(0, 5, 10, 15, 20, 25));
  EXPECT_THAT(make_ticks(9.9), ElementsAre(0, 2, 4, 6, 8));
}

// The figure's area reaches from 42 to 350 and from 20 (top) to 136 (bottom).
TEST(LineFigure, ReachesFromCornerToCorner) {
  const LineFigure linear{"t<", "x", "y", {{0, 0}, {5, 1}, {10, 4}}};
  const std::string svg = make_svg(linear);
  EXPECT_THAT(svg, HasSubstr("points=\"42.0,136.0 196.0,107.0 350.0,20.0 \""));
  EXPECT_THAT(svg, HasSubstr(">t&lt;</text>"));
  EXPECT_THAT(svg, Not(HasSubstr("t<<")));
  const LineFigure logarithmic{"", "", "", {{0.1, 0}, {1, 1}, {10, 1}}, true};
  EXPECT_THAT(make_svg(logarithmic), HasSubstr("points=\"42.0,136.0 196.0,20.0 350.0,20.0 \""));
}

TEST(LineFigure, OfZerosAloneIsStillFinite) {
  const std::string svg = make_svg({"", "", "", {{0, 0}, {0, 0}}});
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
  EXPECT_THAT(svg, Not(HasSubstr("inf")));
}

}  // namespace
}  // namespace armwright
