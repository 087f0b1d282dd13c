// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/calibration/chart/chart_data.h"

#include <algorithm>
#include <map>
#include <set>

#include <fmt/format.h>

#include "voxtone/base/error.h"
#include "voxtone/calibration/patches/patch_mixture.h"
#include "voxtone/optics/layered/flat_colour.h"

namespace voxtone::calibration {

namespace {

using optics::Channels;
using optics::Illuminant;

// XYZ of a table's values under the illuminant that its colours are told in: spectra under D50, as charts are.
struct TableObserver {
    Illuminant illuminant;
    Eigen::Vector3d white;
    Eigen::Matrix3Xd weights;
};

TableObserver observer_of(const Channels& channels) {
    if (channels.is_own()) {
        TableObserver own{channels.illuminant, optics::colorimetric_white(channels.illuminant), {}};
        own.weights.resize(3, static_cast<Eigen::Index>(channels.size()));
        for (std::size_t c = 0; c < channels.size(); ++c)
            own.weights.col(static_cast<Eigen::Index>(c)) = Eigen::Map<const Eigen::Vector3d>(channels.xyz[c].data());
        return own;
    }
    if (channels.is_rgb()) return {Illuminant::d65, optics::d65_white(), optics::xyz_from_linear_srgb_matrix()};
    TableObserver spectral{Illuminant::d50, optics::d50_white(),
                           optics::xyz_weights(channels.wavelengths_nm, Illuminant::d50)};
    const Eigen::Vector3d summed = spectral.weights.rowwise().sum();
    for (Eigen::Index k = 0; k < 3; ++k) spectral.weights.row(k) *= spectral.white[k] / summed[k];
    return spectral;
}

std::vector<std::string> roles_of(const PatchTable& table) {
    std::set<std::string> roles;
    for (const Patch& patch : table.patches)
        for (const ResinShare& share : patch.top) roles.insert(share.role);
    return {roles.begin(), roles.end()};
}

void expect_thick(const Patch& patch) {
    if (patch.thickness_mm == 0 && patch.backing.empty()) return;
    throw InputError(
        fmt::format("{}: patch {} is {} mm thick upon {}, but a chart of mixtures is fitted as thick, where nothing "
                    "shines through; "
                    "leave thickness_mm and backing out if its patches hide what is under them.",
                    patch.where, mixture_text(patch.top), patch.thickness_mm, patch.backing));
}

}  // namespace

Eigen::Matrix3d lab_of_roots() {
    Eigen::Matrix3d map;
    map << 0, 116, 0, 500, -500, 0, 0, 200, -200;
    return map;
}

ChartData chart_data(const PatchTable& table) {
    ChartData data;
    data.roles = roles_of(table);
    const TableObserver observer = observer_of(table.channels);
    data.illuminant = observer.illuminant, data.white = observer.white;
    std::map<std::string, std::size_t> rows;
    std::vector<Eigen::Vector3d> sums;
    std::vector<Eigen::Vector3d> measured;
    std::vector<const Patch*> first;
    for (const Patch& patch : table.patches) {
        expect_thick(patch);
        const auto [entry, is_new] = rows.try_emplace(mixture_text(patch.top), sums.size());
        const Eigen::Vector3d xyz =
            observer.weights *
            Eigen::Map<const Eigen::VectorXd>(patch.rho.data(), static_cast<Eigen::Index>(patch.rho.size()));
        measured.push_back(optics::lab_roots(xyz, data.white));
        if (is_new) {
            sums.emplace_back(Eigen::Vector3d::Zero());
            first.push_back(&patch);
        }
        sums[entry->second] += measured.back();
        data.row_of.push_back(entry->second);
    }
    const auto mixtures = static_cast<Eigen::Index>(sums.size()), resins = static_cast<Eigen::Index>(data.roles.size());
    if (mixtures < 2)
        throw InputError(
            fmt::format("{}: one mixture alone tells nothing of its resins; measure a chart of them.", table.source));
    data.repeats = Eigen::VectorXd::Zero(mixtures);
    for (const std::size_t row : data.row_of) data.repeats[static_cast<Eigen::Index>(row)] += 1;
    data.shares = Eigen::MatrixXd::Zero(mixtures, resins);
    data.roots.resize(mixtures, 3), data.lab.resize(mixtures, 3);
    for (Eigen::Index i = 0; i < mixtures; ++i) {
        const auto k = static_cast<std::size_t>(i);
        for (const ResinShare& share : first[k]->top)
            data.shares(i, std::ranges::find(data.roles, share.role) - data.roles.begin()) = share.fraction;
        data.names.push_back(mixture_text(first[k]->top));
        data.roots.row(i) = (sums[k] / data.repeats[i]).transpose();
        const Eigen::Vector3d lab = lab_of_roots() * data.roots.row(i).transpose() - Eigen::Vector3d(16, 0, 0);
        data.lab.row(i) = lab.transpose();
        data.metric.push_back(optics::ciede2000_metric(lab) * lab_of_roots());
    }
    std::vector<double> apart;
    for (std::size_t p = 0; p < measured.size(); ++p) {
        const auto row = static_cast<Eigen::Index>(data.row_of[p]);
        if (data.repeats[row] < 2) continue;
        const Eigen::Vector3d lab = lab_of_roots() * measured[p] - Eigen::Vector3d(16, 0, 0);
        apart.push_back(optics::ciede2000(lab, data.lab.row(row).transpose()));
    }
    data.noise = optics::summarize(apart);
    return data;
}

ChartData chart_rows(const ChartData& data, const std::vector<Eigen::Index>& keep) {
    ChartData part;
    part.roles = data.roles, part.illuminant = data.illuminant, part.white = data.white;
    part.shares = data.shares(keep, Eigen::all);
    part.roots = data.roots(keep, Eigen::all);
    part.lab = data.lab(keep, Eigen::all);
    part.repeats = data.repeats(keep);
    for (const Eigen::Index i : keep) {
        part.metric.push_back(data.metric[static_cast<std::size_t>(i)]);
        part.names.push_back(data.names[static_cast<std::size_t>(i)]);
    }
    return part;
}

}  // namespace voxtone::calibration
