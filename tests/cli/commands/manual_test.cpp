// The commands as data, and the manual pages, completion and reference made from them.
#include <gmock/gmock.h>

#include <CLI/CLI.hpp>
#include <algorithm>

#include "base/error.hpp"
#include "base/text.hpp"
#include "cli/app.hpp"
#include "cli/manual/command_definition.hpp"
#include "cli/manual/completion.hpp"
#include "cli/manual/manual_formats.hpp"
#include "cli/manual/manual_page.hpp"
#include "cli/terminal/session.hpp"

namespace armwright {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

class Manual : public testing::Test {
 protected:
  Manual() {
    add_all_commands(app_, session_);
    program_ = describe_command(app_);
  }
  const CommandDefinition& find(const std::string& words) const {
    return find_command(program_, split(words, ' '));
  }
  static const ArgumentDefinition& find_flag(const CommandDefinition& command,
                                             const std::string& name) {
    return *std::ranges::find(command.flags, name, &ArgumentDefinition::get_key);
  }

  CLI::App app_;
  Session session_;
  CommandDefinition program_;
};

TEST_F(Manual, ReadsCommandsFromTheParser) {
  EXPECT_EQ(program_.get_title(), "armwright");
  EXPECT_EQ(find("testset export").get_title(), "armwright testset export");
  const CommandDefinition& optimize = find("optimize");
  ASSERT_EQ(optimize.arguments.size(), 1U);
  EXPECT_EQ(optimize.arguments[0].name, "PROBLEM");
  EXPECT_FALSE(optimize.arguments[0].is_required);
  const ArgumentDefinition& seed = find_flag(optimize, "--seed");
  EXPECT_EQ(seed.value, "N");
  EXPECT_EQ(seed.environment, "ARMWRIGHT_SEED");
  EXPECT_FALSE(seed.repeats);
  EXPECT_TRUE(find_flag(optimize, "--opt").repeats);
  EXPECT_THAT(find_flag(optimize, "--quiet").short_names, ElementsAre("-q"));
  EXPECT_EQ(find_flag(optimize, "--quiet").value, "");
  EXPECT_TRUE(find_flag(find("reproduce"), "--out").is_value_optional);
  EXPECT_EQ(find_flag(find("plot"), "--theme").value, "NAME");
  EXPECT_TRUE(find("cell").arguments[1].repeats);
  EXPECT_THAT(find_flag(find("report"), "--out").excludes, ElementsAre("--json"));
}

TEST_F(Manual, RefusesUnknownCommands) {
  const auto refusal = [this](const std::vector<std::string>& words) {
    try {
      find_command(program_, words);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string("found");
  };
  EXPECT_THAT(refusal({"optimise"}), HasSubstr("did you mean 'optimize'?"));
  EXPECT_THAT(refusal({"testset", "exprt"}), HasSubstr("did you mean 'export'? Valid: export"));
  EXPECT_EQ(refusal({"list", "problems"}),
            "'armwright list' has no commands of its own: 'problems' is one too many");
}

// Every flag and argument has a row that says where its values come from.
TEST_F(Manual, KnowsWhereEveryValueComesFrom) {
  for (const CommandDefinition* command : list_all_commands(program_)) {
    for (const auto* group : {&command->arguments, &command->flags}) {
      for (const ArgumentDefinition& argument : *group) {
        if (argument.name.empty() && argument.value.empty()) {
          continue;
        }
        EXPECT_TRUE(find_value_source(*command, argument))
            << command->get_title() << " " << argument.get_key() << " " << argument.value
            << ": a row in value_source.cpp is missing";
      }
    }
  }
}

// The help of a flag names each choice that completion offers.
TEST_F(Manual, OffersOnlyChoicesThatTheHelpNames) {
  for (const CommandDefinition* command : list_all_commands(program_)) {
    for (const ArgumentDefinition& flag : command->flags) {
      const auto source = find_value_source(*command, flag).value_or(ValueSource{});
      if (flag.value.empty() || flag.get_key() == "--simd" || flag.get_key() == "--perturbations" ||
          flag.value == "DESIGN") {
        continue;  // their help names a command or a page that lists the choices
      }
      for (const std::string& choice : source.choices) {
        EXPECT_THAT(flag.description, HasSubstr(choice)) << command->get_title();
      }
    }
  }
}

TEST_F(Manual, ReadsListsTitlesAndParagraphsBelowTheFlags) {
  CommandDefinition command;
  command.words = {"armwright", "do"};
  command.summary = "Do it";
  command.notes =
      "Examples:\n  armwright do      # it\n\nTwo lines\nof text.\n\ndone   it is\n"
      "left   it is not\n\nExit codes:\n  0    done\n  130  interrupted\n\n"
      "Environment: A stands\nfor b.";
  const ManualPage page = make_manual_page(command, program_);
  const auto find_blocks = [&page](const std::string& title) {
    return std::ranges::find(page.sections, title, &ManualSection::title)->blocks;
  };
  const auto description = find_blocks("Description");
  ASSERT_EQ(description.size(), 4U);  // the summary is the first
  EXPECT_EQ(std::get<Paragraph>(description[1]).text, "Two lines of text.");
  EXPECT_EQ(std::get<ManualItem>(description[3]).text, "it is not");
  EXPECT_THAT(std::get<Verbatim>(find_blocks("Examples").at(0)).lines,
              ElementsAre("armwright do      # it"));
  EXPECT_EQ(find_blocks("Exit status").size(), 2U);
  EXPECT_EQ(std::get<Paragraph>(find_blocks("Environment").at(0)).text, "A stands for b.");
}

TEST_F(Manual, SetsRoffThatCanBeCopied) {
  const std::string page =
      to_roff(make_manual_page(find("check-plugin"), program_), "1.2.3", "2026-01-02");
  EXPECT_THAT(page,
              HasSubstr(".TH ARMWRIGHT\\-CHECK\\-PLUGIN 1 2026\\-01\\-02 \"armwright 1.2.3\""));
  EXPECT_THAT(page, HasSubstr("\narmwright\\-check\\-plugin \\- Check whether"));
  EXPECT_THAT(page, HasSubstr("\\fB\\-\\-opt\\fR \\fIKEY=VALUE\\fR\n"));
  EXPECT_THAT(page, HasSubstr("check\\-plugin \\(aqexec:python3 mine.py\\(aq\n"));
  EXPECT_THAT(page, HasSubstr(".BR armwright (1)\n"));
}

TEST_F(Manual, SetsTextAsManDoes) {
  const std::string page = to_text(make_manual_page(find("export"), program_), Style(false), 80);
  EXPECT_THAT(page,
              HasSubstr("SYNOPSIS\n       armwright export [OPTIONS] --format FORMAT FOLDER\n"));
  EXPECT_THAT(page, HasSubstr("       --format FORMAT\n              Required. The format:"));
  // The formats are a list within the item.
  EXPECT_THAT(page, HasSubstr("\n              coco   COCO's bbob-new2"));
  EXPECT_THAT(page, HasSubstr("\n              ros2-control\n                     one arm:"));
  EXPECT_THAT(page, Not(HasSubstr("\n\n\n")));
}

TEST_F(Manual, NamesEveryCommandInTheReference) {
  std::vector<ManualPage> pages;
  for (const CommandDefinition* command : list_all_commands(program_)) {
    pages.push_back(make_manual_page(*command, program_));
  }
  const std::string reference = to_markdown_reference(pages);
  for (const ManualPage& page : pages) {
    EXPECT_THAT(reference, AllOf(HasSubstr("\n## " + page.title + "\n"),
                                 HasSubstr("| [" + page.title + "](#" + page.name + ") |")));
  }
  EXPECT_THAT(reference, HasSubstr("- `-o`, `--optimizer NAME`: The optimizer"));
}

TEST_F(Manual, CompletionKnowsFlagsAndWhereValuesComeFrom) {
  const std::string script = make_bash_completion(program_, "1.2.3");
  EXPECT_THAT(script, HasSubstr("'testset')\n      REPLY='export import hash'\n"));
  EXPECT_THAT(script, HasSubstr("-o | --optimizer) REPLY='list:optimizers file' ;;"));
  EXPECT_THAT(script, HasSubstr("--seed) REPLY='' ;;"));
  EXPECT_THAT(script, HasSubstr("[0-9]*) REPLY='folder' ;;"));  // merge OTHER...
}

}  // namespace
}  // namespace armwright
