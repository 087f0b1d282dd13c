// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/edge/profile_table.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/contracts.h"
#include "base/error.h"
#include "base/parallel.h"
#include "calibration/edge/dictionary_file.h"
#include "optics/numerics/dense.h"

namespace voxtone::calibration {
namespace {

constexpr std::size_t smoothed_over = 8, smooth_degree = 3, polynomial_nodes = 4;

// The window of `count` nodes nearest to x.
std::size_t nearest_window(const std::vector<double>& nodes, double x, std::size_t count) {
    std::size_t first = 0;
    while (first + count < nodes.size() && std::abs(nodes[first + count] - x) < std::abs(nodes[first] - x)) ++first;
    return first;
}

}  // namespace

NodeWeights smooth_weights(const std::vector<double>& nodes, double x) {
    const std::size_t count = std::min(smoothed_over, nodes.size());
    if (count <= smooth_degree + 1) return polynomial_weights(nodes, x);
    // One node more than counts says where the weights are 0, so that none appears suddenly.
    const std::size_t wide = std::min(count + 1, nodes.size()), first = nearest_window(nodes, x, wide);
    double reach = 0;
    for (std::size_t k = first; k < first + wide; ++k) reach = std::max(reach, std::abs(nodes[k] - x));
    reach *= wide > count ? 1.0 : 1.05;
    Eigen::MatrixXd basis(wide, smooth_degree + 1);
    Eigen::VectorXd weight(wide);
    for (std::size_t k = 0; k < wide; ++k) {
        const double d = (nodes[first + k] - x) / reach, t = 1 - std::abs(d * d * d);
        const auto row = static_cast<Eigen::Index>(k);
        weight[row] = t * t * t + 1e-12;
        for (std::size_t p = 0; p <= smooth_degree; ++p) basis(row, static_cast<Eigen::Index>(p)) = std::pow(d, p);
    }
    const Eigen::MatrixXd normal = basis.transpose() * weight.asDiagonal() * basis;
    const Eigen::VectorXd at_x = optics::symmetric_preimage(normal, Eigen::VectorXd::Unit(smooth_degree + 1, 0));
    const Eigen::VectorXd combined = weight.asDiagonal() * (basis * at_x);
    return {first, {combined.begin(), combined.end()}};
}

NodeWeights polynomial_weights(const std::vector<double>& nodes, double x) {
    const auto exact = std::ranges::find(nodes, x);
    if (exact != nodes.end()) return {static_cast<std::size_t>(exact - nodes.begin()), {1.0}};
    const std::size_t count = std::min(polynomial_nodes, nodes.size()), first = nearest_window(nodes, x, count);
    NodeWeights result{first, std::vector<double>(count, 1.0)};
    for (std::size_t k = 0; k < count; ++k)
        for (std::size_t j = 0; j < count; ++j)
            if (j != k) result.weights[k] *= (x - nodes[first + j]) / (nodes[first + k] - nodes[first + j]);
    return result;
}

EdgeProfileTable::EdgeProfileTable(std::shared_ptr<const EdgeDictionary> dictionary, const EdgeSetup& setup)
    : dictionary_(std::move(dictionary)), setup_(setup), solved_(dictionary_->records.size()) {
    if (dictionary_->setup.scene_digest() != setup.scene_digest())
        throw InputError(
            "The dictionary was made for another setup: its slab, gel, glass, sheet surface or light differ from those "
            "of the measurement, so its profiles would be those of another bench. Give the setup that the dictionary "
            "was made with, or make one for this setup (`voxtone calibrate edge dictionary --setup`).");
    const std::size_t missing = missing_runs(*dictionary_).size();
    if (missing > 0)
        throw InputError(fmt::format(
            "The dictionary lacks {} of {} runs: it is a shard, or was not finished. Run it again to finish it, or put "
            "shards together (`voxtone calibrate edge dictionary --merge`).",
            missing, dictionary_->records.size()));
    for (const double s : grid().sigma_t) ln_sigma_t_.push_back(std::log(s));
}

void EdgeProfileTable::prepare(double g, bool every_g, const Progress* progress) {
    const NodeWeights needed = polynomial_weights(grid().g, std::clamp(g, grid().g.front(), grid().g.back()));
    std::vector<std::size_t> runs;
    for (std::size_t run = 0; run < solved_.size(); ++run) {
        const std::size_t k = run / grid().sigma_t.size() % grid().g.size();
        if ((every_g || (k >= needed.first && k < needed.first + needed.weights.size())) && solved_[run][0].size() == 0)
            runs.push_back(run);
    }
    parallel_for(
        0, runs.size(), 1,
        [&](std::size_t i) {
            const EdgeRecord& record = dictionary_->records[runs[i]];
            for (std::size_t c = 0; c < 3; ++c) {
                Eigen::MatrixXd& profiles = solved_[runs[i]][c];
                profiles.resize(cells_.size(), albedo_nodes);
                for (std::size_t k = 0; k < albedo_nodes; ++k)
                    profiles.col(static_cast<Eigen::Index>(k)) = cells_.profile(record.kernels[k], setup_.sheet(c));
            }
        },
        progress);
}

Eigen::VectorXd EdgeProfileTable::cells(std::size_t thickness, std::size_t channel, const EdgeMedium& medium) const {
    const double g = std::clamp(medium.g, grid().g.front(), grid().g.back());
    const double ln = std::clamp(std::log(medium.sigma_t), ln_sigma_t_.front(), ln_sigma_t_.back());
    const NodeWeights by_g = polynomial_weights(grid().g, g), by_sigma = smooth_weights(ln_sigma_t_, ln);
    const Eigen::VectorXd by_albedo = albedo_weights(std::clamp(medium.albedo, 0.0, 1.0));
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(cells_.size());
    for (std::size_t i = 0; i < by_g.weights.size(); ++i)
        for (std::size_t k = 0; k < by_sigma.weights.size(); ++k) {
            const Eigen::MatrixXd& profiles =
                solved_[grid().run(thickness, by_g.first + i, by_sigma.first + k)][channel];
            VOXTONE_EXPECT(profiles.size() > 0);
            sum.noalias() += profiles * (by_g.weights[i] * by_sigma.weights[k] * by_albedo);
        }
    return sum;
}

double EdgeProfileTable::noise(std::size_t thickness, const EdgeMedium& medium) const {
    const auto nearest = [](const std::vector<double>& list, double x) {
        return static_cast<std::size_t>(std::ranges::min_element(list, {}, [&](double v) { return std::abs(v - x); }) -
                                        list.begin());
    };
    std::size_t node = 0;
    for (std::size_t k = 1; k < albedo_nodes; ++k)
        if (std::abs(albedo_node(k) - medium.albedo) < std::abs(albedo_node(node) - medium.albedo)) node = k;
    return dictionary_
        ->records[grid().run(thickness, nearest(grid().g, medium.g), nearest(grid().sigma_t, medium.sigma_t))]
        .noise[node];
}

}  // namespace voxtone::calibration
