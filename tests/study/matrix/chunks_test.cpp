// Chunks of cells, names of cells, and the script and commands that are submitted.
#include "study/matrix/chunks.hpp"

#include <numeric>

#include "study/matrix/cell_selection.hpp"
#include "study/matrix/command_output.hpp"
#include "study/matrix/matrix_support.hpp"
#include "study/matrix/slurm.hpp"

namespace armwright {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

std::vector<Cell> make_cells(std::size_t count, std::size_t problems) {
  std::vector<Cell> cells;
  for (std::size_t i = 0; i < count; ++i) {
    cells.push_back({i % problems, 0, static_cast<int>(i / problems) + 1});
  }
  return cells;
}

std::vector<std::size_t> count_cells_of(std::span<const Chunk> chunks) {
  std::vector<std::size_t> counts;
  for (const Chunk& chunk : chunks) {
    counts.push_back(chunk.cells.size());
  }
  return counts;
}

TEST(Chunks, TakeAsLongAsIsAskedForAndKeepTheOrder) {
  const auto cells = make_cells(11, 2);
  const std::vector<double> durations_s = {10, 20};
  const auto chunks = plan_chunks(cells, durations_s, 60);
  EXPECT_THAT(count_cells_of(chunks), ElementsAre(4, 7));  // the last three are too short alone
  EXPECT_EQ(chunks[0].expected_s, 60);
  EXPECT_EQ(chunks[1].expected_s, 100);
  std::vector<int> replicates;
  for (const Chunk& chunk : chunks) {
    for (const Cell& cell : chunk.cells) {
      replicates.push_back(cell.replicate);
    }
  }
  EXPECT_THAT(replicates, ElementsAre(1, 1, 2, 2, 3, 3, 4, 4, 5, 5, 6));
  EXPECT_THAT(count_cells_of(plan_chunks(cells, durations_s, 1e6)), ElementsAre(11));
  EXPECT_TRUE(plan_chunks({}, durations_s, 60).empty());
}

TEST(Chunks, AreNeverTooManyForAnArray) {
  const auto cells = make_cells(25'000, 3);
  for (const std::vector<double>& durations_s :
       {std::vector<double>{1, 2, 3}, {0, 0, 1}, {1e-9, 5, 1e3}}) {
    const auto chunks = plan_chunks(cells, durations_s, 1e-12);
    EXPECT_LE(chunks.size(), kMostChunks);
    EXPECT_GE(chunks.size(), kMostChunks / 4);
    const auto counts = count_cells_of(chunks);
    EXPECT_EQ(std::accumulate(counts.begin(), counts.end(), std::size_t{0}), cells.size());
  }
}

TEST(Chunks, HaveATimeLimitWithReserve) {
  const std::vector<Chunk> chunks = {{{}, 60}, {{}, 601}};
  EXPECT_EQ(calc_time_limit_min(chunks), 51);  // 4 x 10.02 + 10, rounded up
}

class CellNames : public MatrixTest {
 protected:
  std::vector<std::string> select(const std::vector<std::string>& words) {
    std::vector<std::string> names;
    for (const Cell& one : select_cells(plan_, words)) {
      names.push_back(make_cell_name(plan_, one));
    }
    return names;
  }
};

TEST_F(CellNames, AreNumbersRangesAndNames) {
  EXPECT_THAT(
      select({"3", "0-1", "sphere/ga/r02", "1"}),
      ElementsAre("rosenbrock/random/r01", "sphere/ga/r01", "sphere/random/r01", "sphere/ga/r02"));
  for (const std::string word : {"8", "-1", "5-8", "1-", "-", "99999999999999999999"}) {
    EXPECT_THAT(
        usage_error_of([&] { select({word}); }),
        HasSubstr("'" + word + "' is not a cell of the study; name a cell by its number, 0 to 7,"));
  }
  EXPECT_THAT(usage_error_of([&] { select({"5-3"}); }), HasSubstr("ends before it begins"));
  EXPECT_THAT(usage_error_of([&] { select({"sphere/gaa/r01"}); }), HasSubstr("did you mean 'ga'"));
}

TEST_F(CellNames, AStudyIsItsFolderOrItsPlan) {
  EXPECT_EQ(load_recorded_study(study_).folder, study_);
  EXPECT_EQ(load_recorded_study(study_ / "study.toml").folder, study_);
  EXPECT_THAT(usage_error_of([&] { load_recorded_study(study_ / "problems"); }),
              HasSubstr("is neither the folder of a study nor the study.toml in one"));
}

TEST_F(CellNames, DurationsAndMemoryAreEstimated) {
  const auto durations_s = measure_cell_durations_s(plan_);
  ASSERT_EQ(durations_s.size(), 2U);
  EXPECT_GT(durations_s[0], 0.02);
  EXPECT_LT(durations_s[0], 10);
  EXPECT_NEAR(estimate_cell_memory_mib(plan_), 96, 1);
  StudyPlan large = plan_;
  large.budget = 10'000'000;  // docs/reliability.md: 379 MiB when replayed
  EXPECT_GT(estimate_cell_memory_mib(large), 379);
}

TEST_F(CellNames, AScriptKeepsWhatItIsGivenFromTheShell) {
  CellScriptRequest request;
  request.study = "/tmp/a 'b' $(touch x)\n# \"c\"";
  request.program = "/bin/echo";
  request.folder = temporary_.path();
  request.configs = "a`b`";
  plan_.name = "evil\ntouch y";
  const std::vector<Chunk> chunks = plan_chunks(list_cells(plan_), std::vector<double>{1, 1}, 3);
  std::ofstream(temporary_ / "run.sh") << make_cell_script(plan_, chunks, request);
  const auto run = [&](std::vector<std::string> words) {
    words.insert(words.begin(), {"bash", (temporary_ / "run.sh").string()});
    return run_command(words);
  };
  const CommandOutput one = run({"2"});
  EXPECT_EQ(one.out, "cell --jobs 1 " + request.study.string() +
                         " rosenbrock/random/r01 sphere/ga/r02 sphere/random/r02 "
                         "rosenbrock/ga/r02 rosenbrock/random/r02\n");
  const CommandOutput all = run({});
  EXPECT_EQ(all.exit_code, 0);
  EXPECT_THAT(all.out, HasSubstr("rosenbrock/ga/r01\ncell --jobs"));
  EXPECT_THAT(all.err, HasSubstr("/bin/echo merge '/tmp/a '\\''b'\\'' $(touch x)?# \"c\"'"));
  const CommandOutput none = run({"3"});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_THAT(none.err, HasSubstr("there is no chunk '3'; the chunks are 1 to 2"));
  EXPECT_FALSE(std::filesystem::exists(temporary_ / "x"));
  EXPECT_FALSE(std::filesystem::exists(temporary_ / "y"));
}

TEST_F(CellNames, SlurmGetsFilesWithoutPatterns) {
  const std::vector<Chunk> chunks = {{list_cells(plan_), 60}};
  const auto words = make_sbatch_words(plan_, chunks, {study_, 3, {"--mem=1G"}}, "/a%20b/001");
  EXPECT_THAT(words, Contains("--output=/a%%20b/001/task-%a.log"));
  EXPECT_THAT(words, Contains("--array=1-1"));
  EXPECT_THAT(words, Contains("--time=14"));
  EXPECT_THAT(words, Contains("--cpus-per-task=3"));
  EXPECT_EQ(words[words.size() - 2], "--mem=1G");
  EXPECT_EQ(words.back(), "/a%20b/001/run.sh");
  EXPECT_EQ(choose_submission_folder(study_), study_ / "submissions/001");
}

TEST(CommandOutput, HasBothStreamsAndTheCode) {
  const CommandOutput output =
      run_command(std::vector<std::string>{"sh", "-c", "cat; echo out; echo err >&2; exit 7"});
  EXPECT_EQ(output.exit_code, 7);
  EXPECT_EQ(output.out, "out\n");
  EXPECT_EQ(output.err, "err\n");
  EXPECT_EQ(run_command(std::vector<std::string>{"sh", "-c", "kill -9 $$"}).exit_code, 137);
  EXPECT_EQ(run_command(std::vector<std::string>{"sh", "-c", "yes | head -c 3000000"}).out.size(),
            std::size_t{1} << 20);
  EXPECT_THAT(usage_error_of([] { run_command(std::vector<std::string>{"no-such-program-1"}); }),
              HasSubstr("there is no program 'no-such-program-1' on this machine's PATH"));
}

}  // namespace
}  // namespace armwright
