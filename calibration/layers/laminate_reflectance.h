// SPDX-License-Identifier: GPL-3.0-or-later
//
// rho(45 -> 0) of many laminates, one channel at a time, by the modes of their layers (optics/layered). Laminates
// with the same lower layers share them; where one resin changes, only what lies upon it is made again.
//
// Units mm, mm^-1. Error with the eight directions used: 1e-3 of rho (tested against sixteen). What it cannot see: the
// sides of a patch, rough surfaces, layers that have run into each other.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "calibration/layers/layer_chart.h"
#include "optics/layered/layer_modes.h"

namespace voxtone::calibration {

class LaminateReflectance {
public:
    LaminateReflectance(std::span<const LayerLaminate> laminates, double g, double eta, int directions = 3);

    /// The laws of all layers upon layers for one set of media.
    struct Laws {
        std::vector<optics::Medium> media;
        std::vector<optics::LayerModes> modes;
        std::vector<optics::Admittance> of_node;
    };
    [[nodiscard]] Laws laws(std::vector<optics::Medium> media) const;
    /// One a laminate.
    [[nodiscard]] std::vector<double> rho(const Laws& laws) const;
    /// The same with another medium for one resin.
    [[nodiscard]] std::vector<double> rho(const Laws& laws, std::size_t resin, const optics::Medium& medium) const;

private:
    struct Node {
        std::size_t below;  ///< another node, which stands before this one; `nothing` for a base
        ChartLayer layer;
        std::uint64_t holds;  ///< bit r: it or what is below it is of resin r
    };
    [[nodiscard]] double seen(const optics::Admittance& top) const;

    optics::OrdinatePlan plan_;
    optics::Admittance dark_;
    std::vector<Node> nodes_;
    std::vector<std::size_t> top_;  ///< node of each laminate's first layer
};

}  // namespace voxtone::calibration
