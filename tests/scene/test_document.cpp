#include <catch2/catch.hpp>

#include "coupler/scene/document.hpp"

using namespace gabion::scene;

namespace {

Json changed(const std::string& start, const std::string& override_text) {
  Json document = Json::parse(start);
  std::vector<SceneProblem> problems;
  apply_override(document, override_text, problems);
  REQUIRE(problems.empty());
  return document;
}

std::vector<SceneProblem> problems_of(const std::string& start, const std::string& override_text) {
  Json document = Json::parse(start);
  std::vector<SceneProblem> problems;
  apply_override(document, override_text, problems);
  return problems;
}

}  // namespace

TEST_CASE("comments are allowed") {
  std::vector<SceneProblem> problems;
  const Json document = parse_document("// one\n{\"a\": /* two */ 1} // three", problems);
  CHECK(problems.empty());
  CHECK(document["a"] == 1);
}

TEST_CASE("syntax errors say where") {
  std::vector<SceneProblem> problems;
  parse_document("{\n  \"a\": 1\n  \"b\": 2\n}", problems);
  REQUIRE(problems.size() == 1);
  CHECK(problems[0].text().find("line 3") != std::string::npos);
  CHECK(problems[0].advice.find("missing comma") != std::string::npos);
}

TEST_CASE("a key given twice is not swallowed") {
  std::vector<SceneProblem> problems;
  parse_document("{\"a\": {\"b\": 1, \"c\": {\"b\": 1}, \"b\": 2}}", problems);
  REQUIRE(problems.size() == 1);
  CHECK(problems[0].path == "b");
  CHECK(problems[0].value == "the key is given twice");
}

TEST_CASE("numbers and bytes that JSON cannot hold are problems, not crashes") {
  std::vector<SceneProblem> problems;
  parse_document("{\"a\": 1e999}", problems);
  parse_document("{\"a\": \"\xff\"}", problems);
  CHECK(problems.size() == 2);
  problems = problems_of("{}", "a=\xff");
  REQUIRE(problems.size() == 1);
  CHECK(problems[0].expected == "UTF-8");
}

TEST_CASE("a scene is an object") {
  std::vector<SceneProblem> problems;
  parse_document("[1, 2]", problems);
  REQUIRE(problems.size() == 1);
  CHECK(problems[0].value == "[1,2]");
}

TEST_CASE("overrides replace, add and remove") {
  CHECK(changed(R"({"a": 1})", "a=2") == Json::parse(R"({"a": 2})"));
  CHECK(changed(R"({})", "a.b.c=10 t") == Json::parse(R"({"a": {"b": {"c": "10 t"}}})"));
  CHECK(changed(R"({"a": [1, {"b": 2}]})", "a[1].b=true") == Json::parse(R"({"a": [1, {"b": true}]})"));
  CHECK(changed(R"({"a": [1, {"b": 2}]})", "a.1.b=text") == Json::parse(R"({"a": [1, {"b": "text"}]})"));
  CHECK(changed(R"({"a": [1]})", "a[1]=2") == Json::parse(R"({"a": [1, 2]})"));
  CHECK(changed(R"({"a": [[1, 2], [3, 4]]})", "a[1][0]=5") == Json::parse(R"({"a": [[1, 2], [5, 4]]})"));
  CHECK(changed(R"({"a": 1})", R"(a={"b": [1, "2 m"]})") == Json::parse(R"({"a": {"b": [1, "2 m"]}})"));
  CHECK(changed(R"({"a": 1, "b": 2})", "a=null") == Json::parse(R"({"b": 2})"));
  CHECK(changed(R"({"a": 1})", "a=x=y") == Json::parse(R"({"a": "x=y"})"));
}

TEST_CASE("overrides that lead nowhere are told") {
  for (const char* text : {"a", "=1", "a..b=1", ".a=1", "a[=1", "a[x]=1", "a.=1"}) {
    INFO(text);
    const auto problems = problems_of(R"({"a": 1})", text);
    REQUIRE(problems.size() == 1);
    CHECK(problems[0].expected == "key.path=value");
    CHECK(problems[0].advice.find("--set model=dem") != std::string::npos);
  }
  auto problems = problems_of(R"({"a": [1, 2]})", "a[5]=1");
  REQUIRE(problems.size() == 1);
  CHECK(problems[0].path == "a");
  CHECK(problems[0].expected == "an index from 0 to 2 after 'a'");
  problems = problems_of(R"({"a": {"b": "0.5 m"}})", "a.b.c=1");
  REQUIRE(problems.size() == 1);
  CHECK(problems[0].path == "a.b");
  CHECK(problems[0].expected.find("\"0.5 m\"") != std::string::npos);
}

TEST_CASE("paths find values") {
  const Json document = Json::parse(R"({"a": [1, {"b": 2}]})");
  REQUIRE(find_path(document, "a[1].b") != nullptr);
  CHECK(*find_path(document, "a[1].b") == 2);
  CHECK(find_path(document, "a[2]") == nullptr);
  CHECK(find_path(document, "a.b") == nullptr);
  CHECK(find_path(document, "") == nullptr);
}
