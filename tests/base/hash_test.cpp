// Expected values: SHA-256 from FIPS 180-4's examples (NIST), CRC-32 check value of the CRC
// catalogue (Greg Cook).
#include "base/hash.hpp"

#include <gtest/gtest.h>

namespace armwright {
namespace {

TEST(Hash, GivesThePublishedSha256Values) {
  EXPECT_EQ(calc_sha256_hex(""),
            "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(calc_sha256_hex("abc"),
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(calc_sha256_hex("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  EXPECT_EQ(calc_sha256_hex(std::string(1000000, 'a')),
            "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

TEST(Hash, HexAndBytesAgree) {
  const auto digest = calc_sha256("abc");
  EXPECT_EQ(digest.front(), 0xba);
  EXPECT_EQ(digest.back(), 0xad);
}

TEST(Hash, GivesThePublishedCrc32Values) {
  EXPECT_EQ(calc_crc32(""), 0U);
  EXPECT_EQ(calc_crc32("123456789"), 0xCBF43926U);
  EXPECT_EQ(calc_crc32("The quick brown fox jumps over the lazy dog"), 0x414FA339U);
  EXPECT_NE(calc_crc32(std::string_view("a\0", 2)), calc_crc32("a"));
}

}  // namespace
}  // namespace armwright
