// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/fit/principles.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "calibration/patches/patch_file.h"
#include "optics/layered/layered_appearance.h"

namespace voxtone::calibration {

using optics::Medium;

namespace {

const char* const clear_role = "T";
constexpr double principle_error = 1e-4;  // of a reflectance by the ten directions used here

bool is_pure(const Patch& patch, const std::string& role) {
    return patch.top.size() == 1 && patch.top.front().role == role;
}

// Mean over the channels of a base's square on itself, or of a bare surface.
double lightness(const PatchTable& table, const std::string& base) {
    double sum = 0, count = 0;
    for (const Patch& patch : table.patches) {
        if (patch.backing == base && patch.on)
            return std::accumulate(patch.on->rho.begin(), patch.on->rho.end(), 0.0) / double(patch.on->rho.size());
        if (patch.backing != base || !is_pure(patch, base)) continue;
        sum += std::accumulate(patch.rho.begin(), patch.rho.end(), 0.0);
        count += static_cast<double>(patch.rho.size());
    }
    if (count == 0)
        throw InputError(
            fmt::format("{}: patch {} on {} is missing; the albedo of a base is read from its own square upon it.",
                        table.source, base, base));
    return sum / count;
}

template <class List, class Value>
bool contains(const List& list, const Value& value) {
    return std::ranges::find(list, value) != list.end();
}

/// Of squares on known surfaces alone: whether there are thin ones and thick ones.
bool has_two_thicknesses(const PatchTable& table) {
    constexpr double apart = 1.5;
    const auto [least, most] = std::ranges::minmax(table.patches, {}, &Patch::thickness_mm);
    return most.thickness_mm > apart * least.thickness_mm;
}

/// An interval of ln sigma_t.
struct LogExtinctions {
    explicit LogExtinctions(const ResinBounds& bounds)
        : low(std::log(bounds.least_sigma_t)), high(std::log(bounds.most_sigma_t)) {}
    [[nodiscard]] LogExtinctions around(double value, double half) const {
        LogExtinctions part = *this;
        part.low = std::max(low, value - half);
        part.high = std::min(high, value + half);
        return part;
    }
    double low, high;
};

/// Sets `value` to where the deviation is least on a grid of `steps` over `part`, then `zooms` times on a grid of four
/// steps between its neighbours, within `range`.
template <class Search>
void search_line(Search& search, double& value, LogExtinctions part, const LogExtinctions& range, int steps,
                 int zooms) {
    for (int zoom = 0; zoom <= zooms; ++zoom) {
        double best = part.low, least = std::numeric_limits<double>::infinity();
        const double step = (part.high - part.low) / steps;
        for (int k = 0; k <= steps; ++k) {
            value = part.low + k * step;
            const double d = search.deviation();
            if (d < least) least = d, best = value;
        }
        value = best;
        part = range.around(best, step);
        steps = 4;
    }
}

struct Minimum {
    double deviation;
    ResinPoint point;
};
constexpr std::size_t most_minima = 4;

/// The deviation of a resin over all that is possible: 11 values of v by 13 of ln sigma_t.
class DeviationGrid {
public:
    template <class Deviation>
    DeviationGrid(const ResinBounds& bounds, Deviation deviation)
        : first_{bounds.least_v, std::log(bounds.least_sigma_t)} {
        step_.v = (bounds.most_v - bounds.least_v) / (rows - 1);
        step_.ln_sigma_t = (std::log(bounds.most_sigma_t) - first_.ln_sigma_t) / (columns - 1);
        for (int i = 0; i < rows; ++i)
            for (int k = 0; k < columns; ++k) values_.push_back(deviation(point(i, k)));
    }
    /// From node to node.
    [[nodiscard]] const ResinPoint& step() const { return step_; }
    /// Nodes that none of their eight neighbours is below, the deepest first.
    [[nodiscard]] std::vector<Minimum> local_minima() const {
        std::vector<Minimum> minima;
        for (int i = 0; i < rows; ++i)
            for (int k = 0; k < columns; ++k)
                if (is_least(i, k)) minima.push_back({value(i, k), point(i, k)});
        std::ranges::stable_sort(minima, {}, &Minimum::deviation);
        return minima;
    }

private:
    static constexpr int rows = 11, columns = 13;
    [[nodiscard]] ResinPoint point(int i, int k) const {
        return {first_.v + i * step_.v, first_.ln_sigma_t + k * step_.ln_sigma_t};
    }
    [[nodiscard]] double value(int i, int k) const { return values_[static_cast<std::size_t>(i * columns + k)]; }
    [[nodiscard]] bool is_least(int i, int k) const {
        for (int y = std::max(i - 1, 0); y <= std::min(i + 1, rows - 1); ++y)
            for (int x = std::max(k - 1, 0); x <= std::min(k + 1, columns - 1); ++x)
                if (value(y, x) < value(i, k)) return false;
        return true;
    }

    ResinPoint first_, step_;
    std::vector<double> values_;
};

/// The least of nine points around the best so far, four times, each time half as far apart.
template <class Deviation>
ResinPoint zoom_in(Minimum best, const ResinPoint& step, const ResinBounds& bounds, Deviation deviation) {
    double v_half = step.v / 2, s_half = step.ln_sigma_t / 2;
    for (int zoom = 0; zoom < 4; ++zoom, v_half /= 2, s_half /= 2) {
        const ResinPoint middle = best.point;
        for (int i = -1; i <= 1; ++i)
            for (int k = -1; k <= 1; ++k) {
                const ResinPoint point = clamped({middle.v + i * v_half, middle.ln_sigma_t + k * s_half}, bounds);
                const double d = deviation(point);
                if (d < best.deviation) best = {d, point};
            }
    }
    return best.point;
}

}  // namespace

bool TargetRoles::is_base(std::size_t role) const { return contains(bases, role); }
bool TargetRoles::is_clear(std::size_t role) const { return contains(clear, role); }

TargetRoles find_target_roles(const PatchTable& table, std::span<const std::string> expected, double noise) {
    std::vector<std::string> bases, surfaces, all;
    for (const Patch& patch : table.patches) {
        std::vector<std::string>& lain_on = patch.on ? surfaces : bases;
        if (!patch.lit && !contains(lain_on, patch.backing)) lain_on.push_back(patch.backing);
        for (const ResinShare& share : patch.top)
            if (!contains(all, share.role)) all.push_back(share.role);
    }
    for (const std::string& base : bases)
        if (!contains(all, base)) all.push_back(base);
    if (all.size() < 2 && surfaces.empty())
        throw InputError(
            fmt::format("{}: all patches are of one resin, {}; a calibration needs two of contrasting albedo.",
                        table.source, fmt::join(all, "")));
    const bool by_thickness = bases.empty() && has_two_thicknesses(table);  // a surface is known
    if (bases.size() + surfaces.size() < 2 && !by_thickness)
        throw InputError(
            fmt::format("{}: all patches lie on {}{}; each resin must be seen on a light and on a dark base, or its "
                        "albedo and extinction cannot be told apart.",
                        table.source, fmt::join(bases, ""), fmt::join(surfaces, "")));
    for (const std::string& role : expected)
        if (!contains(all, role))
            throw InputError(fmt::format(
                "{}: resin {} has no patch; measured are {}. Measure its squares too, or leave it out of the list.",
                table.source, role, fmt::join(all, ", ")));
    if (contains(bases, clear_role))
        throw InputError(
            fmt::format("{}: patches lie on clear resin ({}); a base must be opaque.", table.source, clear_role));
    std::vector<std::pair<double, std::string>> by_light;
    for (const std::vector<std::string>& lain_on : {bases, surfaces})
        for (const std::string& base : lain_on) by_light.emplace_back(-lightness(table, base), base);
    std::ranges::stable_sort(by_light, {}, [](const auto& entry) { return entry.first; });
    const double lightest = -by_light.front().first, darkest = -by_light.back().first;
    const auto white = std::ranges::find(by_light, "W", [](const auto& e) { return e.second; });
    const auto black = std::ranges::find(by_light, "K", [](const auto& e) { return e.second; });
    if (white != by_light.end() && black != by_light.end() && white->first > black->first + noise)
        throw InputError(fmt::format(
            "{}: W on W reflects {:.4f} and K on K {:.4f}: black and white are swapped, in the target, in its "
            "description or in the photograph's orientation.",
            table.source, -white->first, -black->first));
    if (!by_thickness && !(lightest - darkest > 6 * noise))
        throw InputError(fmt::format(
            "{}: the bases have no contrast: {} reflects {:.4f} and {} {:.4f}, which must differ by {:.3f} at least. "
            "Print the squares on two resins that differ more.",
            table.source, by_light.front().second, lightest, by_light.back().second, darkest, 6 * noise));
    TargetRoles result;
    for (const auto& [light, base] : by_light) {
        if (contains(surfaces, base)) continue;
        result.bases.push_back(result.roles.size());
        result.roles.push_back(base);
    }
    for (const std::string& role : all) {
        if (contains(bases, role)) continue;
        if (role == clear_role) result.clear.push_back(result.roles.size());
        result.roles.push_back(role);
    }
    for (const std::string& base : bases) {
        const bool crossed = std::ranges::any_of(table.patches, [&](const Patch& p) {
            return !p.lit && p.backing != base &&
                   std::ranges::any_of(p.top, [&](const ResinShare& s) { return s.role == base; });
        });
        if (crossed) continue;
        throw InputError(fmt::format(
            "{}: patch {} on {} is missing; the extinction of a base is read from its square upon another base.",
            table.source, base, base == by_light.front().second ? by_light.back().second : by_light.front().second));
    }
    return result;
}

// One channel of a group of patches, and how far resins are from what was measured.
class Principles::Search {
public:
    Search(const Principles& all, const Group& group, std::size_t channel, std::vector<ResinPoint>& resins)
        : roles_(*all.roles_),
          group_(group),
          resins_(resins),
          g_(all.options_.g),
          channel_(channel),
          rho_(group.patches.size()) {
        for (const Patch& patch : group.patches) {
            measured_.push_back(patch.rho[channel]);
            weight_.push_back(1 / std::max(patch.error.empty() ? all.noise_ : patch.error[channel], principle_error));
        }
        media_.resize(resins.size());
    }
    /// Has to be called when a base has changed.
    void keep_bases() {
        refresh();
        bases_ = group_.model->bases(media_, false, channel_);
    }
    [[nodiscard]] double deviation() {
        refresh();
        group_.model->evaluate(media_, bases_, rho_);
        double sum = 0;
        for (std::size_t p = 0; p < rho_.size(); ++p) sum += weight_[p] * std::abs(rho_[p] - measured_[p]);
        return sum;
    }
    [[nodiscard]] double predicted() {
        refresh();
        bases_ = group_.model->bases(media_, false, channel_);
        group_.model->evaluate(media_, bases_, rho_);
        return std::accumulate(rho_.begin(), rho_.end(), 0.0) / static_cast<double>(rho_.size());
    }
    [[nodiscard]] double measured() const {
        return std::accumulate(measured_.begin(), measured_.end(), 0.0) / static_cast<double>(measured_.size());
    }
    [[nodiscard]] bool empty() const { return measured_.empty(); }

private:
    void refresh() {
        for (std::size_t r = 0; r < resins_.size(); ++r)
            media_[r] = roles_.is_clear(r) ? Medium{} : medium_of(resins_[r], g_);
    }
    const TargetRoles& roles_;
    const Group& group_;
    std::vector<ResinPoint>& resins_;
    double g_;
    std::size_t channel_;
    std::vector<double> measured_, weight_, rho_;
    std::vector<Medium> media_;
    PatchModel::Bases bases_;
};

Principles::Group Principles::group(const std::vector<std::size_t>& patches) const {
    Group result;
    for (const std::size_t p : patches) {
        result.patches.push_back(table_->patches[p]);
        result.patches.back().base_mm = 0;  // Sec. 3.2: as if the base had no end
    }
    result.model = std::make_unique<PatchModel>(result.patches, roles_->roles, options_, plan_);
    return result;
}

Principles::Principles(const PatchTable& table, const TargetRoles& roles, const PatchModelOptions& options,
                       double noise)
    : table_(&table),
      roles_(&roles),
      options_(options),
      noise_(noise),
      plan_(std::make_shared<const optics::OrdinatePlan>(optics::directional_plan(options.g, options.eta, 4, 4))),
      bounds_(resin_bounds(options.g)) {
    std::vector<std::size_t> mixed;
    for (std::size_t r = 0; r < roles.roles.size(); ++r) {
        const std::string& role = roles.roles[r];
        std::vector<std::size_t> self, cross, rest;
        for (std::size_t p = 0; p < table.patches.size(); ++p) {
            const Patch& patch = table.patches[p];
            if (patch.lit) continue;
            if (is_pure(patch, role)) (patch.backing == role ? self : cross).push_back(p);
            // Of a resin that is no base: all patches in which only bases and clear resin stand beside it.
            bool has_it = false, known = true;
            for (const ResinShare& share : patch.top) {
                const auto other =
                    static_cast<std::size_t>(std::ranges::find(roles.roles, share.role) - roles.roles.begin());
                has_it = has_it || other == r;
                known = known && (other == r || roles.is_base(other) || roles.is_clear(other));
            }
            if (has_it && known) rest.push_back(p);
        }
        self_.push_back(group(self));
        cross_.push_back(group(cross));
        rest_.push_back(group(rest));
    }
    for (std::size_t p = 0; p < table.patches.size(); ++p) {
        const Patch& patch = table.patches[p];
        const bool of_bases = std::ranges::all_of(patch.top, [&](const ResinShare& share) {
            return roles.is_base(
                static_cast<std::size_t>(std::ranges::find(roles.roles, share.role) - roles.roles.begin()));
        });
        if (of_bases && !patch.lit && !(patch.top.size() == 1 && patch.top.front().role == patch.backing))
            mixed.push_back(p);
    }
    mixed_bases_ = group(mixed);
}

ChannelStart Principles::start(std::size_t channel) const {
    const std::size_t count = roles_->roles.size();
    ChannelStart start{Resins(count, ResinPoint{0.5, std::log(5.0)}), std::vector<Resins>(count)};
    find_base_albedos(channel, start.resins);
    find_base_extinctions(channel, start.resins);
    refine_base_extinctions(channel, start.resins);
    for (std::size_t role = 0; role < count; ++role)
        if (!roles_->is_base(role) && !roles_->is_clear(role))
            start.alternatives[role] = find_resin(role, channel, start.resins);
    return start;
}

/// Principle 1, by bisection: rho falls monotonically with v.
void Principles::find_base_albedos(std::size_t channel, Resins& at) const {
    for (const std::size_t base : roles_->bases) {
        Search search(*this, self_[base], channel, at);
        double light = bounds_.least_v, dark = bounds_.most_v;
        for (int step = 0; step < 24; ++step) {
            at[base].v = 0.5 * (light + dark);
            (search.predicted() > search.measured() ? light : dark) = at[base].v;
        }
    }
}

/// Principle 2, each base by its square upon another.
void Principles::find_base_extinctions(std::size_t channel, Resins& at) const {
    const LogExtinctions range(bounds_);
    for (const std::size_t base : roles_->bases) {
        Search search(*this, cross_[base], channel, at);
        if (search.empty()) continue;
        search.keep_bases();
        search_line(search, at[base].ln_sigma_t, range, range, 20, 2);
    }
}

/// Principle 2, all bases by every mixture of them; dark ones first: pure squares say least of them.
void Principles::refine_base_extinctions(std::size_t channel, Resins& at) const {
    Search search(*this, mixed_bases_, channel, at);
    if (search.empty()) return;
    search.keep_bases();
    const LogExtinctions range(bounds_);
    for (int round = 0; round < 3; ++round)
        for (auto base = roles_->bases.rbegin(); base != roles_->bases.rend(); ++base) {
            double& value = at[*base].ln_sigma_t;
            if (round == 0)
                search_line(search, value, range, range, 20, 1);
            else
                search_line(search, value, range.around(value, 0.4), range, 8, 1);
        }
}

/// Principle 3: all local minima on a coarse grid, the deepest of them then on finer and finer ones.
Principles::Resins Principles::find_resin(std::size_t role, std::size_t channel, Resins& at) const {
    Search search(*this, rest_[role], channel, at);
    if (search.empty()) return {};
    search.keep_bases();
    const auto deviation = [&](const ResinPoint& point) {
        at[role] = point;
        return search.deviation();
    };
    const DeviationGrid grid(bounds_, deviation);
    const std::vector<Minimum> minima = grid.local_minima();
    at[role] = zoom_in(minima.front(), grid.step(), bounds_, deviation);
    Resins others;
    for (std::size_t m = 1; m < minima.size() && m < most_minima; ++m) others.push_back(minima[m].point);
    return others;
}

}  // namespace voxtone::calibration
