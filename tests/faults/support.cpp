#include "faults/support.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <sstream>

#include "base/bits.hpp"

namespace armwright::faults {
namespace {

constexpr const char* kDerivedFiles[] = {"result.json", "winner.toml", "convergence.csv",
                                         "winner-trajectory.csv"};

bool same(const EvaluationRecord& a, const EvaluationRecord& b) {
  return a.index == b.index && a.generation == b.generation && a.clipped == b.clipped &&
         same_bits(a.x, b.x) && a.cases.role == b.cases.role && a.cases.set == b.cases.set &&
         a.cases.numbers == b.cases.numbers && a.evaluation.status == b.evaluation.status &&
         a.evaluation.reason == b.evaluation.reason &&
         same_bits(a.evaluation.objectives, b.evaluation.objectives) &&
         same_bits(a.evaluation.case_errors, b.evaluation.case_errors) &&
         same_bits(a.evaluation.metrics, b.evaluation.metrics) &&
         same_bits(a.evaluation.residuals, b.evaluation.residuals);
}

void expect_part(const std::vector<EvaluationRecord>& part,
                 const std::vector<EvaluationRecord>& whole, const char* what) {
  for (const EvaluationRecord& record : part) {
    EXPECT_TRUE(std::ranges::any_of(
        whole, [&](const EvaluationRecord& other) { return same(record, other); }))
        << what << " " << record.index << " is none of the undisturbed run's";
  }
}

}  // namespace

double measure_children_s(const std::function<void()>& action) {
  const auto now_s = [] {
    rusage usage{};
    ::getrusage(RUSAGE_CHILDREN, &usage);
    const auto to_s = [](const timeval& time) {
      return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
    };
    return to_s(usage.ru_utime) + to_s(usage.ru_stime);
  };
  const double before_s = now_s();
  action();
  return now_s() - before_s;
}

std::uintmax_t get_size(const std::filesystem::path& file) {
  std::error_code error;
  const auto size = std::filesystem::file_size(file, error);
  return error ? 0 : size;
}

void write_text(const std::filesystem::path& file, const std::string& text) {
  std::ofstream(file, std::ios::binary) << text;
}

void flip_byte(const std::filesystem::path& file, std::size_t offset) {
  std::string text = read_text(file);
  ASSERT_LT(offset, text.size());
  text[offset] = static_cast<char>(text[offset] ^ 1);
  write_text(file, text);
}

std::string get_plugin(const std::string& name) {
  return std::string(ARMWRIGHT_TEST_PLUGINS) + "/lib" + name + ".so";
}
std::string get_script(const std::string& name) {
  return std::filesystem::path(ARMWRIGHT_TEST_DATA "/../plugins/" + name).lexically_normal();
}

Words become_ordinary_user() {
  if (::getuid() != 0) {
    return {};
  }
  return {"setpriv", "--reuid=65534", "--regid=65534", "--clear-groups", "--"};
}

void open_to_all(const std::filesystem::path& folder) {
  std::filesystem::permissions(folder, std::filesystem::perms::all);
}

Words make_run(const std::string& out, const std::string& budget) {
  return {"optimize",    "q1-complex",
          "--optimizer", "ga",
          "--engine",    "articulated",
          "--budget",    budget,
          "--set",       "workspace.points=4",
          "--set",       "sets.test_cases=4",
          "--set",       "sets.validation_cases=2",
          "--out",       out,
          "--quiet"};
}

FailingFiles::FailingFiles(const std::filesystem::path& folder, std::string call)
    : folder_(std::filesystem::canonical(folder)), call_(std::move(call)) {}

Environment FailingFiles::make_environment(Fault fault, std::uint64_t at, int error) {
  write_text(counter_ / "count", std::string(sizeof(std::uint64_t), '\0'));
  Environment environment;
  environment.variables = {{"LD_PRELOAD", ARMWRIGHT_FAILING_FILES},
                           {"FAILING_FILES_FOLDER", folder_},
                           {"FAILING_FILES_CALL", call_},
                           {"FAILING_FILES_AT", std::to_string(fault == Fault::none ? 0 : at)},
                           {"FAILING_FILES_ERROR", std::to_string(error)},
                           {"FAILING_FILES_COUNT", counter_ / "count"}};
  if (fault == Fault::for_ever) {
    environment.variables.emplace_back("FAILING_FILES_FOREVER", "1");
  }
  if (fault == Fault::kill) {
    environment.variables.emplace_back("FAILING_FILES_KILL", "1");
  }
  return environment;
}

std::uint64_t FailingFiles::count() const {
  std::uint64_t count = 0;
  std::ifstream(counter_ / "count", std::ios::binary)
      .read(reinterpret_cast<char*>(&count), sizeof count);
  return count;
}

void expect_part_of(const JournalContent& part, const JournalContent& whole) {
  // Keeps the records in memory, because each is compared with all.
  expect_part({part.training.begin(), part.training.end()},
              {whole.training.begin(), whole.training.end()}, "evaluation");
  expect_part(part.judgements, whole.judgements, "judgement");
}

void expect_same_run(const std::filesystem::path& a, const std::filesystem::path& b) {
  const JournalContent first = read_journal(a / "journal");
  const JournalContent second = read_journal(b / "journal");
  EXPECT_FALSE(first.training.empty());
  EXPECT_TRUE(first.ended && second.ended);
  EXPECT_EQ(second.torn_bytes, 0u);
  ASSERT_EQ(first.training.size(), second.training.size());
  for (std::size_t i = 0; i < first.training.size(); ++i) {
    ASSERT_TRUE(same(first.training[i], second.training[i])) << "evaluation " << i;
  }
  EXPECT_EQ(first.judgements.size(), second.judgements.size());
  expect_part(second.judgements, first.judgements, "judgement");
  for (const char* file : kDerivedFiles) {
    EXPECT_EQ(std::filesystem::exists(a / file), std::filesystem::exists(b / file)) << file;
    EXPECT_EQ(read_text(a / file), read_text(b / file)) << file;
  }
  EXPECT_GT(get_size(b / "results.sqlite"), 0u);
  for (const auto& entry : std::filesystem::directory_iterator(b)) {
    EXPECT_NE(entry.path().extension(), ".new") << entry.path();
  }
}

Words make_arm_comparison(const std::string& out, const std::string& jobs) {
  return {"compare",
          "--problems",
          "q1-complex",
          "--optimizers",
          "ga,cmaes",
          "--replicates",
          "4",
          "--budget",
          "700",
          "--engine",
          "articulated",
          "--set",
          "sets.test_cases=4",
          "--set",
          "sets.validation_cases=2",
          "--jobs",
          jobs,
          "--out",
          out,
          "--quiet"};
}

void expect_finite_numbers(const std::filesystem::path& file) {
  std::string word;
  for (const char c : read_text(file) + " ") {
    const auto lower = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    if (std::isalpha(static_cast<unsigned char>(c)) != 0) {
      word += lower;
      continue;
    }
    EXPECT_TRUE(word != "nan" && word != "inf" && word != "infinity") << file << " says " << word;
    word.clear();
  }
}

}  // namespace armwright::faults
