// SPDX-License-Identifier: GPL-3.0-or-later
//
// What edges can tell at best: the Cramer-Rao bound of extinction, albedo and g over the space of resins, for slabs of
// one thickness, two, three, and with a spectrometer beside the camera.
//
// Samples of 0.0276 mm have independent errors of 0.001 of a white (less where it is darker). What all samples of a
// photograph share is unknown too, with the errors of setup.json: its level (0.3 %), the slab's thickness (2 %), the
// gel (a blur of 0.012 mm); all photographs share mu (0.7 %, what a fit of five resins leaves of it). A spectrometer
// reads every slab over the white and over the black of the sheet, far from the edge, within 0.002, and knows no mu.
// Bounds are those of a linear model: derivatives by central differences of the table. Run:
//   build/release/benchmarks/edge_bound [PATHS 32768]
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>

#include <fmt/format.h>
#include <Eigen/LU>

#include "benchmarks/calibration/edge/edge_rehearsal.h"
#include "calibration/resins/resin_coordinates.h"

namespace {

using namespace voxtone;
using namespace voxtone::calibration;

constexpr double sample_noise = 0.001, mu_error = 0.007, spectrometer_error = 0.002, truth_g = 0.4;
constexpr std::size_t green = 1;

struct Design {
    const char* name;
    std::vector<std::size_t> slabs;  // indices of thicknesses
    bool spectrometer = false, scale = false, g_free = false;
};

struct Bound {
    double ln_sigma_t = 0, ln_co_albedo = 0, g = 0;
};

// Rows of a linear model: derivatives by all unknowns, divided by the row's error.
class Rows {
public:
    explicit Rows(Eigen::Index unknowns) : information_(Eigen::MatrixXd::Zero(unknowns, unknowns)) {}
    void add(const Eigen::MatrixXd& by_unknowns, const Eigen::VectorXd& error) {
        const Eigen::MatrixXd scaled = error.cwiseInverse().asDiagonal() * by_unknowns;
        information_ += scaled.transpose() * scaled;
    }
    void know(Eigen::Index unknown, double error) { information_(unknown, unknown) += 1 / (error * error); }
    [[nodiscard]] Eigen::MatrixXd covariance() const { return information_.inverse(); }

private:
    Eigen::MatrixXd information_;
};

class Slab {
public:
    Slab(const EdgeProfileTable& table, std::size_t thickness) : table_(table), thickness_(thickness) {
        const EdgeSetup& setup = table.setup();
        see_ = optics::pixels_from_cells(table.geometry(), setup.positions(), {setup.pitch_mm, setup.blur_mm, 1});
        stretched_ =
            optics::pixels_from_cells(table.geometry(), setup.positions(), {setup.pitch_mm, setup.blur_mm, 1 + step_});
        softer_ = optics::pixels_from_cells(table.geometry(), setup.positions(),
                                            {setup.pitch_mm, std::hypot(setup.blur_mm, setup.gel_error_mm), 1});
    }
    // Unknowns: v, ln sigma_t, g, mu; level, thickness, gel of this slab.
    [[nodiscard]] Eigen::MatrixXd derivatives(double v, double ln, bool far, bool scale) const {
        const auto cells = [&](double dv, double dln, double dg) {
            const double g = truth_g + dg;
            // A resin at another g, of the same extinction and v.
            return table_.cells(thickness_, green, {std::exp(ln + dln), albedo_of_v(v + dv, g), g});
        };
        const auto seen = [&](const Eigen::VectorXd& c) {
            return far ? Eigen::VectorXd(Eigen::Vector2d(c[0], c[c.size() - 1])) : Eigen::VectorXd(see_ * c);
        };
        const double dv = std::min(0.01, 0.2 * v);
        const Eigen::VectorXd c = cells(0, 0, 0), F = seen(c);
        Eigen::MatrixXd J(F.size(), 7);
        J.col(0) = (seen(cells(dv, 0, 0)) - seen(cells(-dv, 0, 0))) / (2 * dv);
        J.col(1) = (seen(cells(0, dln_, 0)) - seen(cells(0, -dln_, 0))) / (2 * dln_);
        J.col(2) = (seen(cells(0, 0, dg_)) - seen(cells(0, 0, -dg_))) / (2 * dg_);
        J.col(3) = J.col(4) = F;
        J.col(5) = J.col(1);  // thicker: as much denser, and wider
        if (!far && scale) J.col(5) += (stretched_ * c - F) / step_;
        J.col(6) = far ? Eigen::VectorXd::Zero(F.size()) : Eigen::VectorXd(softer_ * c - F);
        if (far) J.col(3).setZero(), J.col(4).setZero();
        return J;
    }
    // Whether ln sigma_t (1) or g (2) does more to the profile than the table's noise.
    [[nodiscard]] bool tells(Eigen::Index unknown, double v, double ln) const {
        const Eigen::VectorXd by = derivatives(v, ln, false, false).col(unknown);
        const double noise = table_.noise(thickness_, {std::exp(ln), albedo_of_v(v, truth_g), truth_g}) *
                             std::sqrt(0.5) / (unknown == 1 ? dln_ : dg_);
        return by.norm() / std::sqrt(static_cast<double>(by.size())) > 3 * noise;
    }
    [[nodiscard]] Eigen::VectorXd error(double v, double ln) const {
        const Eigen::VectorXd F =
            see_ * table_.cells(thickness_, green, {std::exp(ln), albedo_of_v(v, truth_g), truth_g});
        return sample_noise * F.cwiseMax(0.01).cwiseSqrt();
    }

private:
    static constexpr double step_ = 0.01, dln_ = 0.15, dg_ = 0.1;
    const EdgeProfileTable& table_;
    std::size_t thickness_;
    Eigen::MatrixXd see_, stretched_, softer_;
};

Bound bound(const std::vector<Slab>& slabs, const Design& design, const EdgeSetup& setup, double sigma_t,
            double co_albedo) {
    const double v = v_of_albedo(1 - co_albedo, truth_g), ln = std::log(sigma_t);
    Rows rows(4 + 3 * static_cast<Eigen::Index>(design.slabs.size()));
    rows.know(3, mu_error);
    rows.know(2, design.g_free ? 10 : 1e-6);
    const auto spread = [&](const Eigen::MatrixXd& J, Eigen::Index s) {
        Eigen::MatrixXd all = Eigen::MatrixXd::Zero(J.rows(), 4 + 3 * static_cast<Eigen::Index>(design.slabs.size()));
        all.leftCols(4) = J.leftCols(4);
        all.middleCols(4 + 3 * s, 3) = J.rightCols(3);
        return all;
    };
    for (std::size_t k = 0; k < design.slabs.size(); ++k) {
        const auto s = static_cast<Eigen::Index>(k);
        const Slab& slab = slabs[design.slabs[k]];
        rows.add(spread(slab.derivatives(v, ln, false, design.scale), s), slab.error(v, ln));
        rows.know(4 + 3 * s, setup.level_error);
        rows.know(5 + 3 * s, setup.thickness_error);
        rows.know(6 + 3 * s, 1);
        if (design.spectrometer)
            rows.add(spread(slab.derivatives(v, ln, true, false), s), Eigen::Vector2d::Constant(spectrometer_error));
    }
    const Eigen::MatrixXd C = rows.covariance();
    const double by_v = std::abs(albedo_by_v(v, truth_g)) / co_albedo;
    const auto told = [&](Eigen::Index unknown) {
        return std::ranges::any_of(design.slabs, [&](std::size_t k) { return slabs[k].tells(unknown, v, ln); });
    };
    return {told(1) ? std::sqrt(C(1, 1)) : 10, by_v * std::sqrt(C(0, 0)), told(1) && told(2) ? std::sqrt(C(2, 2)) : 10};
}

// Nobody knows a value to more than a factor of e.
std::string percent(double error) { return error < 1 ? fmt::format("{:.2g}", 100 * error) : "-"; }

}  // namespace

int main(int count, char** words) {
    const auto paths = static_cast<std::uint32_t>(count > 1 ? std::atoi(words[1]) : 1 << 15);
    const EdgeSetup setup = rehearsal::assumed_setup();
    EdgeProfileTable table(rehearsal::dictionary("", {0.2, 0.4, 0.6}, paths, {0.25, 0.5, 1, 2}), setup);
    table.prepare(truth_g, true);
    std::vector<Slab> slabs;
    for (std::size_t t = 0; t < 4; ++t) slabs.emplace_back(table, t);
    const Design designs[] = {{"0.5", {1}},
                              {"1", {2}},
                              {"0.5, 1", {1, 2}},
                              {"0.25, 0.5, 1", {0, 1, 2}},
                              {"0.5, 1, 2", {1, 2, 3}},
                              {"0.5, 1, spectrometer", {1, 2}, true},
                              {"0.5, 1, by scale", {1, 2}, false, true}};
    const Design g_free{"0.5, 1", {1, 2}, false, false, true};
    fmt::print(
        "Standard errors at best, in %: of the extinction / of 1 - albedo; g = 0.4 known. {} paths a run\n\n"
        "| extinction, 1/mm | 1 - albedo |",
        paths);
    for (const Design& design : designs) fmt::print(" {} |", design.name);
    fmt::print(" 0.5, 1, g unknown: of g, absolute |\n|---|---|");
    for (std::size_t k = 0; k < std::size(designs) + 1; ++k) fmt::print("---|");
    fmt::print("\n");
    for (const double sigma_t : {1.5, 4.0, 10.0, 25.0})
        for (const double co_albedo : {0.0005, 0.005, 0.05, 0.3, 0.8}) {
            fmt::print("| {} | {} |", sigma_t, co_albedo);
            for (const Design& design : designs) {
                const Bound b = bound(slabs, design, setup, sigma_t, co_albedo);
                fmt::print(" {} / {} |", percent(b.ln_sigma_t), percent(b.ln_co_albedo));
            }
            const Bound free = bound(slabs, g_free, setup, sigma_t, co_albedo);
            fmt::print(" {} |\n", free.g < 1 ? fmt::format("{:.2g}", free.g) : "-");
        }
    return 0;
}
