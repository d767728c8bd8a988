#include <gtest/gtest.h>

#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "fuzz/bodies/requests.hpp"
#include "page_columns.hpp"
#include "pingvox/web/page.hpp"
#include "pingvox/web/scene_bytes.hpp"

namespace pingvox::web {
namespace {

const Page kWholePage{
    "<!doctype html>\n<html><head><title>t</title>\n<link rel=\"stylesheet\" href=\"page.css\">\n</head>\n<body>"
    "<p>x</p>\n<script src=\"page.js\"></script>\n</body></html>\n",
    "const end = \"</script>\"; const note = \"<!--\"; a(1 < 2);", "p { color: red }"};

std::string page_of(Scene scene, const ExportOptions& options = {}) {
  std::ostringstream out;
  const Result<void> written = write_page(std::move(scene), kWholePage, out, options);
  EXPECT_TRUE(written) << (written ? "" : written.error().message);
  return out.str();
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

/// A log of noise, which is as hard to pack as any.
SceneLog noisy_log(std::size_t beams, std::size_t bins) {
  SceneLog log;
  log.name = "noise.csv";
  log.beams.assign(beams, {.bin_length_m = 0.1});
  log.bins = bins;
  std::mt19937 random(1);
  for (std::size_t i = 0; i < beams * bins; ++i) log.intensities.push_back(static_cast<std::uint8_t>(random()));
  return log;
}

TEST(WritePage, putsTheAnswersOfAServerIntoThePage) {
  const Scene scene = fuzz::small_scene();
  const std::string html = page_of(fuzz::small_scene());
  EXPECT_EQ(test::answer_in_page(html, "map/0/cells"), *cells_bytes(scene.maps[0].map));
  EXPECT_EQ(test::answer_in_page(html, "map/0/free"), *free_bytes(scene.maps[0].map));
  EXPECT_EQ(test::answer_in_page(html, "path/0"), path_bytes(scene.paths[0], scene.origin_m()));
  EXPECT_EQ(test::answer_in_page(html, "points/0"), points_bytes(scene.points[0], scene.origin_m()));
  EXPECT_EQ(test::answer_in_page(html, "log/0"), beams_bytes(scene.logs[0]));
  EXPECT_EQ(test::answer_in_page(html, "log/0/bins"), scene.logs[0].intensities);
  const std::vector<std::uint8_t> json = test::answer_in_page(html, "scene.json");
  EXPECT_EQ(std::string(json.begin(), json.end()), scene_json(scene));
}

TEST(WritePage, needsNoOtherFile) {
  const std::string html = page_of(fuzz::small_scene());
  EXPECT_EQ(html.find("src="), std::string::npos);
  EXPECT_EQ(html.find("<link rel=\"stylesheet\""), std::string::npos);
  EXPECT_NE(html.find("p { color: red }"), std::string::npos);
  EXPECT_LT(html.find("id=\"scene.json\""), html.find("const end")) << "data come before the script that reads them";
  EXPECT_NE(html.find("Content-Security-Policy"), std::string::npos);
}

TEST(WritePage, isNotEndedByATitleOrAScript) {
  Scene scene = fuzz::small_scene();
  scene.title = "</script><script>alert(1)</script>";
  scene.notes = {"<!-- </body>"};
  const std::string html = page_of(std::move(scene));
  EXPECT_EQ(html.find("alert"), std::string::npos) << "names are packed";
  EXPECT_EQ(count(html, "<script"), count(html, "</script>"));
  EXPECT_NE(html.find("\"<\\/script>\""), std::string::npos);
  EXPECT_EQ(html.find("<!--"), std::string::npos);
}

TEST(WritePage, reducesLogsUntilThePageIsSmallAndSaysSo) {
  Scene scene;
  scene.title = "noise";
  scene.logs.push_back(noisy_log(1000, 400));
  const std::string whole = page_of(scene, {.wanted_bytes = 10'000'000});
  EXPECT_EQ(test::answer_in_page(whole, "log/0/bins"), scene.logs[0].intensities);
  const std::vector<std::uint8_t> whole_json = test::answer_in_page(whole, "scene.json");
  EXPECT_NE(std::string(whole_json.begin(), whole_json.end()).find("\"notes\": []"), std::string::npos);

  const std::string small = page_of(scene, {.wanted_bytes = 200'000});
  EXPECT_LT(small.size(), 210'000U);
  const std::vector<std::uint8_t> bytes = test::answer_in_page(small, "scene.json");
  const std::string json(bytes.begin(), bytes.end());
  EXPECT_NE(json.find("rounded to multiples of 16 and 2 bins are joined"), std::string::npos) << json;
  EXPECT_NE(json.find("\"bins\": 200"), std::string::npos) << json;
  EXPECT_EQ(test::answer_in_page(small, "log/0/bins").size(), 1000U * 200U);
}

TEST(WritePage, failsWhereItCannotBeWhole) {
  std::ostringstream out;
  EXPECT_EQ(write_page({}, kWholePage, out, {.wanted_bytes = 0}).error().code, Error::Code::kBadOption);
  EXPECT_EQ(write_page({}, {"<html></html>", "", ""}, out).error().code, Error::Code::kCorrupt);
  out.setstate(std::ios::badbit);
  EXPECT_EQ(write_page({}, kWholePage, out).error().code, Error::Code::kIo);
  Scene vast;
  MapOptions options;
  OccupancyMap map(options);
  map.edit().set(Key{}, 4, LogOdds::from_probability(0.9));
  vast.maps.push_back({"vast.bt", "bt", std::move(map)});
  std::ostringstream other;
  EXPECT_EQ(write_page(std::move(vast), kWholePage, other).error().code, Error::Code::kLimit);
}

TEST(WritePage, hasThePageOfThisBuild) {
  const std::optional<Page> page = built_in_page();
  if (!page) GTEST_SKIP() << "built without the page";
  std::ostringstream out;
  const Result<void> written = write_page(fuzz::small_scene(), *page, out);
  ASSERT_TRUE(written) << written.error().message;
  const std::string html = out.str();
  EXPECT_EQ(count(html, "<script"), count(html, "</script>"));
  EXPECT_EQ(html.find("page.js"), std::string::npos);
  EXPECT_FALSE(test::answer_in_page(html, "map/0/cells").empty());
}

}  // namespace
}  // namespace pingvox::web
