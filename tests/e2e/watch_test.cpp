// armwright watch opens a browser on a terminal of a user who has a display, and nowhere else.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "base/temporary_folder.hpp"
#include "e2e/processes.hpp"
#include "e2e/program.hpp"
#include "wait_until.hpp"

namespace armwright {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::MatchesRegex;
using testing::Not;
using testing::StartsWith;

class CliWatch : public testing::Test {
 protected:
  void SetUp() override {
    const Outcome outcome = run_program(
        folder_.path(),
        {"optimize", "sphere", "--optimizer", "ga", "--budget", "20", "--out", "run", "--quiet"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    for (const char* name : {"xdg-open", "own-browser"}) {
      make_browser(name);
    }
    std::filesystem::create_directories(temporary_);
  }

  // A program that writes its arguments into the file `opened`, its argument's file into `page`, and
  // the rights of this file and of its folder into `rights`. Once it has ended and `watch` has
  // reaped it, it interrupts `watch`.
  void make_browser(const std::string& name) {
    std::filesystem::create_directories(folder_ / "bin");
    const auto file = folder_ / "bin" / name;
    std::ofstream(file) << "#!/bin/sh\necho noise; echo noise >&2\ncd '" << folder_.path().string()
                        << "'\necho \"" << name << R"sh( $*" > opened
page=$(echo "$*" | sed 's,.*file://\([^ ;]*\).*,\1,; s/%20/ /g')
cat "$page" > page
stat -c %a "$page" "$(dirname "$page")" > rights
browser=$$
watch=$PPID
(while kill -0 $browser && kill -0 $watch; do sleep 0.01; done; kill -INT $watch) &
)sh";
    std::filesystem::permissions(file, std::filesystem::perms::owner_all);
  }

  Environment make_environment(std::vector<std::pair<std::string, std::string>> variables) const {
    const std::vector<std::pair<std::string, std::string>> others = {
        {"PATH", (folder_ / "bin").string() + ":/usr/bin:/bin"},
        {"TMPDIR", temporary_.string()},
        {"WATCH_TEST", folder_.path().string()},
        {"DISPLAY", ""},
        {"WAYLAND_DISPLAY", ""},
        {"BROWSER", ""}};
    for (const auto& other : others) {
      if (std::ranges::none_of(variables,
                               [&](const auto& one) { return one.first == other.first; })) {
        variables.push_back(other);
      }
    }
    return {.variables = std::move(variables), .out_file = ""};
  }

  // Returns the address that the page has on the terminal, after the end of `watch` and of all its
  // children. The browser interrupts `watch`; without one, its last words do.
  std::string watch_on_terminal(std::vector<std::pair<std::string, std::string>> variables,
                                bool has_browser, const std::vector<std::string>& flags = {}) {
    std::vector<std::string> words = {"watch", "run"};
    words.insert(words.end(), flags.begin(), flags.end());
    Environment environment = make_environment(std::move(variables));
    environment.interrupt_at = has_browser ? "" : "Ctrl-C ends it";
    const std::string shown = run_on_terminal(folder_.path(), words, environment);
    wait_for_children();
    EXPECT_EQ(shown.find("noise"), std::string::npos) << shown;
    const std::size_t begin = shown.find("http://");
    EXPECT_NE(begin, std::string::npos) << shown;
    return shown.substr(begin, shown.find(' ', begin) - begin);
  }

  // A child of `watch` has its environment, from the moment of its creation.
  void wait_for_children() const {
    EXPECT_TRUE(wait_until(
        [&] { return list_processes_with("WATCH_TEST=" + folder_.path().string()).empty(); }));
  }

  // Returns what the browser was started with, and removes it. Empty if none was started.
  std::string take_opened() const {
    const std::string opened = read_text(folder_ / "opened");
    std::filesystem::remove(folder_ / "opened");
    return opened;
  }

  TemporaryFolder folder_;
  std::filesystem::path temporary_ = folder_ / "a folder";
};

TEST_F(CliWatch, OpensThePageWhereThereIsADisplay) {
  for (const char* display : {"DISPLAY", "WAYLAND_DISPLAY"}) {
    watch_on_terminal({{display, ":7"}}, true);
    EXPECT_THAT(take_opened(), StartsWith("xdg-open file:///"));
  }
}

TEST_F(CliWatch, OtherUsersDoNotSeeTheAddress) {
  const std::string url = watch_on_terminal({{"DISPLAY", ":7"}}, true);
  EXPECT_THAT(take_opened(), AllOf(HasSubstr("/a%20folder/armwright-"), Not(HasSubstr("http"))));
  EXPECT_THAT(read_text(folder_ / "page"), HasSubstr("content=\"0; url=" + url + "\""));
  EXPECT_EQ(read_text(folder_ / "rights"), "600\n700\n");
  EXPECT_TRUE(std::filesystem::is_empty(temporary_));  // it ends with the command
}

TEST_F(CliWatch, OpensTheUsersOwnBrowser) {
  watch_on_terminal({{"BROWSER", "own-browser --new %s;id:xdg-open"}}, true);
  EXPECT_THAT(take_opened(), MatchesRegex("own-browser --new file:///.*html;id\n"));  // no shell
  watch_on_terminal({{"BROWSER", "own-browser --url=%s --new"}}, true);
  EXPECT_THAT(take_opened(), MatchesRegex("own-browser --url=file:///.*html --new\n"));
  watch_on_terminal({{"BROWSER", "own-browser --new"}}, true);
  EXPECT_THAT(take_opened(), MatchesRegex("own-browser --new file:///.*html\n"));
}

TEST_F(CliWatch, OpensNothingOnRequestOrWithoutADisplay) {
  watch_on_terminal({{"DISPLAY", ":7"}}, false, {"--no-open"});
  EXPECT_EQ(take_opened(), "");
  watch_on_terminal({}, false);
  EXPECT_EQ(take_opened(), "");
}

TEST_F(CliWatch, OpensNothingIfTheFileCannotBeWritten) {
  watch_on_terminal({{"DISPLAY", ":7"}, {"TMPDIR", (folder_ / "nowhere").string()}}, false);
  EXPECT_EQ(take_opened(), "");
}

TEST_F(CliWatch, OpensNothingFromAPipe) {
  Environment environment = make_environment({{"DISPLAY", ":7"}, {"BROWSER", "own-browser"}});
  environment.own_group = true;
  Program program(folder_.path(), {"watch", "run"}, environment);
  wait_for_address(folder_.path());
  program.send_group(SIGINT);
  EXPECT_EQ(program.wait().exit_code, 0);
  wait_for_children();
  EXPECT_EQ(take_opened(), "");
}

TEST_F(CliWatch, WorksWithoutABrowser) {
  std::filesystem::remove_all(folder_ / "bin");
  EXPECT_NE(watch_on_terminal({{"BROWSER", "no-such-program"}}, false), "");
  EXPECT_TRUE(std::filesystem::is_empty(temporary_));
}

}  // namespace
}  // namespace armwright
