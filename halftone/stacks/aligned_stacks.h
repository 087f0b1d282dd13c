// SPDX-License-Identifier: GPL-3.0-or-later
//
// Stacks of layers brought to one common sequence of materials, so that the layers of neighbouring places belong
// together and their thicknesses can be interpolated. Based on: M. Hasan, M. Fuchs, W. Matusik, H. Pfister, S.
// Rusinkiewicz, "Physical reproduction of materials with specified subsurface scattering", SIGGRAPH 2010, Sec. 7.1.
//
// The sequence is periodic ("white-support-black" in the paper): every stack is a part of it once it is long enough,
// its layers each put to the first place left that has their material. Layers that a stack does not have are there with
// thickness zero; layers that no stack has are left out. The order of the materials within the period is the one that
// leaves fewest layers, found by trying all; of several the first in lexicographic order.
//
// Exact: a stack's layers of thickness above zero are those that came in, to the bit. Fewer layers than these are
// possible (a shortest common supersequence need not be periodic) and not looked for.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "halftone/separation/mixture.h"
#include "halftone/stacks/stack_options.h"

namespace voxtone::halftone {

struct AlignedStacks {
    std::vector<std::size_t> material;  ///< of each layer, from the top
    std::vector<double> thickness_mm;   ///< stack by stack, as many as there are layers; >= 0

    [[nodiscard]] std::size_t layers() const { return material.size(); }
    [[nodiscard]] std::span<const double> thicknesses(std::size_t stack) const {
        return std::span(thickness_mm).subspan(stack * layers(), layers());
    }
};

/// Contract: neighbouring layers of a stack differ in material, thicknesses are above 0, and there are at most
/// max_resins materials in all. Time: max_resins! times the different sequences of materials, at worst.
[[nodiscard]] AlignedStacks align_stacks(std::span<const std::vector<StackLayer>> stacks);

}  // namespace voxtone::halftone
