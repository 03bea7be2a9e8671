// armwright watch opens a browser on a terminal of a user who has a display, and nowhere else.
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "base/temporary_folder.hpp"
#include "e2e/program.hpp"
#include "wait_until.hpp"

namespace armwright {
namespace {

class CliWatch : public testing::Test {
 protected:
  void SetUp() override {
    const Outcome outcome = run_program(
        folder_.path(), {"optimize", "sphere", "--budget", "20", "--out", "run", "--quiet"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    make_browser("xdg-open");
    make_browser("own-browser");
  }

  // A program that writes its arguments into the file `opened`, and to the streams.
  void make_browser(const std::string& name) {
    std::filesystem::create_directories(folder_ / "bin");
    const auto file = folder_ / "bin" / name;
    std::ofstream(file) << "#!/bin/sh\necho noise; echo noise >&2\necho \"" << name << " $*\" > '"
                        << (folder_ / "part").string() << "'\nmv '" << (folder_ / "part").string()
                        << "' '" << (folder_ / "opened").string() << "'\n";
    std::filesystem::permissions(file, std::filesystem::perms::owner_all);
  }

  Environment make_environment(std::vector<std::pair<std::string, std::string>> variables) const {
    const std::pair<std::string, std::string> path = {
        "PATH", (folder_ / "bin").string() + ":/usr/bin:/bin"};
    variables.push_back(path);
    for (const char* name : {"DISPLAY", "WAYLAND_DISPLAY", "BROWSER"}) {
      if (std::ranges::none_of(variables, [&](const auto& one) { return one.first == name; })) {
        variables.emplace_back(name, "");
      }
    }
    return {.variables = std::move(variables), .out_file = "", .interrupt_at = "Ctrl-C ends it"};
  }

  // Returns the address that the page has on the terminal.
  std::string watch_on_terminal(std::vector<std::pair<std::string, std::string>> variables,
                                const std::vector<std::string>& flags = {}) {
    std::vector<std::string> words = {"watch", "run"};
    words.insert(words.end(), flags.begin(), flags.end());
    const std::string shown =
        run_on_terminal(folder_.path(), words, make_environment(std::move(variables)));
    EXPECT_EQ(shown.find("noise"), std::string::npos) << shown;
    const std::size_t begin = shown.find("http://");
    EXPECT_NE(begin, std::string::npos) << shown;
    return shown.substr(begin, shown.find(' ', begin) - begin);
  }

  std::string wait_for_browser() const {
    EXPECT_TRUE(wait_until([&] { return std::filesystem::exists(folder_ / "opened"); }));
    return read_text(folder_ / "opened");
  }
  bool has_opened() const { return std::filesystem::exists(folder_ / "opened"); }

  TemporaryFolder folder_;
};

TEST_F(CliWatch, OpensThePageWhereThereIsADisplay) {
  for (const char* display : {"DISPLAY", "WAYLAND_DISPLAY"}) {
    const std::string url = watch_on_terminal({{display, ":7"}});
    EXPECT_EQ(wait_for_browser(), "xdg-open " + url + "\n");
    std::filesystem::remove(folder_ / "opened");
  }
}

TEST_F(CliWatch, OpensTheUsersOwnBrowser) {
  const std::string url = watch_on_terminal({{"BROWSER", "own-browser --new %s;id:xdg-open"}});
  EXPECT_EQ(wait_for_browser(), "own-browser --new %s;id " + url + "\n");  // no shell reads this
  std::filesystem::remove(folder_ / "opened");
  const std::string another = watch_on_terminal({{"BROWSER", "own-browser %s --new"}});
  EXPECT_EQ(wait_for_browser(), "own-browser " + another + " --new\n");
}

TEST_F(CliWatch, OpensNothingOnRequestOrWithoutADisplay) {
  watch_on_terminal({{"DISPLAY", ":7"}}, {"--no-open"});
  EXPECT_FALSE(has_opened());
  watch_on_terminal({});
  EXPECT_FALSE(has_opened());
}

TEST_F(CliWatch, OpensNothingFromAPipe) {
  Environment environment = make_environment({{"DISPLAY", ":7"}, {"BROWSER", "own-browser"}});
  environment.own_group = true;
  Program program(folder_.path(), {"watch", "run"}, environment);
  EXPECT_TRUE(wait_until([&] {
    return std::ranges::any_of(
        std::filesystem::directory_iterator(folder_.path()), [](const auto& entry) {
          return read_text(entry.path() / "out").find("http://") != std::string::npos;
        });
  }));
  program.send_group(SIGINT);
  EXPECT_EQ(program.wait().exit_code, 0);
  EXPECT_FALSE(has_opened());
}

TEST_F(CliWatch, WorksWithoutABrowser) {
  std::filesystem::remove_all(folder_ / "bin");
  EXPECT_NE(watch_on_terminal({{"BROWSER", "no-such-program"}}), "");
}

}  // namespace
}  // namespace armwright
