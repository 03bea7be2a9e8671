#include "base/batch_size.hpp"

#include <gtest/gtest.h>

namespace armwright {
namespace {

constexpr BatchSize kLanes{.granularity = 8, .largest = 64};

TEST(CalcChunk, OneAtATimeWithoutBatches) {
  for (const std::size_t threads : {1U, 2U, 64U}) {
    for (const std::size_t jobs : {0U, 1U, 1000U}) {
      EXPECT_EQ(calc_chunk({}, jobs, threads), 1U) << jobs << " on " << threads;
    }
  }
}

TEST(CalcChunk, TheLargestUsefulWhereThereAreManyOrNobodyToShareWith) {
  EXPECT_EQ(calc_chunk(kLanes, 35, 1), 64U);
  EXPECT_EQ(calc_chunk(kLanes, 17500, 2), 64U);
  EXPECT_EQ(calc_chunk(kLanes, 2 * 8 * 64, 2), 64U);
}

TEST(CalcChunk, WholeLanesAndSeveralChunksForEveryThreadWhereThereAreFew) {
  EXPECT_EQ(calc_chunk(kLanes, 35, 2), 8U);    // 35 / 16 is 3: not less than one load of the lanes
  EXPECT_EQ(calc_chunk(kLanes, 128, 2), 8U);   // exactly 8 for each
  EXPECT_EQ(calc_chunk(kLanes, 129, 2), 16U);  // a ninth would be one too many
  EXPECT_EQ(calc_chunk(kLanes, 500, 4), 16U);
  EXPECT_EQ(calc_chunk(kLanes, 0, 4), 8U);
}

}  // namespace
}  // namespace armwright
