// SPDX-License-Identifier: GPL-3.0-or-later
//
// Whose an element of a 3MF part is: the core's, an extension's that is understood here, or somebody else's.
// Based on: 3MF Consortium, "3D Manufacturing Format, Core Specification" 1.3.0, 2.3.2: what is of a namespace that is
// not understood is passed over, unless the part requires it.
#pragma once

#include <cstdint>
#include <string_view>

namespace voxtone::io {

enum class ThreemfNamespace : std::uint8_t {
    core,
    materials,
    production,
    triangle_sets,
    beam_lattice,  ///< known, so that its loss can be said
    other
};

/// By what a namespace is about, of whichever year: "http://schemas.microsoft.com/3dmanufacturing/material/2015/02".
/// Where a file declares a prefix nowhere, that stands for its namespace, and means what it does in the specifications.
[[nodiscard]] ThreemfNamespace threemf_namespace(std::string_view uri);

/// Whether what an extension says is understood.
[[nodiscard]] constexpr bool is_understood(ThreemfNamespace space) {
    return space != ThreemfNamespace::beam_lattice && space != ThreemfNamespace::other;
}

}  // namespace voxtone::io
