// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/media/resins.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "base/contracts.h"
#include "base/error.h"

namespace voxtone::optics {

namespace {

std::string roles_of(const ResinSet& set) {
    std::string roles;
    for (const Resin& resin : set.resins) roles += (roles.empty() ? "" : ", ") + resin.role;
    return roles;
}

bool same_letters(std::string_view a, std::string_view b) {
    const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; };
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [&](char x, char y) { return lower(x) == lower(y); });
}

void validate_measured(const ResinSet& set) {
    if (!(set.dot_spread >= 0 && set.dot_spread <= 1))
        throw InputError(fmt::format(
            "Resin set \"{}\": dot_spread is {}; it must lie between 0 (sharp voxels) and 1 (an ideal mixture).",
            set.name, set.dot_spread));
    const FlatMeasurement& measured = set.measured;
    if (!(measured.surface >= 0 && measured.surface < 1))
        throw InputError(
            fmt::format("Resin set \"{}\": the surface's reflection is {}; a share of light must lie in [0, 1).",
                        set.name, measured.surface));
    if (!(measured.gain >= 0.1 && measured.gain <= 10))
        throw InputError(fmt::format("Resin set \"{}\": the instrument's gain is {}; expected 0.1 to 10, 1 as a rule.",
                                     set.name, measured.gain));
    if (!set.residual.empty() && set.residual.lengths().size() != set.resins.size())
        throw InputError(fmt::format("Resin set \"{}\": its residual is of {} resins, but the set has {}.", set.name,
                                     set.residual.lengths().size(), set.resins.size()));
}

void validate_resin(const ResinSet& set, const Resin& resin) {
    const std::size_t channels = set.channels.size();
    if (resin.role.empty()) {
        throw InputError(fmt::format(
            "Resin \"{}\" of set \"{}\" has no role; give it a short unique word such as C, M, Y, K, W or T.",
            resin.name, set.name));
    }
    const auto check_count = [&](const char* key, std::size_t count) {
        if (count == channels) return;
        throw InputError(fmt::format(
            "Resin {} of set \"{}\": {} has {} values, but the set has {} channels; give one value per channel.",
            resin.role, set.name, key, count, channels));
    };
    check_count("sigma_t_per_mm", resin.sigma_t_per_mm.size());
    check_count("albedo", resin.albedo.size());
    if (resin.eta && !(*resin.eta >= 1 && std::isfinite(*resin.eta)))
        throw InputError(
            fmt::format("Resin {} of set \"{}\": eta is {}; the refractive index must be at least 1 (resins have about "
                        "1.5), or leave it out to take the set's.",
                        resin.role, set.name, *resin.eta));
    if (resin.g && !(*resin.g > -1 && *resin.g < 1))
        throw InputError(
            fmt::format("Resin {} of set \"{}\": g is {}; the mean cosine of the scattering angle must lie between -1 "
                        "and 1, both excluded, or leave it out to take the set's.",
                        resin.role, set.name, *resin.g));
    VOXTONE_EXPECT(std::abs(resin.similarity * (1 - set.g) - (1 - set.g_of(resin))) < 1e-12);
    for (std::size_t c = 0; c < channels; ++c) {
        const double sigma_t = resin.sigma_t_per_mm[c], albedo = resin.albedo[c];
        if (!(sigma_t >= 0 && std::isfinite(sigma_t))) {
            throw InputError(fmt::format(
                "Resin {} of set \"{}\": sigma_t_per_mm in channel {} is {}; it must be at least 0 and finite.",
                resin.role, set.name, channel_name(set.channels, c), sigma_t));
        }
        if (!(albedo >= 0 && albedo <= 1)) {
            throw InputError(
                fmt::format("Resin {} of set \"{}\": albedo in channel {} is {}; the share of light that survives a "
                            "scattering event must lie between 0 and 1.",
                            resin.role, set.name, channel_name(set.channels, c), albedo));
        }
    }
}

}  // namespace

Medium Resin::own_medium(std::size_t channel) const {
    VOXTONE_EXPECT(channel < sigma_t_per_mm.size() && channel < albedo.size());
    const double sigma_s = sigma_t_per_mm[channel] * albedo[channel];
    return {sigma_t_per_mm[channel] - sigma_s, sigma_s};
}

Medium Resin::medium(std::size_t channel) const {
    Medium medium = own_medium(channel);
    medium.sigma_s *= similarity;
    return medium;
}

bool ResinSet::has_own_eta() const {
    return std::any_of(resins.begin(), resins.end(), [&](const Resin& resin) { return eta_of(resin) != eta; });
}

bool ResinSet::has_own_g() const {
    return std::any_of(resins.begin(), resins.end(), [&](const Resin& resin) { return g_of(resin) != g; });
}

void ResinSet::relate() {
    for (Resin& resin : resins) resin.similarity = g_of(resin) == g ? 1 : (1 - g_of(resin)) / (1 - g);
}

/// Users write roles in capitals or not: one that differs in them alone is meant, if it is one.
int ResinSet::find(std::string_view role) const {
    int like = -1;
    for (std::size_t r = 0; r < resins.size(); ++r) {
        if (resins[r].role == role) return static_cast<int>(r);
        if (same_letters(resins[r].role, role)) like = like == -1 ? static_cast<int>(r) : -2;
    }
    return std::max(like, -1);
}

ResinSet ResinSet::subset(std::span<const std::string> roles) const {
    ResinSet chosen = *this;
    chosen.resins.clear();
    std::vector<std::size_t> indices;
    for (const std::string& role : roles) {
        const int index = find(role);
        if (index < 0) {
            throw InputError(
                fmt::format("Resin set \"{}\" has no resin with role \"{}\"; it has {}.", name, role, roles_of(*this)));
        }
        const std::string& found = resins[static_cast<std::size_t>(index)].role;
        const auto is_found = [&](const Resin& resin) { return resin.role == found; };
        if (std::any_of(chosen.resins.begin(), chosen.resins.end(), is_found)) {
            throw InputError(fmt::format("Resin \"{}\" is asked for twice; name each resin once.", role));
        }
        chosen.resins.push_back(resins[static_cast<std::size_t>(index)]);
        indices.push_back(static_cast<std::size_t>(index));
    }
    chosen.residual = residual.subset(indices);
    return chosen;
}

Medium ResinSet::mix(std::span<const double> fractions, std::size_t channel) const {
    VOXTONE_EXPECT(fractions.size() == resins.size());
    Medium mixture;
    for (std::size_t r = 0; r < resins.size(); ++r) {
        const Medium medium = resins[r].medium(channel);
        mixture.sigma_a += fractions[r] * medium.sigma_a;
        mixture.sigma_s += fractions[r] * medium.sigma_s;
    }
    return mixture;
}

void ResinSet::validate() const {
    if (resins.empty()) throw InputError(fmt::format("Resin set \"{}\" has no resins; list at least one.", name));
    if (!(g > -1 && g < 1)) {
        throw InputError(
            fmt::format("Resin set \"{}\": g is {}; the mean cosine of the scattering angle must lie between -1 and 1, "
                        "both excluded.",
                        name, g));
    }
    if (!(eta >= 1 && std::isfinite(eta))) {
        throw InputError(
            fmt::format("Resin set \"{}\": eta is {}; the refractive index must be at least 1 (resins have about 1.5).",
                        name, eta));
    }
    if (const auto fault = fault_of(channels)) throw InputError(fmt::format("Resin set \"{}\": {}.", name, *fault));
    validate_measured(*this);
    for (std::size_t r = 0; r < resins.size(); ++r) {
        validate_resin(*this, resins[r]);
        if (find(resins[r].role) != static_cast<int>(r)) {
            throw InputError(fmt::format(
                "Resin set \"{}\": role \"{}\" occurs twice (\"{}\" and \"{}\"); roles must be unique.", name,
                resins[r].role, resins[static_cast<std::size_t>(find(resins[r].role))].name, resins[r].name));
        }
    }
}

ResinSet vero_opaque() {
    ResinSet set;
    set.name = "vero-opaque";
    set.source =
        "Elek et al. 2017, Scattering-aware Texture Reproduction for 3D Printing, supplement, Table 1 (measured with g "
        "= 0.4)";
    set.resins = {
        {"VeroCyan", "C", {9.0, 4.5, 7.5}, {0.05, 0.70, 0.98}},
        {"VeroMagenta", "M", {2.5, 3.0, 10.0}, {0.98, 0.10, 0.90}},
        {"VeroYellow", "Y", {2.25, 3.75, 19.0}, {0.997, 0.995, 0.15}},
        {"VeroBlack", "K", {5.0, 5.5, 6.5}, {0.35, 0.35, 0.35}},
        {"VeroWhite", "W", {6.0, 9.0, 24.0}, {0.9991, 0.9997, 0.9990}},
    };
    return set;
}

}  // namespace voxtone::optics
