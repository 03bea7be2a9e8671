// The stop of a thread's work: which reasons end work in progress.
#include "process/stop_scope.hpp"

#include <gtest/gtest.h>

namespace armwright {
namespace {

TEST(StopScope, ATimeLimitLetsWorkInProgressEndAndASignalAfterItDoesNot) {
  for (const StopReason reason : {StopReason::interrupted, StopReason::terminated}) {
    StopSignal stop;
    const StopScope scope(&stop);
    check_work_stop();
    stop.set_deadline(StopSignal::Clock::now());
    EXPECT_NO_THROW(check_work_stop());
    EXPECT_NO_THROW(await_work_stop());
    EXPECT_EQ(stop.reason(), StopReason::time_limit);
    stop.request(reason);
    EXPECT_THROW(check_work_stop(), WorkStopped);
    EXPECT_EQ(stop.reason(), reason);
  }
}

TEST(StopScope, TheFirstSignalKeepsItsReason) {
  StopSignal stop;
  stop.request(StopReason::terminated);
  stop.request(StopReason::interrupted);
  stop.request(StopReason::time_limit);
  EXPECT_EQ(stop.reason(), StopReason::terminated);
}

TEST(StopScope, AwaitsAStopThatComesAMomentLater) {
  StopSignal stop;
  int looks = 0;
  stop.set_lookout([&] {
    if (++looks == 3) {
      stop.request(StopReason::terminated);
    }
  });
  EXPECT_NO_THROW(await_work_stop()) << "no stop ends work outside of scopes";
  const StopScope scope(&stop);
  EXPECT_THROW(await_work_stop(), WorkStopped);
}

}  // namespace
}  // namespace armwright
