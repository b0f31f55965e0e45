#include <gtest/gtest.h>

#include "sutura/text.h"

namespace sutura {
namespace {

TEST(Text, LongOnesAreCut) {
  EXPECT_EQ(shortened("abc", 3), "abc");
  EXPECT_EQ(shortened("abcd", 3), "abc...");
  EXPECT_EQ(shortened("", 3), "");
  EXPECT_EQ(in_quotes(std::string(60, 'x')), "'" + std::string(60, 'x') + "'");
  EXPECT_EQ(in_quotes(std::string(61, 'x')), "'" + std::string(60, 'x') + "...'");
}

TEST(Text, ReservedCharactersOfXml) {
  EXPECT_EQ(xml_escaped("a<b & \"c\">'d'"), "a&lt;b &amp; &quot;c&quot;&gt;'d'");
  EXPECT_EQ(xml_escaped("velocity [m/s]"), "velocity [m/s]");
}

}  // namespace
}  // namespace sutura
