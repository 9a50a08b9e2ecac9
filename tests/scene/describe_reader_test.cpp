#include "imbibe/scene/describe_reader.h"

#include "imbibe/core/quantity.h"
#include "scene/scene_test_support.h"

namespace imbibe {
namespace {

struct Inner {
  std::string kind = "water";
  Real amount = 1;
};
template <class V>
void describe(V& v, Inner& p) {
  if constexpr (requires { v.short_form(""); }) v.short_form("kind");
  v.value("kind", p.kind);
  v.value("amount", p.amount, {.unit = "kg"});
}

struct Sample {
  Real length = 0.5;
  std::optional<Real> angle;
  int count = 3;
  std::uint64_t big = 0;
  bool flag = false;
  std::string word = "none";
  Vec3 place{};
  std::array<Real, 2> pair{};
  std::vector<std::string> words;
  std::vector<Real> numbers;
  std::optional<Vec3> maybe;
  Inner inner;
  std::string file;
  Real odd_unit = 0;
};
template <class V>
void describe(V& v, Sample& p) {
  v.value("length", p.length, {.unit = "m", .shown = "mm", .min = 0, .max = 1});
  v.value("angle", p.angle, {.unit = "rad", .shown = "deg"});
  v.value("count", p.count, {.min = 1, .max = 10});
  v.value("big", p.big);
  v.value("flag", p.flag);
  v.value("word", p.word);
  v.value("place", p.place, {.unit = "m"});
  v.value("pair", p.pair, {.unit = "m"});
  v.value("words", p.words);
  v.value("numbers", p.numbers);
  v.value("maybe", p.maybe, {.unit = "m"});
  v.group("inner", p.inner);
  v.value("file", p.file, {.unit = "file"});
  v.value("odd_unit", p.odd_unit, {.unit = "kg/(m2 s^0.5)"});
}

Sample read(const std::string& text, ReadLog& log, const std::string& file = "folder/s.yaml") {
  Sample sample;
  const DataNode root = parse_document(text, file, log.problems);
  read_described(root, "", sample, log);
  return sample;
}

TEST(DescribeReader, EveryTypeIsReadInItsUnit) {
  ReadLog log;
  const Sample s = read(
      "length: 25 mm\nangle: 90 deg\ncount: 7\nbig: 18446744073709551615\nflag: yes\nword: 12\n"
      "place: [1 mm, 2 cm, 3]\npair: [1, 2 mm]\nwords: [a, 10]\nnumbers: 4\nmaybe: [1, 2, 3]\nodd_unit: 2.2 kg/(m2 s^0.5)\n",
      log);
  ASSERT_TRUE(log.problems.empty()) << log.problems[0].text();
  EXPECT_DOUBLE_EQ(s.length, 0.025);
  EXPECT_DOUBLE_EQ(*s.angle, pi / 2);
  EXPECT_EQ(s.count, 7);
  EXPECT_EQ(s.big, std::numeric_limits<std::uint64_t>::max());
  EXPECT_TRUE(s.flag);
  EXPECT_EQ(s.word, "12");
  EXPECT_EQ(s.place, Vec3(1e-3, 2e-2, 3));
  EXPECT_EQ(s.pair[1], 2e-3);
  EXPECT_EQ(s.words, (std::vector<std::string>{"a", "10"}));
  EXPECT_EQ(s.numbers, std::vector<Real>{4});
  EXPECT_EQ(*s.maybe, Vec3(1, 2, 3));
  EXPECT_EQ(s.odd_unit, 2.2);
}

TEST(DescribeReader, WhatIsNotGivenKeepsItsDefault) {
  ReadLog log;
  const Sample s = read("count: 2\n", log);
  EXPECT_TRUE(log.problems.empty());
  EXPECT_EQ(s.length, 0.5);
  EXPECT_FALSE(s.angle.has_value());
  EXPECT_EQ(s.word, "none");
}

TEST(DescribeReader, ARejectedValueLeavesTheFieldAlone) {
  ReadLog log;
  const Sample s = read("length: 2 m\ncount: 11\nangle: 3 mm\n", log);
  EXPECT_EQ(log.problems.size(), 3u);
  EXPECT_EQ(s.length, 0.5);
  EXPECT_EQ(s.count, 3);
  EXPECT_FALSE(s.angle.has_value());
}

TEST(DescribeReader, AnEmptyTextIsRefusedWhereTheDefaultIsNone) {
  ReadLog log;
  EXPECT_EQ(read("word: \"\"\nfile: \"\"\n", log).word, "none");
  ASSERT_EQ(log.problems.size(), 1u);
  EXPECT_NE(log.problems[0].message.find("'none' where the key is left out"), std::string::npos) << log.problems[0].message;
}

TEST(DescribeReader, AScalarStandsForAMapWithAShortForm) {
  ReadLog log;
  EXPECT_EQ(read("inner: oil\n", log).inner.kind, "oil");
  EXPECT_EQ(read("inner: {kind: oil, amount: 2 kg}\n", log).inner.amount, 2);
  EXPECT_TRUE(log.problems.empty());
}

TEST(DescribeReader, SettingAKeyBesideAShortFormKeepsIt) {
  ReadLog log;
  DataNode root = parse_document("inner: oil\n", "s.yaml", log.problems);
  apply_override(root, "inner.amount=3 kg", log.problems);
  Sample sample;
  read_described(root, "", sample, log);
  EXPECT_TRUE(log.problems.empty());
  EXPECT_EQ(sample.inner.kind, "oil");
  EXPECT_EQ(sample.inner.amount, 3);
}

TEST(DescribeReader, AFileNameIsRelativeToTheFileThatNamesIt) {
  ReadLog log;
  EXPECT_EQ(read("file: mesh.obj\n", log, "/scenes/s.yaml").file, "/scenes/mesh.obj");
  EXPECT_EQ(read("file: /abs/mesh.obj\n", log, "/scenes/s.yaml").file, "/abs/mesh.obj");
}

TEST(DescribeReader, PlacesOfAllGivenKeysAreKept) {
  ReadLog log;
  read("count: 2\ninner:\n  amount: 1 kg\n", log);
  EXPECT_EQ(log.places.at("inner.amount").line, 3);
  EXPECT_EQ(place_of(log.places, "inner.kind").line, 3) << "the map stands where its first key stands";
  EXPECT_EQ(place_of(log.places, "nothing.at.all").line, 1);
}

TEST(DescribeReader, RangesOpenBelowExcludeTheirEnd) {
  ReadLog log;
  read("length: 0 m\n", log);
  EXPECT_TRUE(log.problems.empty());
  const Scene scene = read_scene_text(test::small_scene, "t");
  EXPECT_THROW(read_scene_text(test::with_line(3, "duration: 0 s"), "t"), InputError);
  EXPECT_GT(scene.duration, 0);
}

}  // namespace
}  // namespace imbibe
