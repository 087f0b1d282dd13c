// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/layers/layer_scan.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <map>

namespace voxtone::io {
namespace {

std::uint32_t word(const Rgba& c) {
    return std::uint32_t{c[0]} << 24 | std::uint32_t{c[1]} << 16 | std::uint32_t{c[2]} << 8 | c[3];
}

using Vector = std::array<double, 3>;
Vector minus(const auto& a, const auto& b) { return {double(a[0]) - b[0], double(a[1]) - b[1], double(a[2]) - b[2]}; }
double dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// Of the two colours whose blends come nearest to `c`, that which it has more of; a smoothed edge is such a blend, and
/// may be nearer to a third colour than to either of its own.
Material nearest_in(std::span<const Rgb> palette, const Rgba& c) {
    double least = std::numeric_limits<double>::infinity();
    std::size_t best = 0;
    for (std::size_t i = 0; i < palette.size(); ++i)
        for (std::size_t j = i; j < palette.size(); ++j) {
            const Vector along = minus(palette[j], palette[i]), to = minus(c, palette[i]);
            const double length = dot(along, along);
            const double share = length > 0 ? std::clamp(dot(to, along) / length, 0.0, 1.0) : 0;
            const double distance = dot(to, to) - share * (2 * dot(to, along) - share * length);
            if (distance >= least) continue;
            least = distance;
            best = share > 0.5 ? j : i;
        }
    return static_cast<Material>(best);
}

/// Of a colour that the palette does not have.
Material material_of_other(std::span<const Rgb> palette, const Rgba& c, const OtherPixels& others) {
    if (c[3] == 0) return others.transparent;
    if (!others.nearest || palette.empty()) return OtherPixels::unknown;
    return c[3] < 128 ? others.transparent : nearest_in(palette, c);
}

}  // namespace

LayerScan scan_layer(std::span<const std::uint8_t> file, const std::string& source, std::span<const Rgb> palette,
                     const OtherPixels& others) {
    LayerScan scan;
    const PngHeader claimed = read_png_header(file, source);
    if (!palette.empty()) scan.runs.emplace(claimed.width_px, claimed.height_px);
    std::map<std::uint32_t, std::size_t> place;  // colour -> index into scan.colours
    std::map<std::uint32_t, Material> material;
    for (std::size_t m = palette.size(); m-- > 0;)
        material[word({palette[m][0], palette[m][1], palette[m][2], 255})] = static_cast<Material>(m);

    // What is known of the colour of the run before: halftones change between few colours, so a small memory of them
    // pays.
    struct Known {
        std::uint32_t colour = 0;
        std::size_t place = 0;
        Material material = OtherPixels::unknown;
        bool set = false;
    };
    std::array<Known, 16> memory;
    scan.header = read_png(file, source, [&](std::uint32_t y, std::span<const std::uint8_t> rgba) {
        const auto width = static_cast<std::uint32_t>(rgba.size() / 4);
        for (std::uint32_t x = 0; x < width;) {
            const std::uint8_t* const first = rgba.data() + std::size_t{4} * x;
            std::uint32_t end = x + 1;
            while (end < width && std::memcmp(rgba.data() + std::size_t{4} * end, first, 4) == 0) ++end;
            const Rgba colour = {first[0], first[1], first[2], first[3]};
            const std::uint32_t w = word(colour);
            Known& known = memory[(w * 0x9E3779B1u) >> 28];
            if (!known.set || known.colour != w) {
                const auto found_material = material.find(w);
                known = {w, LayerScan::most_colours,
                         found_material != material.end() ? found_material->second
                                                          : material_of_other(palette, colour, others),
                         true};
                if (const auto found = place.find(w); found != place.end()) {
                    known.place = found->second;
                } else if (scan.colours.size() < LayerScan::most_colours) {
                    known.place = place[w] = scan.colours.size();
                    scan.colours.push_back({colour, 0, x, y});
                }
            }
            if (known.place < LayerScan::most_colours)
                scan.colours[known.place].pixels += end - x;
            else
                scan.other_pixels += end - x;
            if (known.material == OtherPixels::unknown)
                scan.runs.reset();
            else if (scan.runs)
                scan.runs->push(end - x, known.material);
            x = end;
        }
        if (scan.runs) scan.runs->end_row();
    });
    return scan;
}

}  // namespace voxtone::io
