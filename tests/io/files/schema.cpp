// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/io/files/schema.h"
#include "tests/places.h"

#include <fstream>

#include <nlohmann/json.hpp>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validation_results.hpp>
#include <valijson/validator.hpp>

namespace voxtone::io {

std::vector<std::string> schema_faults(const std::string& name, std::string_view json) {
    using valijson::adapters::NlohmannJsonAdapter;
    std::ifstream file(test::source_dir() + "/data/schema/" + name + ".schema.json");
    const nlohmann::json rules = nlohmann::json::parse(file), text = nlohmann::json::parse(json);
    valijson::Schema schema;
    valijson::SchemaParser(valijson::SchemaParser::kDraft7).populateSchema(NlohmannJsonAdapter(rules), schema);
    valijson::ValidationResults results;
    valijson::Validator().validate(schema, NlohmannJsonAdapter(text), &results);
    std::vector<std::string> faults;
    for (valijson::ValidationResults::Error error; results.popError(error);) {
        std::string where;
        for (const std::string& part : error.context) where += part;
        faults.push_back(where + ": " + error.description);
    }
    return faults;
}

}  // namespace voxtone::io
