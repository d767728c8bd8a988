#include "io/bytes/json_events.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace pingvox {
namespace {

using testing::ElementsAre;
using Kind = JsonEvent::Kind;

/// "{", "a:[", "1" and so on; "!" at the end of a text that is no JSON.
std::vector<std::string> events_of(std::string_view text) {
  JsonEvents events(text);
  std::vector<std::string> found;
  while (const auto event = events.next()) {
    std::string one = event->key.empty() ? "" : std::string(event->key) + ":";
    switch (event->kind) {
      case Kind::kObject:
        one += "{";
        break;
      case Kind::kArray:
        one += "[";
        break;
      case Kind::kEnd:
        one += "end";
        break;
      case Kind::kText:
        one += "'" + std::string(event->text) + "'";
        break;
      case Kind::kNumber:
        one += event->text;
        break;
      case Kind::kTrue:
        one += "true";
        break;
      case Kind::kFalse:
        one += "false";
        break;
      case Kind::kNull:
        one += "null";
        break;
    }
    found.push_back(one);
  }
  if (!events.is_whole()) found.emplace_back("!");
  return found;
}

TEST(JsonEvents, ComeInTheOrderOfTheText) {
  EXPECT_THAT(events_of(R"( {"a" : [1, -2.5e-7,[]] ,"b":{"c":"x \" y","d":null},"e":true, "f":false}
)"),
              ElementsAre("{", "a:[", "1", "-2.5e-7", "[", "end", "end", "b:{", R"(c:'x \" y')", "d:null", "end",
                          "e:true", "f:false", "end"));
  EXPECT_THAT(events_of("[]"), ElementsAre("[", "end"));
  EXPECT_THAT(events_of(" 5 "), ElementsAre("5"));
}

TEST(JsonEvents, NumbersThatAreNotFiniteAreThoseOfJson5) {
  EXPECT_THAT(events_of("[NaN,Infinity,-Infinity,-0,1e400]"),
              ElementsAre("[", "NaN", "Infinity", "-Infinity", "-0", "1e400", "end"));
}

TEST(JsonEvents, WhatIsNoJsonEndsThem) {
  for (const char* text :
       {"", "{", "{\"a\":1", "{\"a\" 1}", "{\"a\":1 \"b\":2}", "{a:1}", "[1 2]", "[1,2}", "{\"a\":1}}", "[nan]", "[+1]",
        "[.5]", "[0x10]", "[tru]", "{\"a\":\"x}", "[1]x", "[,1]", "{,}"}) {
    EXPECT_EQ(events_of(text).back(), "!") << text;
  }
  EXPECT_EQ(events_of(std::string(100'000, '[')).back(), "!") << "as deep as that";
}

TEST(JsonEvents, EscapesAreReplaced) {
  EXPECT_EQ(unescaped(R"(a\"b\\c\/d\ne\u0041\u00e9\u20ac)"),
            "a\"b\\c/d\ne"
            "A\xC3\xA9\xE2\x82\xAC");
  EXPECT_EQ(unescaped(R"(\ud83d\)"), "\xEF\xBF\xBD\\");
  EXPECT_EQ(unescaped(R"(\u12)"),
            "\xEF\xBF\xBD"
            "12");
}

}  // namespace
}  // namespace pingvox
