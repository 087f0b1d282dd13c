// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/resins/resin_prior.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "io/files/json_object.h"

namespace voxtone::calibration {
namespace {

constexpr double least_variance = 1e-12;  // nobody knows better

PriorValue prior_value(const io::JsonObject& channel, double g) {
    // As the edges had it, where a chart has completed it.
    const io::JsonObject of = channel.has("edges") ? channel.object("edges") : channel;
    const io::JsonObject sigma_t = of.object("sigma_t_per_mm"), albedo = of.object("albedo");
    const std::vector<double> c = channel.numbers("covariance_v_ln_sigma_t", 3, -1e300, 1e300);
    if (c[0] * c[2] < c[1] * c[1]) channel.fail("covariance_v_ln_sigma_t", "must be that of two values: vv, vl, ll");
    Eigen::Matrix2d covariance;
    covariance << c[0], c[1], c[1], c[2];
    PriorValue value;
    value.at = {v_of_albedo(albedo.number("value", 0, 1), g), std::log(sigma_t.number("value", 1e-6, 1e6))};
    value.precision = prior_precision(covariance, albedo.texts("doubts").empty(), sigma_t.texts("doubts").empty());
    return value;
}

ResinPrior prior_of_json(const io::JsonObject& json, const std::string& source) {
    if (json.text("format") != "voxtone-edge-fit")
        json.fail("format", "must be \"voxtone-edge-fit\": a prior is the NAME.edge.json of `calibrate edge fit`");
    ResinPrior prior{source, json.number("g", -0.95, 0.95), json.has("eta") ? json.number("eta", 1, 3) : 1.5, {}};
    for (const io::JsonObject& resin : json.objects("resins")) {
        ResinPrior::Resin& entry = prior.resins.emplace_back();
        entry.role = resin.text("role");
        const std::vector<io::JsonObject> channels = resin.objects("channels");
        if (channels.size() != entry.channel.size()) resin.fail("channels", "must be three: R, G, B");
        for (std::size_t c = 0; c < channels.size(); ++c) entry.channel[c] = prior_value(channels[c], prior.g);
    }
    if (prior.resins.empty()) json.fail("resins", "must name one resin at least");
    return prior;
}

}  // namespace

Eigen::Matrix2d prior_precision(const Eigen::Matrix2d& covariance, bool v_known, bool ln_sigma_t_known) {
    Eigen::Matrix2d precision = Eigen::Matrix2d::Zero();
    const Eigen::Matrix2d safe = covariance + least_variance * Eigen::Matrix2d::Identity();
    if (v_known && ln_sigma_t_known) return safe.inverse();
    if (v_known) precision(0, 0) = 1 / safe(0, 0);
    if (ln_sigma_t_known) precision(1, 1) = 1 / safe(1, 1);
    return precision;
}

const ResinPrior::Resin* ResinPrior::find(std::string_view role) const {
    const auto found = std::ranges::find(resins, role, &Resin::role);
    return found == resins.end() ? nullptr : &*found;
}

ResinPrior parse_resin_prior(std::string_view text, const std::string& source) {
    return prior_of_json(io::JsonObject::parse(text, source), source);
}

ResinPrior read_resin_prior(const std::filesystem::path& file) {
    return prior_of_json(io::JsonObject::read(file), file.string());
}

}  // namespace voxtone::calibration
