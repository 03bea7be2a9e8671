// Tests the place of a rank in the environments that batch systems and mpirun set.
#include <gtest/gtest.h>

#include <cstdlib>
#include <map>
#include <string>

#include "study/executor/mpi_transport.hpp"

namespace armwright {
namespace {

// Sets exactly these variables of their kind as long as it lives.
class RankVariables {
 public:
  explicit RankVariables(const std::map<std::string, std::string>& variables) {
    for (const char* name : kNames) {
      ::unsetenv(name);
    }
    for (const auto& [name, value] : variables) {
      ::setenv(name.c_str(), value.c_str(), 1);
    }
  }
  ~RankVariables() {
    for (const char* name : kNames) {
      ::unsetenv(name);
    }
  }
  RankVariables(const RankVariables&) = delete;
  RankVariables& operator=(const RankVariables&) = delete;

 private:
  static constexpr const char* kNames[] = {
      "OMPI_COMM_WORLD_SIZE",         "OMPI_COMM_WORLD_RANK",
      "OMPI_COMM_WORLD_LOCAL_SIZE",   "PMIX_RANK",
      "SLURM_STEP_NUM_TASKS",         "SLURM_STEP_TASKS_PER_NODE",
      "OMPI_MCA_orte_enable_recovery"};
};

TEST(RankPlace, IsNoneForAProcessOfItsOwn) {
  for (const std::map<std::string, std::string>& variables :
       {std::map<std::string, std::string>{},
        {{"OMPI_COMM_WORLD_SIZE", "1"}, {"OMPI_COMM_WORLD_RANK", "0"}},
        {{"OMPI_COMM_WORLD_SIZE", "four"}, {"OMPI_COMM_WORLD_RANK", "0"}},
        {{"OMPI_COMM_WORLD_SIZE", "2"}, {"OMPI_COMM_WORLD_RANK", "2"}},
        {{"SLURM_STEP_NUM_TASKS", "4"}},  // srun without PMIx: the processes cannot talk
        {{"PMIX_RANK", "1"}}}) {
    const RankVariables set(variables);
    EXPECT_FALSE(find_rank_place());
  }
}

TEST(RankPlace, IsWhatMpirunSays) {
  const RankVariables set({{"OMPI_COMM_WORLD_SIZE", "12"},
                           {"OMPI_COMM_WORLD_RANK", "7"},
                           {"OMPI_COMM_WORLD_LOCAL_SIZE", "3"},
                           {"OMPI_MCA_orte_enable_recovery", "1"},
                           {"PMIX_RANK", "7"}});
  const auto place = find_rank_place();
  ASSERT_TRUE(place);
  EXPECT_EQ(place->rank, 7u);
  EXPECT_EQ(place->size, 12u);
  EXPECT_EQ(place->on_this_machine, 3u);
  EXPECT_TRUE(place->survives);
}

TEST(RankPlace, IsWhatSrunSays) {
  const RankVariables set({{"PMIX_RANK", "1"},
                           {"SLURM_STEP_NUM_TASKS", "5"},
                           {"SLURM_STEP_TASKS_PER_NODE", "2(x2),1"}});
  const auto place = find_rank_place();
  ASSERT_TRUE(place);
  EXPECT_EQ(place->rank, 1u);
  EXPECT_EQ(place->size, 5u);
  EXPECT_EQ(place->on_this_machine, 2u);
  EXPECT_FALSE(place->survives);
}

TEST(RankPlace, CoresAreDividedAmongTheRanksOfAMachine) {
  EXPECT_GE(count_rank_cores({.on_this_machine = 1}), 1u);
  EXPECT_LE(count_rank_cores({.on_this_machine = 2}), count_rank_cores({.on_this_machine = 1}));
  EXPECT_EQ(count_rank_cores({.on_this_machine = 1'000'000}), 1u);
}

}  // namespace
}  // namespace armwright
