// JSON written and read again.
#include "host/files/json.h"

#include "host/files/text_file.h"
#include "tests/unit/test_scene.h"

namespace rayfarm {
namespace {

TEST(Json, MembersStandInTheOrderOfTheirNames) {
  Json j;
  EXPECT_EQ(j.dump(), "null");
  j["b"] = 2;
  j["a"]["inner"] = std::vector<double>{0.5, 1};
  j["c"].push_back("text");
  j["c"].push_back(true);
  j["d"] = Json::Object{{"least", int64_t{-1} << 62}, {"most", ~uint64_t{0}}};
  EXPECT_EQ(j.dump(), R"({"a":{"inner":[0.5,1.0]},"b":2,"c":["text",true],)"
                      R"("d":{"least":-4611686018427387904,"most":18446744073709551615}})");
  EXPECT_THROW(Json("\xff").dump(), JsonError);
}

TEST(Json, ThereAndBack) {
  Json j;
  j["number"] = 0.1;
  j["numbers"] = std::vector<int>{3, 4};
  j["text"] = "ü";
  const std::string path = test::write_temporary("there.json", "");
  write_text_file(path, j.dump(1));
  const JsonView back = JsonView::read_file(path);
  EXPECT_EQ(back.size(), 3u);
  EXPECT_EQ(back.at("number").number(), 0.1);
  EXPECT_EQ(back.at("numbers").numbers(), (std::vector<double>{3, 4}));
  EXPECT_EQ(back.at("numbers").elements()[1].integer(), 4);
  EXPECT_EQ(back.at("text").text(), "ü");
  EXPECT_THROW(back.at("nothing"), JsonError);
  EXPECT_THROW(back.at("text").number(), JsonError);
  EXPECT_THROW(JsonView::read_file(test::write_temporary("none.json", "{")), JsonError);
  EXPECT_THROW(JsonView::read_file("/nonexistent.json"), IoError);
}

}  // namespace
}  // namespace rayfarm
