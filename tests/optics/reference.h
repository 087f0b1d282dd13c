// SPDX-License-Identifier: GPL-3.0-or-later
//
// Access to the reference tables in tests/data/reference.
#pragma once

#include <fstream>
#include <map>
#include <stdexcept>
#include <string>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "tests/places.h"

namespace voxtone::optics::testing {

/// A table, read once; it lives as long as the program, so that a loop over a part of it is safe.
inline const nlohmann::json& reference(const char* name) {
    static std::map<std::string, nlohmann::json> tables;
    const auto [table, is_new] = tables.try_emplace(name);
    if (is_new) {
        const std::string path = test::test_data() + "/reference/" + name;
        std::ifstream file(path);
        if (!file) throw std::runtime_error("cannot open " + path);
        table->second = nlohmann::json::parse(file);
    }
    return table->second;
}

inline Eigen::Vector3d vector_of(const nlohmann::json& values) {
    return {values.at(0).get<double>(), values.at(1).get<double>(), values.at(2).get<double>()};
}

}  // namespace voxtone::optics::testing
