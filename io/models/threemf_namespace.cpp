// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/models/threemf_namespace.h"

namespace voxtone::io {

ThreemfNamespace threemf_namespace(std::string_view uri) {
    struct Known {
        std::string_view prefix, about;
        ThreemfNamespace space;
    };
    static constexpr Known known[]{{"", "3dmanufacturing/core/", ThreemfNamespace::core},
                                   {"m", "3dmanufacturing/material/", ThreemfNamespace::materials},
                                   {"p", "3dmanufacturing/production/", ThreemfNamespace::production},
                                   {"t", "3dmanufacturing/trianglesets/", ThreemfNamespace::triangle_sets},
                                   {"b", "3dmanufacturing/beamlattice/", ThreemfNamespace::beam_lattice}};
    for (const auto& [prefix, about, space] : known)
        if ((!prefix.empty() && uri == prefix) || uri.find(about) != uri.npos) return space;
    return ThreemfNamespace::other;
}

}  // namespace voxtone::io
