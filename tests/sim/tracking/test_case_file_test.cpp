
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "base/random.hpp"
#include "sim/tracking/test_case.hpp"

namespace armwright {
namespace {

namespace fs = std::filesystem;
using testing::StartsWith;

const std::string kHeader = "case,point,x_m,y_m,z_m\n";

class TestCaseFile : public testing::Test {
 protected:
  TestCaseFile() {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~TestCaseFile() override { fs::remove_all(folder_); }

  std::string path() const { return (folder_ / "cases").string(); }

  TestSet load(const std::string& content) const {
    fs::remove(path());  // a file system may sync a file that is overwritten, which takes
                         // milliseconds each time
    std::ofstream(path(), std::ios::binary) << content;
    return TestSet::load(path());
  }

  // Returns the refusal's text after the file's name.
  std::string refusal(const std::string& content) const {
    try {
      load(content);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::bad_data);
      EXPECT_THAT(error.what(), StartsWith(path() + ":"));
      return std::string(error.what()).substr(path().size() + 1);
    }
    return "(no error)";
  }

 private:
  // One folder per test, because tests run at the same time.
  fs::path folder_ = fs::path(testing::TempDir()) /
                     (std::string("armwright-cases-") +
                      testing::UnitTest::GetInstance()->current_test_info()->name());
};

std::vector<TestCase> collect(const TestSet& set) {
  std::vector<TestCase> cases;
  for (std::uint64_t i = 0; i < set.size().value(); ++i) {
    cases.push_back(set.make_case(i));
  }
  return cases;
}

TEST_F(TestCaseFile, GeneratedCasesComeBackBitForBit) {
  const TestSet generated = TestSet::make_generated("test/2", {});
  std::vector<TestCase> cases;
  for (std::uint64_t i = 0; i < 30; ++i) {
    cases.push_back(generated.make_case(i));
  }
  const TestSet from_json = load(to_json(cases));
  const TestSet from_csv = load(to_csv(cases));
  EXPECT_EQ(from_json.size(), 30u);
  EXPECT_EQ(calc_content_hash(collect(from_json)), calc_content_hash(cases));
  EXPECT_EQ(calc_content_hash(collect(from_csv)), calc_content_hash(cases));
  EXPECT_EQ(from_json.name(), "file:" + calc_content_hash(cases).substr(0, 16));
  EXPECT_EQ(from_csv.name(), from_json.name());
  EXPECT_EQ(to_csv(collect(from_json)), to_csv(cases));
  EXPECT_EQ(to_json(collect(from_csv)), to_json(cases));
}

// Whole numbers, signed zeros, denormals, the ends of the range; cases of different lengths.
TEST_F(TestCaseFile, AwkwardNumbersComeBackBitForBit) {
  const double tiny = std::numeric_limits<double>::denorm_min();
  const std::vector<TestCase> cases = {
      {{{1, -2, 0}, {-0.0, 0.1 + 0.2, 1e-300}, {100, -100, std::nextafter(100, 0)}}},
      {{{tiny, -tiny, 1.0 / 3}, {1e22 / 1e21, -1e-5, 5e-324}}}};
  EXPECT_EQ(calc_content_hash(collect(load(to_json(cases)))), calc_content_hash(cases));
  EXPECT_EQ(calc_content_hash(collect(load(to_csv(cases)))), calc_content_hash(cases));
}

TEST_F(TestCaseFile, RandomNumbersComeBackBitForBit) {
  RandomStream random("test-case-file");
  std::vector<TestCase> cases(1);
  for (int i = 0; i < 2000; ++i) {
    const auto number = [&] {
      return random.uniform(-10, 10) * std::pow(10.0, random.uniform(-20, 1));
    };
    const double x = number();
    const double y = number();
    cases[0].points_m.emplace_back(x, y, number());
  }
  EXPECT_EQ(calc_content_hash(collect(load(to_json(cases)))), calc_content_hash(cases));
  EXPECT_EQ(calc_content_hash(collect(load(to_csv(cases)))), calc_content_hash(cases));
}

TEST_F(TestCaseFile, TheFormsAreWhatTheManualSays) {
  const std::vector<TestCase> cases = {{{{1.4, 0, 0.9}, {1.25, -0.5, 1}}},
                                       {{{1, 2, 3}, {1, 2, 3.5}}}};
  EXPECT_EQ(to_json(cases),
            "{\"cases\": [\n[[1.4, 0, 0.9], [1.25, -0.5, 1]],\n[[1, 2, 3], [1, 2, 3.5]]\n]}\n");
  EXPECT_EQ(to_csv(cases), kHeader + "0,0,1.4,0,0.9\n0,1,1.25,-0.5,1\n1,0,1,2,3\n1,1,1,2,3.5\n");
}

TEST_F(TestCaseFile, KeysOtherThanCasesAreIgnored) {
  const TestSet set = TestSet::load(fs::path(ARMWRIGHT_TEST_DATA) / "tracking-oracle.json");
  EXPECT_EQ(set.size(), 3u);
  for (std::uint64_t i = 0; i < 3; ++i) {
    const auto points_m = set.make_case(i).points_m;
    ASSERT_EQ(points_m.size(), 26u);
    EXPECT_EQ(points_m[0], Eigen::Vector3d(1.3999999999999999, 0, 0.90000000000000002));
  }
  EXPECT_EQ(set.make_case(1).points_m[25],
            Eigen::Vector3d(1.763405191996197, -0.2769572539908192, 0.6086991572831767));
  EXPECT_EQ(
      load(R"({"a": [[{"cases": 3}]], "cases": [[[1,2,3],[1,2,4]]], "b": null, "c": -7})").size(),
      1u);
}

TEST_F(TestCaseFile, SpreadsheetsMayHaveWrittenIt) {
  const std::string plain = kHeader + "0,0,1,2,3\n0,1,1,2,4\n";
  std::string dos = "\xEF\xBB\xBF";
  for (const char letter : plain) {
    dos += letter == '\n' ? "\r\n" : std::string(1, letter);
  }
  EXPECT_EQ(load(dos).name(), load(plain).name());
  EXPECT_EQ(load(plain.substr(0, plain.size() - 1)).name(), load(plain).name());
  EXPECT_EQ(load("\xEF\xBB\xBF {\"cases\":[[[1,2,3],[1,2,4]]]}").name(), load(plain).name());
}

TEST_F(TestCaseFile, AFileThatIsNotThereIsAnIoError) {
  try {
    TestSet::load(path());
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::io);
    EXPECT_EQ(error.what(), path() + ": cannot open it: No such file or directory");
  }
}

struct Malformed {
  std::string content;
  std::string message;  // after FILE:
};

TEST_F(TestCaseFile, MalformedCsvIsRefusedByLine) {
  const std::string head = kHeader + "0,0,1,2,3\n0,1,1,2,4\n";
  const std::string in_order =
      ": cases and their points are counted from 0, in order, without gaps";
  const std::vector<Malformed> all = {
      {"",
       " is empty; it must be JSON with \"cases\" or CSV with the header case,point,x_m,y_m,z_m"},
      {" \r\n\t\n",
       " is empty; it must be JSON with \"cases\" or CSV with the header case,point,x_m,y_m,z_m"},
      {"case;point;x_m;y_m;z_m\n0;0;1;2;3\n",
       "1: the first line is 'case;point;x_m;y_m;z_m'; it must be case,point,x_m,y_m,z_m (CSV), or "
       "the file must begin with { (JSON)"},
      {"0,0,1,2,3\n",
       "1: the first line is '0,0,1,2,3'; it must be case,point,x_m,y_m,z_m (CSV), or the file "
       "must "
       "begin with { (JSON)"},
      {std::string("PK\x03\x04\x1b[31m") + std::string(100, 'x'),
       "1: the first line is 'PK???[31m" + std::string(71, 'x') +
           "...'; it must be case,point,x_m,y_m,z_m (CSV), or the file must begin with { (JSON)"},
      {kHeader, " has no rows below its header; it must hold at least one case"},
      {head + "0,2,1,2\n",
       "4: a row must have exactly 5 fields: case,point,x_m,y_m,z_m; '0,2,1,2' has 4"},
      {head + "0,2,1,2,3,\n",
       "4: a row must have exactly 5 fields: case,point,x_m,y_m,z_m; '0,2,1,2,3,' has 6"},
      {head + "\n0,2,1,2,3\n",
       "4: a row must have exactly 5 fields: case,point,x_m,y_m,z_m; '' has 1"},
      {head + "zero,2,1,2,3\n", "4: case is 'zero'; it must be an integer >= 0"},
      {head + "0,-1,1,2,3\n", "4: point is '-1'; it must be an integer >= 0"},
      {head + "0,2.0,1,2,3\n", "4: point is '2.0'; it must be an integer >= 0"},
      {head + "99999999999999999999,0,1,2,3\n",
       "4: case is '99999999999999999999'; it must be an integer >= 0"},
      {head + "0,2,nan,2,3\n",
       "4: x_m is 'nan'; it must be a finite number, in m, with nothing around"},
      {head + "0,2,1,1e999,3\n",
       "4: y_m is '1e999'; it must be a finite number, in m, with nothing around"},
      {head + "0,2,1,2, 3\n",
       "4: z_m is ' 3'; it must be a finite number, in m, with nothing around"},
      {head + "0,2,1,2,3 m\n",
       "4: z_m is '3 m'; it must be a finite number, in m, with nothing around"},
      {head + "0,2,,2,3\n", "4: x_m is ''; it must be a finite number, in m, with nothing around"},
      {head + "0,3,1,2,3\n",
       "4: is case 0, point 3; it must be case 0, point 2 or case 1, point 0" + in_order},
      {head + "0,1,1,2,3\n",
       "4: is case 0, point 1; it must be case 0, point 2 or case 1, point 0" + in_order},
      {head + "1,1,1,2,3\n",
       "4: is case 1, point 1; it must be case 0, point 2 or case 1, point 0" + in_order},
      {head + "2,0,1,2,3\n",
       "4: is case 2, point 0; it must be case 0, point 2 or case 1, point 0" + in_order},
      {kHeader + "1,0,1,2,3\n", "2: is case 1, point 0; it must be case 0, point 0" + in_order},
      {kHeader + "0,1,1,2,3\n", "2: is case 0, point 1; it must be case 0, point 0" + in_order},
      {head + "1,0,1,2,3\n2,0,1,2,3\n2,1,1,2,4\n",
       "4: case 1, point 0 is its only one; a case must have at least 2 points: the start and "
       "where to go"},
      {head + "1,0,1,2,3\n",
       "4: case 1, point 0 is its only one; a case must have at least 2 points: the start and "
       "where to go"},
      {head + "1,0,1,2,3\n1,1,2,2,3\n1,2,2,2,3\n1,3,2,2,4\n",
       "6: case 1, point 2 is where the point before is; each point must differ from the one "
       "before "
       "it"},
      {head + "0,2,1400,0,900\n0,3,1,2,3\n",
       "4: case 0, point 2 has the coordinate 1400 m; it must lie within +-100 m (are the "
       "coordinates in metres?)"},
  };
  for (const Malformed& malformed : all) {
    EXPECT_EQ(refusal(malformed.content), malformed.message) << malformed.content;
  }
}

TEST_F(TestCaseFile, MalformedJsonIsRefusedByCaseAndPoint) {
  const std::string first = R"({"cases": [[[1,2,3],[1,2,4]], )";
  const std::vector<Malformed> all = {
      {"{}", " has no \"cases\"; it must be {\"cases\": [[[x, y, z], ...], ...]} in metres"},
      {R"({"Cases": [[[1,2,3],[1,2,4]]]})",
       " has no \"cases\"; it must be {\"cases\": [[[x, y, z], ...], ...]} in metres"},
      {R"({"a": {"cases": [[[1,2,3],[1,2,4]]]}})",
       " has no \"cases\"; it must be {\"cases\": [[[x, y, z], ...], ...]} in metres"},
      {R"([[[1,2,3],[1,2,4]]])",
       " is an array; it must be an object: {\"cases\": [[[x, y, z], ...], ...]}"},
      {R"({"cases": []})", " \"cases\" is empty; it must hold at least one case"},
      {R"({"cases": {}})",
       " \"cases\" is an object; it must be an array of cases, each an array of points [x, y, z] "
       "in "
       "metres, the start first"},
      {R"({"cases": 12})",
       " \"cases\" is 12; it must be an array of cases, each an array of points [x, y, z] in "
       "metres, "
       "the start first"},
      {first + "[[1,2,3]]], \"cases\": []}",
       " case 1, point 0 is its only one; a case must have at least 2 points: the start and where "
       "to go"},
      {R"({"cases": [[[1,2,3],[1,2,4]]], "cases": [[[1,2,3],[1,2,4]]]})",
       " has \"cases\" twice; it must have it once"},
      {first + "null]}", " case 1 is null; it must be an array of points"},
      {first + "{\"points\": 3}]}", " case 1 is an object; it must be an array of points"},
      {first + "[]]}",
       " case 1, point 0 is missing; a case must have at least 2 points: the start and where to "
       "go"},
      {first + "[[1,2,3], true]]}", " case 1, point 1 is true; it must be [x, y, z] in m"},
      {first + "[[1,2,3], 5.5]]}", " case 1, point 1 is 5.5; it must be [x, y, z] in m"},
      {first + "[[1,2,3], {\"x\": 1}]]}",
       " case 1, point 1 is an object; it must be [x, y, z] in m"},
      {first + "[[1,2,3], [1,2]]]}",
       " case 1, point 1 has 2 coordinates; it must have exactly 3: [x, y, z] in m"},
      {first + "[[1,2,3], []]]}",
       " case 1, point 1 has 0 coordinates; it must have exactly 3: [x, y, z] in m"},
      {first + "[[1,2,3,4,5], [1,2,3]]]}",
       " case 1, point 0 has 5 coordinates; it must have exactly 3: [x, y, z] in m"},
      {first + "[[1,\"2\",3], [1,2,3]]]}",
       " case 1, point 0, coordinate 1 is \"2\"; it must be a number, in m"},
      {first + "[[1,2,null], [1,2,3]]]}",
       " case 1, point 0, coordinate 2 is null; it must be a number, in m"},
      {first + "[[[1],2,3], [1,2,3]]]}",
       " case 1, point 0, coordinate 0 is an array; it must be a number, in m"},
      {first + "[[{},2,3], [1,2,3]]]}",
       " case 1, point 0, coordinate 0 is an object; it must be a number, in m"},
      {first + "[[\"" + std::string(100, 'x') + "\\u001b\",2,3], [1,2,3]]]}",
       " case 1, point 0, coordinate 0 is \"" + std::string(80, 'x') +
           "...\"; it must be a number, in m"},
      {first + "[[1,2,3], [1,2,4], [1,2,4.0]]]}",
       " case 1, point 2 is where the point before is; each point must differ from the one before "
       "it"},
      {first + "[[1,2,3], [1,-18446744073709551616,4]]]}",
       " case 1, point 1 has the coordinate -1.8446744073709552e+19 m; it must lie within +-100 m "
       "(are the coordinates in metres?)"},
      {"{\"note\": " + std::string(7, '[') + std::string(7, ']') + "}",
       " has no \"cases\"; it must be {\"cases\": [[[x, y, z], ...], ...]} in metres"},
      {"{\"note\": " + std::string(8, '[') + std::string(8, ']') + "}",
       " is nested more than 8 deep; test cases need 4"},
      {"{\"note\": " + std::string(200000, '['), " is nested more than 8 deep; test cases need 4"},
  };
  for (const Malformed& malformed : all) {
    EXPECT_EQ(refusal(malformed.content), malformed.message) << malformed.content.substr(0, 200);
  }
}

// The words after the line number come from the JSON library.
TEST_F(TestCaseFile, BrokenJsonIsRefusedByLine) {
  const std::string two_lines = "{\"cases\": [\n[[1,2,3],[1,2,4]],\n";
  const std::vector<Malformed> all = {
      {two_lines + "[[1,2,NaN],[1,2,4]]]}", "3: is not valid JSON: syntax error"},
      {two_lines + "[[1,2,1e999],[1,2,4]]]}", "3: is not valid JSON: number overflow"},
      {two_lines + "[[1,2,3],[1,2,", "3: is not valid JSON: syntax error"},
      {two_lines + "[[1,2,3],[1,2,4]]]}\n\n}", "5: is not valid JSON: syntax error"},
      {"{\"cases\": [[[1,2,3],[1,2,4]],]}", "1: is not valid JSON: syntax error"},
      {"{\"cases\":\n\"a\nb\"}", "2: is not valid JSON: syntax error"},  // at the end of line 2
      {"{", "1: is not valid JSON: syntax error"},
      {"{\"\xff\": 1}", "1: is not valid JSON: syntax error"},
      {"{\"a\": \"" + std::string(100000, 'x'), "1: is not valid JSON: syntax error"},
  };
  for (const Malformed& malformed : all) {
    const std::string message = refusal(malformed.content);
    EXPECT_THAT(message, StartsWith(malformed.message)) << malformed.content.substr(0, 200);
    EXPECT_LT(message.size(), 400u);
  }
}

// Any damaged file is either loaded or refused with a message.
TEST_F(TestCaseFile, DamagedFilesAreLoadedOrRefused) {
  const std::vector<TestCase> cases = {{{{1.4, 0, 0.9}, {1.25, -0.5, 1}}},
                                       {{{1, 2, 3}, {1, 2, 3.5}, {-1e-3, 2, 3}}}};
  const std::string letters = "0123456789.,-+eE[]{}\":nulcases \n\r\t\\\x1b\xff\xc3\xa9";
  RandomStream random("damaged-files");
  int refused = 0;
  for (int i = 0; i < 4000; ++i) {
    std::string content = i % 2 == 0 ? to_json(cases) : to_csv(cases);
    for (std::uint64_t changes = 1 + random.below(3); changes > 0; --changes) {
      const std::size_t at = random.below(content.size());
      switch (random.below(3)) {
        case 0:
          content[at] = letters[random.below(letters.size())];
          break;
        case 1:
          content.erase(at, 1 + random.below(4));
          break;
        default:
          content.insert(at, 1, letters[random.below(letters.size())]);
      }
    }
    try {
      for (const TestCase& loaded : collect(load(content))) {
        ASSERT_FALSE(find_fault(loaded)) << content;
      }
    } catch (const Error& error) {
      ++refused;
      ASSERT_EQ(error.kind(), ErrorKind::bad_data) << content;
      ASSERT_THAT(error.what(), StartsWith(path() + ":")) << content;
    }
  }
  EXPECT_GT(refused, 2000);
  EXPECT_LT(refused, 4000);
}

}  // namespace
}  // namespace armwright
