#include "process/csv_reader.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "base/text.hpp"

namespace armwright {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::vector<std::vector<std::string>> read(std::string_view text) {
  CsvReader reader(text);
  std::vector<std::vector<std::string>> rows;
  std::vector<std::string> fields;
  while (reader.read_row(fields)) {
    rows.push_back(fields);
  }
  return rows;
}

TEST(CsvReader, ReadsWhatQuoteCsvWrites) {
  const std::vector<std::string> nasty = {"a,b",  "say \"x\"", "",     "two\r\nlines", "'",  " ",
                                          "\"",   "ü",         "=1+1", "'=1+1",        "-5", "'-5",
                                          "@sum", "+",         "''"};
  std::string text;
  for (const std::string& field : nasty) {
    text += (text.empty() ? "" : ",") + quote_csv(field);
  }
  EXPECT_THAT(read(text + "\n1,2\n"), ElementsAre(nasty, ElementsAre("1", "2")));
}

TEST(CsvReader, NothingThatIsWrittenIsAFormula) {
  EXPECT_EQ(quote_csv("=cmd|' /C calc'!A0"), "'=cmd|' /C calc'!A0");
  EXPECT_EQ(quote_csv("@SUM(1,2)"), "\"'@SUM(1,2)\"");
  EXPECT_EQ(quote_csv("-0.5"), "-0.5");
}

TEST(CsvReader, TakesEitherLineEndAndNoneAtTheEnd) {
  EXPECT_THAT(read("a,b\r\n1,\r\n,\"2\""),
              ElementsAre(ElementsAre("a", "b"), ElementsAre("1", ""), ElementsAre("", "2")));
  EXPECT_THAT(read(""), ElementsAre());
}

TEST(CsvReader, RefusesStrayQuotesAndKnowsTheRow) {
  for (const char* text : {"a\n\"b", "a\nb\"c", "a\n\"b\"c"}) {
    CsvReader reader(text);
    std::vector<std::string> fields;
    EXPECT_TRUE(reader.read_row(fields));
    try {
      reader.read_row(fields);
      ADD_FAILURE() << text;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::bad_data);
      EXPECT_THAT(error.what(), HasSubstr("quote"));
      EXPECT_EQ(reader.row(), 2u);
    }
  }
}

}  // namespace
}  // namespace armwright
