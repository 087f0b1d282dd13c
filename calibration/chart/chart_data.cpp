// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/chart/chart_data.h"

#include <algorithm>
#include <map>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "calibration/patches/patch_mixture.h"
#include "calibration/patches/table_observer.h"
#include "optics/layered/flat_colour.h"

namespace voxtone::calibration {

namespace {

bool is_thin(const Patch& patch) { return patch.thickness_mm > 0; }

std::vector<std::string> told_roles_of(const PatchTable& table) {
    std::set<std::string> roles;
    for (const Patch& patch : table.patches) {
        if (is_thin(patch) && !table.is_of_laminates()) continue;
        for (const ResinShare& share : patch.top) roles.insert(share.role);
        for (const PatchLayer& layer : patch.under) roles.insert(layer.role);
    }
    return {roles.begin(), roles.end()};
}

Eigen::Vector3d xyz_of(const Patch& patch, const TableObserver& observer) {
    return observer.weights *
           Eigen::Map<const Eigen::VectorXd>(patch.rho.data(), static_cast<Eigen::Index>(patch.rho.size()));
}

Eigen::Matrix3d root_metric(const Eigen::Vector3d& roots) {
    return optics::ciede2000_metric(lab_of_roots() * roots - Eigen::Vector3d(16, 0, 0)) * lab_of_roots();
}

void add_squares(const PatchTable& table, bool own_instrument, ChartData& data) {
    const TableObserver observer = table_observer(table.channels, optics::Illuminant::d50);
    for (const Patch& patch : table.patches) {
        if (!is_thin(patch)) {
            if (!own_instrument) continue;
            throw InputError(
                fmt::format("{}: patch {} is thick; squares that are to tell lengths have a thickness_mm "
                            "that light gets through.",
                            patch.where, mixture_text(patch.top)));
        }
        if (patch.on)
            throw InputError(fmt::format(
                "{}: the square {} lies on {}, a surface, which tells no chart's lengths; give squares upon a resin of "
                "the chart.",
                patch.where, mixture_text(patch.top), patch.backing));
        PatchMixture held = patch.top;
        if (!patch.is_laminate()) held.push_back({patch.backing, 1});
        for (const PatchLayer& layer : patch.under) held.push_back({layer.role, 1});
        for (const ResinShare& share : held)
            if (std::ranges::find(data.roles, share.role) == data.roles.end())
                throw InputError(
                    fmt::format("{}: the square {} upon {} holds the resin {}, which no thick mixture of the chart "
                                "does; measure a mixture of it too, or leave the square out.",
                                patch.where, mixture_text(patch.top),
                                patch.is_laminate() ? "other layers" : patch.backing, share.role));
        const Eigen::Vector3d xyz = optics::adapt_white(xyz_of(patch, observer), observer.white, data.white);
        const Eigen::Index row = data.squares.roots.rows();
        data.squares.roots.conservativeResize(row + 1, 3);
        data.squares.roots.row(row) = optics::lab_roots(xyz, data.white).transpose();
        data.squares.metric.push_back(root_metric(data.squares.roots.row(row).transpose()));
        data.squares.patches.push_back(patch);
        data.squares.own_instrument.push_back(own_instrument);
    }
}

// Means of repeats, by the mixture that each thick patch of the table is.
void add_spectra(const PatchTable& table, const TableObserver& observer, const std::vector<Eigen::Index>& mixture_of,
                 ChartData& data) {
    data.nm = table.channels.wavelengths_nm;
    data.observer = (observer.white.cwiseInverse().asDiagonal() * observer.weights).transpose();
    data.spectra = Eigen::MatrixXd::Zero(data.mixtures(), data.observer.rows());
    std::size_t thick = 0;
    for (const Patch& patch : table.patches) {
        if (is_thin(patch)) continue;
        const Eigen::Index row = mixture_of[thick++];
        data.spectra.row(row) +=
            Eigen::Map<const Eigen::RowVectorXd>(patch.rho.data(), data.spectra.cols()) / data.repeats[row];
    }
}

}  // namespace

Eigen::Matrix3d lab_of_roots() {
    Eigen::Matrix3d map;
    map << 0, 116, 0, 500, -500, 0, 0, 200, -200;
    return map;
}

ChartData chart_data(const PatchTable& table, const PatchTable& squares, const ResinPrior& edges) {
    ChartData data;
    data.roles = told_roles_of(table);
    const TableObserver observer = table_observer(table.channels, optics::Illuminant::d50);
    data.illuminant = observer.illuminant, data.white = observer.white;
    std::map<std::string, std::size_t> rows;
    std::vector<Eigen::Vector3d> sums;
    std::vector<Eigen::Vector3d> measured;
    std::vector<Eigen::Index> row_of;
    std::vector<const Patch*> first;
    for (const Patch& patch : table.patches) {
        if (is_thin(patch)) continue;
        const auto [entry, is_new] = rows.try_emplace(mixture_text(patch.top), sums.size());
        measured.push_back(optics::lab_roots(xyz_of(patch, observer), data.white));
        if (is_new) {
            sums.emplace_back(Eigen::Vector3d::Zero());
            first.push_back(&patch);
        }
        sums[entry->second] += measured.back();
        row_of.push_back(static_cast<Eigen::Index>(entry->second));
    }
    const auto mixtures = static_cast<Eigen::Index>(sums.size()), resins = static_cast<Eigen::Index>(data.roles.size());
    if (mixtures == 0 && !table.is_of_laminates())
        throw InputError(fmt::format(
            "{}: all patches are thin squares upon a base; a chart tells its colours by thick mixtures. Add "
            "some, or write the squares as a target: top,backing,thickness_mm,R,G,B.",
            table.source));
    if (mixtures == 1)
        throw InputError(
            fmt::format("{}: one mixture alone tells nothing of its resins; measure a chart of them.", table.source));
    data.repeats = Eigen::VectorXd::Zero(mixtures);
    for (const Eigen::Index row : row_of) data.repeats[row] += 1;
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
        data.metric.push_back(root_metric(data.roots.row(i).transpose()));
    }
    if (!table.channels.is_own() && !table.channels.is_rgb()) add_spectra(table, observer, row_of, data);
    std::vector<double> apart;
    for (std::size_t p = 0; p < measured.size(); ++p) {
        const Eigen::Index row = row_of[p];
        if (data.repeats[row] < 2) continue;
        const Eigen::Vector3d lab = lab_of_roots() * measured[p] - Eigen::Vector3d(16, 0, 0);
        apart.push_back(optics::ciede2000(lab, data.lab.row(row).transpose()));
    }
    data.noise = optics::summarize(apart);
    add_squares(table, false, data);
    add_squares(squares, true, data);
    data.edges = edge_values(edges, data.roles);
    if (!edges.resins.empty() && data.edges.empty())
        throw InputError(
            fmt::format("{}: its edges know of no resin of {}, which holds {}; they would tell no lengths.",
                        edges.source, table.source, fmt::join(data.roles, ", ")));
    return data;
}

ThinSquares square_rows(const ThinSquares& squares, const std::vector<Eigen::Index>& keep) {
    ThinSquares part;
    part.roots = squares.roots(keep, Eigen::all);
    for (const Eigen::Index row : keep) {
        const auto i = static_cast<std::size_t>(row);
        part.patches.push_back(squares.patches[i]);
        part.own_instrument.push_back(squares.own_instrument[i]);
        part.metric.push_back(squares.metric[i]);
    }
    return part;
}

ChartData chart_rows(const ChartData& data, const std::vector<Eigen::Index>& keep) {
    ChartData part;
    part.roles = data.roles, part.illuminant = data.illuminant, part.white = data.white;
    part.squares = data.squares, part.edges = data.edges;
    part.observer = data.observer, part.nm = data.nm;
    if (data.spectra.size() > 0) part.spectra = data.spectra(keep, Eigen::all);
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
