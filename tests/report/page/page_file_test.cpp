#include "report/page/page_file.hpp"

#include <gmock/gmock.h>

#include <fstream>
#include <regex>

#include "base/base64.hpp"
#include "base/error.hpp"
#include "base/expect_error.hpp"
#include "base/hash.hpp"
#include "report/page/page_data.hpp"

namespace armwright {
namespace {

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) {
    ++found;
  }
  return found;
}

constexpr const char* kHostile = R"({"format":2,"title":"</script><script>alert(1)</script><!--"})";

TEST(PageFile, DataCannotEndTheirBlock) {
  const std::string harmless = make_page_html("t", R"({"title":""})");
  const std::string hostile = make_page_html("t", kHostile);
  EXPECT_EQ(count(hostile, "</script>"), count(harmless, "</script>"));
  EXPECT_EQ(count(hostile, "<script"), count(harmless, "<script"));
  EXPECT_EQ(count(hostile, "<!--"), count(harmless, "<!--"));
  EXPECT_NE(hostile.find(R"(\u003c/script>\u003cscript>alert(1))"), std::string::npos);
}

TEST(PageFile, TitleIsText) {
  const std::string html = make_page_html("</title><b>\"&", "{}");
  EXPECT_NE(html.find("<title>&lt;/title&gt;&lt;b&gt;&quot;&amp;</title>"), std::string::npos);
}

TEST(PageFile, PolicyNamesTheScriptThatIsThereByItsHash) {
  const std::string html = make_page_html("t", "{}");
  std::smatch found;
  ASSERT_TRUE(
      std::regex_search(html, found,
                        std::regex("default-src 'none'; script-src '(sha256-[^']*)'; "
                                   "style-src '(sha256-[^']*)'; [^\"]*connect-src 'none'")));
  const PageAssets assets = get_page_assets();
  EXPECT_EQ(found[1], "sha256-" + to_base64(calc_sha256(assets.script)));
  EXPECT_EQ(found[2], "sha256-" + to_base64(calc_sha256(assets.style)));
  EXPECT_NE(html.find("<script>" + std::string(assets.script) + "</script>"), std::string::npos);
  EXPECT_EQ(assets.script.find("</script"), std::string_view::npos);
}

TEST(PageFile, OnlyAServedPageMayAskForData) {
  const std::string html = make_page_html("t", "{}", "\"tag\"");
  EXPECT_NE(html.find("connect-src 'self'"), std::string::npos);
  EXPECT_NE(html.find("data-live=\"&quot;tag&quot;\""), std::string::npos);
}

TEST(PageFile, WithoutDataIsLessThanTwoMegabytes) {
  EXPECT_LT(make_page_html("t", "{}").size(), 2'000'000u);
}

TEST(PageFile, DataOfAnotherVersionAreRefused) {
  const std::filesystem::path file = testing::TempDir() + "page_file_version_test.html";
  for (const char* data : {R"({"title": "t"})", R"({"format": 1})", R"({"format": "2"})", "[2]"}) {
    std::ofstream(file) << make_page_html("t", data);
    EXPECT_THAT(error_of(ErrorKind::bad_data, [&] { read_page_data(file); }),
                testing::HasSubstr("make the page again with armwright report"))
        << data;
  }
}

TEST(PageFile, DataAreReadBack) {
  const std::filesystem::path file = testing::TempDir() + "page_file_test.html";
  std::ofstream(file) << make_page_html("t", kHostile);
  EXPECT_TRUE(is_page_file(file));
  EXPECT_EQ(get_page_title(read_page_data(file)), "</script><script>alert(1)</script><!--");
  std::ofstream(file) << "<html></html>";
  EXPECT_FALSE(is_page_file(file));
  EXPECT_THROW(read_page_data(file), Error);
}

}  // namespace
}  // namespace armwright
