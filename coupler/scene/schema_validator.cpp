#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validation_results.hpp>
#include <valijson/validator.hpp>

#include "coupler/scene/schema.hpp"

namespace gabion::scene {

void validate_structure(const Json& document, std::vector<SceneProblem>& problems) {
  using Adapter = valijson::adapters::NlohmannJsonAdapter;
  valijson::Schema parsed;
  valijson::SchemaParser(valijson::SchemaParser::kDraft7).populateSchema(Adapter(schema()), parsed);
  valijson::ValidationResults results;
  if (valijson::Validator().validate(parsed, Adapter(document), &results)) return;
  for (valijson::ValidationResults::Error error; results.popError(error);) {
    std::string path;
    for (const std::string& step : error.context) path += step;
    problems.push_back({path, error.description, "", "see docs/scenes.md"});
  }
}

}  // namespace gabion::scene
