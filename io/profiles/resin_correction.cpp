// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/profiles/resin_correction.h"

#include <utility>

#include <fmt/format.h>

namespace voxtone::io {

namespace {

using optics::ColourResidual;
using optics::MeasuringGeometry;

constexpr std::string_view directional = "45/0", diffuse = "d/8";

optics::FlatMeasurement measured_from(const JsonObject& json) {
    json.allow_only({"geometry", "surface", "gain"});
    optics::FlatMeasurement measured;
    const std::string geometry = json.text("geometry");
    if (geometry != directional && geometry != diffuse)
        json.fail("geometry", fmt::format("is \"{}\", expected \"45/0\" or \"d/8\"", geometry));
    if (geometry == diffuse) measured.geometry = MeasuringGeometry::diffuse_8;
    measured.surface = json.number("surface", 0, 1);
    measured.gain = json.number("gain", 0.1, 10);
    return measured;
}

Eigen::MatrixXd matrix_of(const JsonObject& json, const char* key, std::size_t columns, double least, double most) {
    const std::vector<std::vector<double>> rows = json.number_lists(key, 0, least, most);
    Eigen::MatrixXd matrix(static_cast<Eigen::Index>(rows.size()), static_cast<Eigen::Index>(columns));
    for (std::size_t i = 0; i < rows.size(); ++i) {
        if (rows[i].size() != columns)
            json.fail(key, fmt::format("has a row of {} numbers, expected {}", rows[i].size(), columns));
        for (std::size_t k = 0; k < columns; ++k)
            matrix(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) = rows[i][k];
    }
    return matrix;
}

ColourResidual residual_from(const JsonObject& json, std::size_t resins) {
    json.allow_only({"lengths", "centres", "weights"});
    std::vector<double> lengths = json.numbers("lengths", resins, 1e-3, 1e6);
    const Eigen::MatrixXd centres = matrix_of(json, "centres", resins, 0, 1);
    const Eigen::MatrixXd weights = matrix_of(json, "weights", 3, -1e6, 1e6);
    if (centres.rows() != weights.rows())
        json.fail("weights", fmt::format("has {} rows, but there are {} centres", weights.rows(), centres.rows()));
    return {std::move(lengths), centres, weights};
}

template <class Matrix>
std::vector<std::vector<double>> rows_of(const Matrix& matrix) {
    std::vector<std::vector<double>> rows(static_cast<std::size_t>(matrix.rows()));
    for (Eigen::Index i = 0; i < matrix.rows(); ++i)
        for (Eigen::Index k = 0; k < matrix.cols(); ++k) rows[static_cast<std::size_t>(i)].push_back(matrix(i, k));
    return rows;
}

}  // namespace

void read_correction(const JsonObject& json, optics::ResinSet& set) {
    if (json.has("dot_spread")) set.dot_spread = json.number("dot_spread", 0, 1);
    if (json.has("measured")) set.measured = measured_from(json.object("measured"));
    if (json.has("residual")) set.residual = residual_from(json.object("residual"), set.resins.size());
}

void write_correction(JsonWriter& json, const optics::ResinSet& set) {
    if (set.dot_spread > 0) json.add("dot_spread", set.dot_spread);
    if (!(set.measured == optics::FlatMeasurement{})) {
        const bool is_diffuse = set.measured.geometry == MeasuringGeometry::diffuse_8;
        json.line().key("measured").begin_object().add("geometry", is_diffuse ? diffuse : directional);
        json.add("surface", set.measured.surface).add("gain", set.measured.gain).end_object();
    }
    if (set.residual.empty()) return;
    json.line().key("residual").begin_object().add("lengths", set.residual.lengths());
    json.line().add("centres", rows_of(set.residual.centres()));
    json.line().add("weights", rows_of(set.residual.weights())).end_object();
}

}  // namespace voxtone::io
