// What a call says when it refuses: the message of its Error, with the kind checked.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "base/error.hpp"

namespace armwright {

template <typename Call>
std::string error_of(ErrorKind kind, Call call) {
  try {
    call();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), kind) << error.what();
    return error.what();
  }
  ADD_FAILURE() << "no Error was thrown";
  return "";
}

template <typename Call>
std::string usage_error_of(Call call) {
  return error_of(ErrorKind::usage, call);
}

}  // namespace armwright
