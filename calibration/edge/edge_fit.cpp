// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/edge/edge_fit.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <Eigen/LU>

#include "base/error.h"
#include "base/parallel.h"
#include "base/stopwatch.h"
#include "base/warning.h"
#include "calibration/resins/resin_coordinates.h"

namespace voxtone::calibration {
namespace {

constexpr double coarse_mu = 0.01, fine_mu = 0.001, largest_v_error = 0.1, largest_ln_error = 0.35, odd_bound = 1e-6;
constexpr double least_misfit = 0.03, misfit_of_level = 0.08;
constexpr double thin_signal = 0.0005;  // a step smaller than this is lost in uneven light: it tells no extinction

using Minimum = EdgeObjective::Minimum;

// A resin in a channel, with what was found last.
struct Part {
    std::size_t resin = 0, channel = 0;
    std::unique_ptr<EdgeObjective> objective;
    Minimum found;
};

// Where a parabola through the least of a curve and its neighbours has its minimum.
double lowest(const std::vector<std::pair<double, double>>& curve) {
    const auto least = std::ranges::min_element(curve, {}, &std::pair<double, double>::second);
    if (least == curve.begin() || least + 1 == curve.end()) return least->first;
    const auto [x0, y0] = *(least - 1);
    const auto [x1, y1] = *least;
    const auto [x2, y2] = *(least + 1);
    const double a = (y1 - y0) / (x1 - x0), b = (y2 - y1) / (x2 - x1), curvature = (b - a) / (x2 - x0);
    if (!(curvature > 0)) return x1;
    return std::clamp((x0 + x1) / 2 - a / (2 * curvature), x0, x2);
}

class EdgeFitter {
public:
    EdgeFitter(const std::vector<EdgeProfile>& profiles, EdgeProfileTable& table, const EdgeFitOptions& options,
               const Progress* progress)
        : table_(table), options_(options), progress_(progress) {
        for (const EdgeProfile& profile : profiles)
            if (std::ranges::find(roles_, profile.resin) == roles_.end()) roles_.push_back(profile.resin);
        if (roles_.size() < 2)
            throw InputError(fmt::format(
                "Profiles of one resin ({}) only. The factor mu that takes the bench's bias out is told by what all "
                "resins have in common; measure at least two.",
                roles_.empty() ? "none" : roles_.front()));
        const bool every_g = options.anisotropy != EdgeAnisotropy::given;
        if (!every_g && (options.g < table.grid().g.front() - 1e-9 || options.g > table.grid().g.back() + 1e-9))
            throw InputError(fmt::format("--g: {} is outside the dictionary, which has {} to {}; make one with it",
                                         options.g, table.grid().g.front(), table.grid().g.back()));
        if (every_g && table.grid().g.size() < 3)
            throw InputError(
                "--g: a g that is to be found needs a dictionary with at least three; make one with --g 0,0.2,0.4,0.6");
        table.prepare(options.g, every_g, progress);
        gs_.assign(roles_.size(), options.g);
        fit_.resins.resize(roles_.size());
        for (std::size_t r = 0; r < roles_.size(); ++r) add(profiles, r);
        if (parts_.empty())
            throw InputError(
                "No slab of any resin has all its samples in any channel. Shorten the exposure, so that "
                "nothing is clipped.");
    }

    EdgeFit fit() {
        const Stopwatch watch;
        find_mu(true);
        if (options_.anisotropy != EdgeAnisotropy::given) {
            find_g();
            find_mu(false);
            find_g();
        }
        values();
        warn_of_mu();
        fit_.seconds = watch.total();
        return std::move(fit_);
    }

private:
    void add(const std::vector<EdgeProfile>& profiles, std::size_t r) {
        std::vector<const EdgeProfile*> slabs;
        for (const EdgeProfile& profile : profiles)
            if (profile.resin == roles_[r]) slabs.push_back(&profile);
        if (slabs.size() < 2)
            fit_.warnings.push_back(
                named_warning("one-slab", fmt::format("{}: one thickness only ({} mm); extinction and albedo lean on "
                                                      "one profile, and nothing tells when it "
                                                      "is wrong. Measure a second slab.",
                                                      roles_[r], slabs[0]->thickness_mm)));
        fit_.resins[r].role = roles_[r];
        for (std::size_t c = 0; c < 3; ++c) {
            auto seen = edge_observations(slabs, c, table_, options_.metric, fit_.warnings);
            if (seen.empty()) continue;
            parts_.push_back({r, c, std::make_unique<EdgeObjective>(std::move(seen), c, table_, options_.metric), {}});
        }
    }

    // All minima at a mu, from the last ones or from the coarse net.
    double minima(double mu, bool anew, std::vector<double>* of_resin = nullptr) {
        parallel_for(
            0, parts_.size(), 1,
            [&](std::size_t i) {
                Part& part = parts_[i];
                const double g = gs_[part.resin];
                part.found = anew ? part.objective->minimum(g, mu) : part.objective->minimum_from(part.found.at, g, mu);
            },
            progress_);
        double sum = 0;
        if (of_resin) of_resin->assign(roles_.size(), 0.0);
        for (const Part& part : parts_) {
            sum += part.found.distance;
            if (of_resin) (*of_resin)[part.resin] += part.found.distance;
        }
        return sum;
    }

    void find_mu(bool first) {
        const double from = options_.mu_from, to = options_.mu_to;
        if (to - from < 1e-9) {
            fit_.mu = from;
            fit_.total = minima(from, true) / from;
            return;
        }
        std::vector<std::vector<double>> shares;  // per mu: distance of each resin
        std::vector<std::pair<double, double>> curve;
        const auto trace = [&](double a, double b, double step, bool anew) {
            const int count = static_cast<int>(std::lround((b - a) / step));
            for (int k = 0; k <= count; ++k) {
                const double mu = a + (b - a) * k / std::max(count, 1);
                shares.emplace_back();
                curve.emplace_back(mu, minima(mu, anew && k == 0, &shares.back()) / mu);
            }
        };
        minima(std::clamp(1.0, from, to), true);
        trace(from, to, coarse_mu, first);
        const auto whole = curve;
        const auto whole_shares = shares;
        const double near = std::ranges::min_element(curve, {}, &std::pair<double, double>::second)->first;
        curve.clear();
        trace(std::max(from, near - coarse_mu), std::min(to, near + coarse_mu), fine_mu, true);
        fit_.mu = lowest(curve);
        fit_.mu_curve = whole;
        fit_.mu_curve.insert(fit_.mu_curve.end(), curve.begin(), curve.end());
        std::ranges::sort(fit_.mu_curve);
        fit_.mu_error = mu_jackknife(whole, whole_shares);
        fit_.total = minima(fit_.mu, true) / fit_.mu;
    }

    double mu_jackknife(const std::vector<std::pair<double, double>>& curve,
                        const std::vector<std::vector<double>>& shares) const {
        const auto n = static_cast<double>(roles_.size());
        double sum = 0, squares = 0;
        for (std::size_t r = 0; r < roles_.size(); ++r) {
            auto without = curve;
            for (std::size_t k = 0; k < curve.size(); ++k) without[k].second -= shares[k][r] / curve[k].first;
            const double mu = lowest(without);
            sum += mu, squares += mu * mu;
        }
        const double jackknife = std::sqrt(std::max(0.0, (n - 1) / n * (squares - sum * sum / n)));
        // Few resins may agree by chance; white points and the dictionary's noise are not better than they are.
        return std::hypot(jackknife, level_error() / std::sqrt(n));
    }

    // Relative error of a profile's level: its white point, and the median noise of the records that were met.
    double level_error() const {
        std::vector<double> grain;
        for (const Part& part : parts_)
            for (const EdgeObservation& slab : part.objective->slabs())
                grain.push_back(table_.noise(slab.thickness, edge_medium(part.found.at, gs_[part.resin])) /
                                std::max(slab.value.mean(), 1e-3));
        std::ranges::sort(grain);
        return std::hypot(table_.setup().level_error, grain[grain.size() / 2]);
    }

    void find_g() {
        std::vector<std::vector<std::pair<double, double>>> curves(roles_.size());
        std::vector<std::vector<EdgePoint>> at(parts_.size());
        for (const double g : table_.grid().g) {
            gs_.assign(roles_.size(), g);
            std::vector<double> shares;
            static_cast<void>(minima(fit_.mu, true, &shares));
            for (std::size_t r = 0; r < roles_.size(); ++r) curves[r].emplace_back(g, shares[r]);
            for (std::size_t i = 0; i < parts_.size(); ++i) at[i].push_back(parts_[i].found.at);
        }
        std::vector<std::pair<double, double>> total = curves[0];
        for (std::size_t r = 1; r < roles_.size(); ++r)
            for (std::size_t k = 0; k < total.size(); ++k) total[k].second += curves[r][k].second;
        const double shared = lowest(total);
        double squares = 0;
        for (std::size_t r = 0; r < roles_.size(); ++r) {
            fit_.resins[r].by_g = curves[r];
            auto without = total;
            for (std::size_t k = 0; k < total.size(); ++k) without[k].second -= curves[r][k].second;
            squares += std::pow(lowest(without) - shared, 2);
        }
        const auto n = static_cast<double>(roles_.size());
        for (std::size_t r = 0; r < roles_.size(); ++r) {
            const bool each = options_.anisotropy == EdgeAnisotropy::each;
            gs_[r] = each ? lowest(curves[r]) : shared;
            fit_.resins[r].g_error = each ? spread_of_g(curves[r]) : std::sqrt((n - 1) / n * squares);
        }
        static_cast<void>(minima(fit_.mu, true));
        for (std::size_t i = 0; i < parts_.size(); ++i) compare_similar(parts_[i], at[i]);
    }

    // The best fits at all g beside what similarity makes of the fitted medium.
    void compare_similar(const Part& part, const std::vector<EdgePoint>& at) {
        auto& list = fit_.resins[part.resin].similar[part.channel];
        list.clear();
        const double g0 = gs_[part.resin];
        const optics::Medium m = medium_of({part.found.at[0], part.found.at[1]}, g0);
        for (std::size_t k = 0; k < at.size(); ++k) {
            const double g = table_.grid().g[k];
            const optics::Medium similar{m.sigma_a, m.sigma_s * (1 - g0) / (1 - g)};
            list.push_back({g, edge_medium(at[k], g), {similar.sigma_t(), similar.albedo(), g}});
        }
    }

    // How far g may go until the distance has grown by a tenth: what its curve tells by itself.
    static double spread_of_g(const std::vector<std::pair<double, double>>& curve) {
        const auto least = std::ranges::min_element(curve, {}, &std::pair<double, double>::second);
        double from = curve.front().first, to = curve.back().first;
        for (auto k = curve.begin(); k != curve.end(); ++k) {
            if (k->second <= 1.1 * least->second) continue;
            if (k < least) from = std::max(from, k->first);
            if (k > least) to = std::min(to, k->first);
        }
        return (to - from) / 2;
    }

    void values() {
        const double set_g = options_.anisotropy == EdgeAnisotropy::shared ? gs_.front() : options_.g;
        fit_.set = {options_.name, "", {}, set_g, options_.eta, {}};
        for (std::size_t r = 0; r < roles_.size(); ++r) {
            fit_.resins[r].g = gs_[r];
            fit_.set.resins.push_back({roles_[r], roles_[r], {0, 0, 0}, {0, 0, 0}});
        }
        for (const Part& part : parts_) value(part, set_g);
        for (EdgeResinFit& resin : fit_.resins)
            for (std::size_t c = 0; c < 3; ++c)
                if (resin.channel[c].distance == 0 && resin.channel[c].sigma_t.value == 0)
                    throw InputError(fmt::format(
                        "{}: no slab has all samples of {}; shorten the exposure, so that nothing is clipped.",
                        resin.role, "RGB"[c]));
        fit_.set.source = fmt::format(
            "edge profiles; mu = {:.4f} +- {:.4f}, lambda = {}, g {}", fit_.mu, fit_.mu_error, options_.metric.lambda,
            options_.anisotropy == EdgeAnisotropy::given    ? "given"
            : options_.anisotropy == EdgeAnisotropy::shared ? "found, one for all"
                                                            : "found for each, brought to one by similarity");
        fit_.set.validate();
    }

    void value(const Part& part, double set_g) {
        EdgeValue& v = fit_.resins[part.resin].channel[part.channel];
        const double g = gs_[part.resin];
        v.at = part.found.at;
        v.distance = part.found.distance;
        const Eigen::Matrix2d fitted = part.objective->covariance(part.found, g, fit_.mu, fit_.mu_error);
        const auto similar = [&](const EdgePoint& p) {
            const optics::Medium m = medium_of({p[0], p[1]}, g);
            const ResinPoint q = point_of({m.sigma_a, m.sigma_s * (1 - g) / (1 - set_g)}, set_g);
            return EdgePoint(q.v, q.ln_sigma_t);
        };
        Eigen::Matrix2d turn;
        for (int k = 0; k < 2; ++k)
            turn.col(k) =
                (similar(v.at + 1e-4 * EdgePoint::Unit(k)) - similar(v.at - 1e-4 * EdgePoint::Unit(k))) / 2e-4;
        v.covariance = turn * fitted * turn.transpose();
        const EdgePoint p = similar(v.at), error = v.covariance.diagonal().cwiseSqrt();
        const auto albedo = [&](double x) { return albedo_of_v(std::clamp(x, 0.0, 1.0), set_g); };
        v.sigma_t = {
            std::exp(p[1]), std::exp(p[1]) * error[1], std::exp(p[1] - error[1]), std::exp(p[1] + error[1]), {}};
        v.albedo = {albedo(p[0]),
                    std::abs(albedo_by_v(p[0], set_g)) * error[0],
                    albedo(p[0] + error[0]),
                    albedo(p[0] - error[0]),
                    {}};
        doubts(part, error, v);
        warn_of_misfit(part);
        fit_.set.resins[part.resin].sigma_t_per_mm[part.channel] = v.sigma_t.value;
        fit_.set.resins[part.resin].albedo[part.channel] = v.albedo.value;
    }

    void doubts(const Part& part, const EdgePoint& error, EdgeValue& v) const {
        double signal = 0;  // the largest step that is left of the edge
        for (const EdgeObservation& slab : part.objective->slabs()) {
            const Eigen::Index n = slab.x.size(), side = n / 4;
            signal = std::max(signal, slab.value.tail(side).mean() - slab.value.head(side).mean());
        }
        const EdgePoint least = part.objective->least(), most = part.objective->most();
        if (v.at[1] < least[1] + odd_bound || v.at[1] > most[1] - odd_bound) v.sigma_t.doubts.push_back(Doubt::bound);
        if (v.at[0] < least[0] + odd_bound) v.albedo.doubts.push_back(Doubt::bound);
        if (v.at[0] > most[0] - odd_bound) v.albedo.doubts.push_back(Doubt::dark);
        if (signal < thin_signal) v.sigma_t.doubts.push_back(Doubt::opaque);
        if (error[0] > largest_v_error) v.albedo.doubts.push_back(Doubt::unsure);
        if (error[1] > largest_ln_error) v.sigma_t.doubts.push_back(Doubt::unsure);
        v.told = v.sigma_t.doubts.empty() && v.albedo.doubts.empty();
    }

    // Slabs that no resin explains: swapped, or not as thick as they are said to be.
    void warn_of_misfit(const Part& part) {
        double level = 0;
        for (const EdgeObservation& slab : part.objective->slabs())
            level = std::max(level, fit_.mu * slab.value.cwiseAbs().mean());
        if (part.found.distance < std::max(least_misfit, misfit_of_level * level)) return;
        fit_.warnings.push_back(named_warning(
            "misfit",
            fmt::format("{} in {}: no resin has these profiles (distance {:.3f}, where they are {:.3f} bright). Are "
                        "its slabs of this "
                        "resin and as thick as the table says, and is the setup that of the bench?",
                        roles_[part.resin], "RGB"[part.channel], part.found.distance, level)));
    }

    void warn_of_mu() {
        const double from = options_.mu_from, to = options_.mu_to;
        if (to - from > 1e-9 && (fit_.mu < from + 2 * fine_mu || fit_.mu > to - 2 * fine_mu))
            fit_.warnings.push_back(named_warning(
                "bias",
                fmt::format(
                    "mu = {:.3f} lies at the end of its range, {} to {}: the bench's bias is larger than expected, or "
                    "the "
                    "profiles are not those of the setup. Look at white point, setup and thicknesses; --mu widens the "
                    "range.",
                    fit_.mu, from, to)));
    }

    EdgeProfileTable& table_;
    EdgeFitOptions options_;
    const Progress* progress_;
    std::vector<std::string> roles_;
    std::vector<double> gs_;
    std::vector<Part> parts_;
    EdgeFit fit_;
};

}  // namespace

EdgeFit fit_edges(const std::vector<EdgeProfile>& profiles, EdgeProfileTable& table, const EdgeFitOptions& options,
                  const Progress* progress) {
    return EdgeFitter(profiles, table, options, progress).fit();
}

}  // namespace voxtone::calibration
