#include "base/base64.hpp"

#include <gtest/gtest.h>

#include <string_view>
#include <vector>

namespace armwright {
namespace {

std::string encode(std::string_view text) {
  return to_base64(std::vector<std::uint8_t>(text.begin(), text.end()));
}

TEST(Base64, EncodesTheStandardsVectors) {  // RFC 4648, section 10
  EXPECT_EQ(encode(""), "");
  EXPECT_EQ(encode("f"), "Zg==");
  EXPECT_EQ(encode("fo"), "Zm8=");
  EXPECT_EQ(encode("foo"), "Zm9v");
  EXPECT_EQ(encode("foob"), "Zm9vYg==");
  EXPECT_EQ(encode("fooba"), "Zm9vYmE=");
  EXPECT_EQ(encode("foobar"), "Zm9vYmFy");
}

TEST(Base64, EncodesEveryByte) {
  EXPECT_EQ(to_base64(std::vector<std::uint8_t>{0xff, 0xfe, 0xfd, 0x00}), "//79AA==");
}

}  // namespace
}  // namespace armwright
