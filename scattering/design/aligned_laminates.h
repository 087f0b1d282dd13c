// SPDX-License-Identifier: GPL-3.0-or-later
//
// Laminates brought to one common sequence of materials, so that the layers of neighbouring places belong
// together and their thicknesses can be interpolated. Based on: M. Hasan, M. Fuchs, W. Matusik, H. Pfister, S.
// Rusinkiewicz, "Physical reproduction of materials with specified subsurface scattering", SIGGRAPH 2010, Sec. 7.1.
//
// The sequence is periodic ("white-support-black" in the paper): every laminate is a part of it once it is long enough,
// its layers each put to the first place left that has their material. Layers that a laminate does not have are there
// with thickness zero; layers that no laminate has are left out. The order of the materials within the period is the
// one that leaves fewest layers, found by trying all; of several the first in lexicographic order.
//
// Exact: a laminate's layers of thickness above zero are those that came in, to the bit. Fewer layers than these are
// possible (a shortest common supersequence need not be periodic) and not looked for.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "halftone/separation/mixture.h"
#include "scattering/design/laminate_options.h"

namespace voxtone::scattering {

struct AlignedLaminates {
    std::vector<std::size_t> material;  ///< of each layer, from the top
    std::vector<double> thickness_mm;   ///< laminate by laminate, as many as there are layers; >= 0

    [[nodiscard]] std::size_t layers() const { return material.size(); }
    [[nodiscard]] std::span<const double> thicknesses(std::size_t laminate) const {
        return std::span(thickness_mm).subspan(laminate * layers(), layers());
    }
};

/// Contract: neighbouring layers of a laminate differ in material, thicknesses are above 0, and there are at most
/// max_resins materials in all. Time: max_resins! times the different sequences of materials, at worst.
[[nodiscard]] AlignedLaminates align_laminates(std::span<const std::vector<LaminateLayer>> laminates);

}  // namespace voxtone::scattering
