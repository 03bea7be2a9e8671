// Measures how many evaluations per second the journal can store: records of 20 variables, flushed
// after every batch of 100, as for a population. The requirement is 500 000 records/s, so that the
// journal needs less than a tenth of the engine's time.
#include <benchmark/benchmark.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include "study/journal/journal.hpp"

namespace {

void append_in_batches(benchmark::State& state) {
  const auto folder = std::filesystem::temp_directory_path() /
                      ("armwright-journal-benchmark-" + std::to_string(::getpid()));
  std::filesystem::create_directory(folder);
  armwright::EvaluationRecord record;
  record.x.assign(20, 0.125);
  record.cases = {armwright::CaseRole::training, "train/1", {0}};
  record.evaluation.objectives = {1e-3};
  record.evaluation.case_errors = {1e-3};
  {
    armwright::JournalContent content;
    armwright::Journal journal(folder / "journal", content);
    for (auto _ : state) {
      for (int i = 0; i < 100; ++i) {
        journal.append(record);
        ++record.index;
      }
      journal.flush();
    }
    journal.close();
  }
  state.SetItemsProcessed(state.iterations() * 100);
  state.SetBytesProcessed(
      static_cast<std::int64_t>(std::filesystem::file_size(folder / "journal")));
  std::filesystem::remove_all(folder);
}
BENCHMARK(append_in_batches)->UseRealTime();

}  // namespace

BENCHMARK_MAIN();
