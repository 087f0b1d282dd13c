// SPDX-License-Identifier: GPL-3.0-or-later
//
// Access to the reference tables in tests/data/reference.
#pragma once

#include <fstream>
#include <stdexcept>
#include <string>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

namespace voxtone::optics::testing {

inline nlohmann::json reference(const std::string& name) {
    const std::string path = std::string(VOXTONE_TEST_DATA) + "/reference/" + name;
    std::ifstream file(path);
    if (!file) throw std::runtime_error("cannot open " + path);
    return nlohmann::json::parse(file);
}

inline Eigen::Vector3d vector_of(const nlohmann::json& values) {
    return {values.at(0).get<double>(), values.at(1).get<double>(), values.at(2).get<double>()};
}

}  // namespace voxtone::optics::testing
