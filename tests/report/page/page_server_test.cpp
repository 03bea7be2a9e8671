#include "report/page/page_server.hpp"

#include <gtest/gtest.h>

#include "base/error.hpp"

namespace armwright {
namespace {

TEST(PageServer, APortIsNotShared) {
  const PageServer first(0, "first", [] { return std::string("{}"); });
  EXPECT_GT(first.port(), 0);
  try {
    PageServer(first.port(), "second", [] { return std::string("{}"); });
    FAIL() << "the port is served twice";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::io);
    EXPECT_NE(std::string(error.what()).find(std::to_string(first.port())), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("--port"), std::string::npos);
  }
}

TEST(PageServer, EndsWhenAskedTo) {
  StopSignal stop;
  stop.request(StopReason::terminated);
  PageServer server(0, "t", [] { return std::string("{}"); });
  server.serve(stop);  // returns
}

}  // namespace
}  // namespace armwright
