// SPDX-License-Identifier: GPL-3.0-or-later
//
// The laminates that layered profiles are judged by: Vero Opaque (g = 0.4, index-matched layers), green channel, but
// where it is said.
#pragma once

#include <string>
#include <vector>

#include "optics/profiles/resin_profile.h"

namespace voxtone::optics::profile_laminates {

struct LaminateLayer {
    std::string role;
    double thickness_mm;
};

struct Laminate {
    std::vector<LaminateLayer> layers;  ///< top first
    std::size_t channel = 1;
};

/// Two to five layers of 0.1 to 1 mm: what a search gives. `films` are of single printed layers of 27 um.
[[nodiscard]] inline std::vector<Laminate> thick_laminates() {
    return {
        {{{"W", 0.3}, {"K", 0.1}}},
        {{{"W", 0.5}, {"M", 0.2}}},
        {{{"W", 0.25}, {"W", 0.25}}},
        {{{"W", 0.2}, {"K", 0.1}, {"W", 0.4}}},
        {{{"Y", 0.2}, {"W", 0.5}}},
        {{{"C", 0.1}, {"W", 0.4}}},
        {{{"M", 0.1}, {"Y", 0.2}, {"W", 0.5}}},
        {{{"W", 0.1}, {"M", 0.1}, {"W", 0.1}, {"C", 0.1}, {"W", 0.3}}},
        {{{"W", 1.0}, {"K", 0.5}}},
        {{{"W", 1.0}, {"Y", 1.0}, {"W", 1.0}}},
        {{{"Y", 0.5}, {"K", 0.2}}},
        {{{"Y", 0.4}, {"W", 0.2}, {"Y", 0.4}, {"K", 0.1}}},
        {{{"W", 0.3}, {"C", 0.1}, {"W", 0.3}}, 0},
        {{{"M", 0.3}, {"W", 0.3}}, 2},
    };
}

[[nodiscard]] inline std::vector<Laminate> film_laminates() {
    return {
        {{{"W", 0.027}, {"M", 0.027}, {"W", 0.027}, {"C", 0.027}}},
        {{{"K", 0.027}, {"W", 0.5}}},
        {{{"W", 0.054}, {"Y", 0.054}, {"W", 0.054}, {"Y", 0.054}, {"W", 0.054}, {"Y", 0.054}}},
    };
}

[[nodiscard]] inline LayerScene scene_of(const Laminate& laminate, double g = 0.4, double eta = 1) {
    const ResinSet set = vero_opaque();
    LayerScene scene{{}, g, eta, eta};
    for (const LaminateLayer& layer : laminate.layers) {
        const auto resin = static_cast<std::size_t>(set.find(layer.role));
        scene.layers.push_back({set.resins[resin].medium(laminate.channel), layer.thickness_mm});
    }
    return scene;
}

[[nodiscard]] inline std::string name_of(const Laminate& laminate) {
    std::string name;
    for (const LaminateLayer& layer : laminate.layers) {
        if (!name.empty()) name += " / ";
        std::string mm = std::to_string(layer.thickness_mm);
        mm.erase(mm.find_last_not_of('0') + 1);
        if (mm.back() == '.') mm += '0';
        name += layer.role;
        name.append(1, ' ').append(mm);
    }
    constexpr const char* channels[3] = {", red", "", ", blue"};
    return name + channels[laminate.channel];
}

}  // namespace voxtone::optics::profile_laminates
