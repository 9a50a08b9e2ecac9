#include "imbibe/scene/document.h"

#include "scene/scene_test_support.h"

namespace imbibe {
namespace {

using test::TemporaryFolder;

DataNode parsed(const std::string& text, std::vector<Problem>& problems) {
  return parse_document(text, "t.yaml", problems);
}

TEST(Document, EveryNodeKnowsItsPlace) {
  std::vector<Problem> problems;
  const DataNode root = parsed("a: 1\nb:\n  - x\n  - {c: y}\n", problems);
  ASSERT_TRUE(problems.empty());
  const DataNode& c = root.find("b")->items[1].items[0];
  EXPECT_EQ(c.text, "y");
  EXPECT_EQ(c.place.line, 4);
  EXPECT_EQ(c.place.column, 9);
  EXPECT_EQ(*c.place.file, "t.yaml");
}

TEST(Document, JsonIsReadToo) {
  std::vector<Problem> problems;
  const DataNode root = parsed("{\"a\": [1, 2.5], \"b\": {\"c\": \"20 tex\"}}", problems);
  ASSERT_TRUE(problems.empty());
  EXPECT_EQ(root.find("a")->items[1].text, "2.5");
  EXPECT_EQ(root.find("b")->find("c")->text, "20 tex");
}

TEST(Document, ADuplicateKeyIsReportedAtTheSecondOneWithItsPath) {
  std::vector<Problem> problems;
  parsed("list:\n  - {a: 1}\n  - b: {c: 1, d: 2, c: 3}\n", problems);
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_EQ(problems[0].line, 3);
  EXPECT_EQ(problems[0].column, 21);
  EXPECT_EQ(problems[0].key, "list[1].b.c");
}

TEST(Document, NestingDeeperThanTheLimitIsRefusedNotFollowed) {
  std::vector<Problem> problems;
  parsed(std::string(200, '[') + std::string(200, ']'), problems);
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_NE(problems[0].message.find("deeper than 32"), std::string::npos) << problems[0].message;
}

TEST(Document, AliasesThatMultiplyAreCountedAndRefused) {
  std::string text = "a: &a [x, x, x, x, x, x, x, x, x, x]\n";
  std::string last = "a";
  for (const char* name : {"b", "c", "d", "e", "f", "g"}) {
    text += std::string(name) + ": &" + name + " [";
    for (int i = 0; i < 10; ++i) text += (i ? ", *" : "*") + last;
    text += "]\n";
    last = name;
  }
  std::vector<Problem> problems;
  parsed(text, problems);
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_NE(problems[0].message.find("more than 200000"), std::string::npos) << problems[0].message;
}

TEST(Document, AFileLargerThanTheLimitIsRefused) {
  TemporaryFolder folder;
  const auto file = folder.write("big.yaml", "a: " + std::string(2000, 'x'));
  std::vector<Problem> problems;
  read_document(file, problems, {.bytes = 1000});
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_NE(problems[0].message.find("larger than"), std::string::npos);
}

TEST(Document, ABaseIsMergedKeyByKeyAndErrorsKeepTheirOwnFile) {
  TemporaryFolder folder;
  folder.write("base.yaml", "a: {x: 1, y: 2}\nlist: [1, 2]\n");
  const auto file = folder.write("sub/own.yaml", "extends: ../base.yaml\na:\n  y: 3\n");
  std::vector<Problem> problems;
  const DataNode root = read_document(file, problems);
  ASSERT_TRUE(problems.empty());
  EXPECT_EQ(root.find("a")->find("x")->text, "1");
  EXPECT_EQ(root.find("a")->find("y")->text, "3");
  EXPECT_EQ(root.find("list")->items.size(), 2u);
  EXPECT_EQ(std::filesystem::path(*root.find("a")->find("x")->place.file).filename(), "base.yaml");
  EXPECT_EQ(std::filesystem::path(*root.find("a")->find("y")->place.file).filename(), "own.yaml");
}

TEST(Document, AnInnerMapMayHaveABaseOfItsOwn) {
  TemporaryFolder folder;
  folder.write("cloth.yaml", "weave: plain\nwarp: {density: 10}\n");
  const auto file = folder.write("own.yaml", "textiles:\n  - extends: cloth.yaml\n    warp: {fibre: wool}\n");
  std::vector<Problem> problems;
  const DataNode root = read_document(file, problems);
  ASSERT_TRUE(problems.empty());
  const DataNode& cloth = root.find("textiles")->items[0];
  EXPECT_EQ(cloth.find("weave")->text, "plain");
  EXPECT_EQ(cloth.find("warp")->find("density")->text, "10");
  EXPECT_EQ(cloth.find("warp")->find("fibre")->text, "wool");
  EXPECT_EQ(cloth.find("extends"), nullptr);
}

TEST(Document, ChangeSetsKeysInsideListsOfTheBase) {
  TemporaryFolder folder;
  folder.write("base.yaml", "list:\n  - {a: 1}\n  - {a: 2, b: 3}\n");
  const auto file = folder.write("own.yaml", "extends: base.yaml\nchange:\n  list[1].a: 9\n");
  std::vector<Problem> problems;
  const DataNode root = read_document(file, problems);
  ASSERT_TRUE(problems.empty());
  EXPECT_EQ(root.find("list")->items[0].find("a")->text, "1");
  EXPECT_EQ(root.find("list")->items[1].find("a")->text, "9");
  EXPECT_EQ(root.find("list")->items[1].find("b")->text, "3");
  EXPECT_EQ(root.find("list")->items[1].find("a")->place.line, 3);
}

TEST(Document, FilesThatBuildOnEachOtherInACircleAreRefused) {
  TemporaryFolder folder;
  folder.write("a.yaml", "extends: b.yaml\n");
  folder.write("b.yaml", "extends: a.yaml\n");
  std::vector<Problem> problems;
  read_document(folder.path() / "a.yaml", problems);
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_NE(problems[0].message.find("circle"), std::string::npos);
}

TEST(Document, AMissingBaseIsReportedWhereItIsNamed) {
  TemporaryFolder folder;
  const auto file = folder.write("own.yaml", "version: 1\nextends: nowhere.yaml\n");
  std::vector<Problem> problems;
  read_document(file, problems);
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_EQ(problems[0].line, 2);
  EXPECT_EQ(problems[0].column, 10);
  EXPECT_NE(problems[0].message.find("there is no file"), std::string::npos);
}

TEST(Document, AnOverrideReachesIntoListsAndMakesMapsOnTheWay) {
  std::vector<Problem> problems;
  DataNode root = parsed("list: [{a: 1}]\n", problems);
  apply_override(root, "list[0].a=[1, 2]", problems);
  apply_override(root, "new.deep.key=20 tex", problems);
  ASSERT_TRUE(problems.empty());
  EXPECT_EQ(root.find("list")->items[0].find("a")->items[1].text, "2");
  EXPECT_EQ(root.find("new")->find("deep")->find("key")->text, "20 tex");
}

TEST(Document, AWrongOverrideIsAProblemNotASilentNewKey) {
  for (const char* wrong : {"no_equals", "=5", "list[3].a=1", "list.a=1", "list[x]=1", "a..b=1", "a.=1", "a=[1"}) {
    std::vector<Problem> problems;
    DataNode root = parsed("list: [{a: 1}]\n", problems);
    apply_override(root, wrong, problems);
    EXPECT_EQ(problems.size(), 1u) << wrong;
  }
}

}  // namespace
}  // namespace imbibe
