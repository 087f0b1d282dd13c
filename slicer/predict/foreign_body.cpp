// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/predict/foreign_body.h"

#include <algorithm>
#include <limits>
#include <map>

#include <fmt/core.h>

#include "base/counted.h"
#include "base/error.h"
#include "base/parallel.h"
#include "base/warning.h"
#include "io/layers/orient.h"
#include "slicer/predict/swapped_colours.h"

namespace voxtone::slicer {

namespace {

constexpr int big = std::numeric_limits<int>::max();

/// A colour of no resin.
struct StrayColour {
    io::Rgba rgba{};
    std::uint64_t pixels = 0;
    std::uint32_t layer = 0, x = 0, y = 0;  ///< the first
};

struct LayerFinding {
    std::string fault;
    std::array<int, 2> size{};
    std::array<int, 2> lowest{big, big}, highest{-1, -1};
    std::array<std::uint64_t, io::max_materials> pixels{};
    std::array<bool, io::max_materials> seen{};  ///< colours of the palette that pixels have, opaque or not
    std::vector<StrayColour> strays;
    std::uint64_t other_pixels = 0;  ///< of more colours than are told apart
};

io::Rgb rgb_of(const io::Rgba& c) { return {c[0], c[1], c[2]}; }

std::size_t place_in(const std::vector<io::Rgb>& palette, const io::Rgba& c) {
    return static_cast<std::size_t>(std::ranges::find(palette, rgb_of(c)) - palette.begin());
}

/// Of all colours in the bitmap, those that occur as they are and those that stand for nothing.
void sort_colours(const io::LayerScan& scan, const PixelMaterials& materials, std::uint32_t layer,
                  LayerFinding& finding) {
    for (const io::ColourCount& colour : scan.colours) {
        const std::size_t place = place_in(materials.palette, colour.rgba);
        const bool known = place < materials.palette.size();
        if (known) finding.seen[place] = true;
        if (colour.rgba[3] == 255 && known)
            finding.pixels[place] += colour.pixels;
        else if (colour.rgba[3] > 0 || materials.others.transparent == io::OtherPixels::unknown)
            finding.strays.push_back({colour.rgba, colour.pixels, layer, colour.first_x, colour.first_y});
    }
    finding.other_pixels = scan.other_pixels;
}

void find_box(const io::LayerRuns& layer, const MaterialTable& material_of, LayerFinding& finding) {
    const int height = static_cast<int>(layer.height_px());
    finding.size = {static_cast<int>(layer.width_px()), height};
    for (int row = 0; row < height; ++row) {
        int x = 0;
        for (const io::Run run : layer.row(static_cast<std::uint32_t>(row))) {
            if (material_of[run.material] != optics::air) {
                const int y = height - 1 - row;
                finding.lowest = {std::min(finding.lowest[0], x), std::min(finding.lowest[1], y)};
                finding.highest = {std::max(finding.highest[0], x + run.length), std::max(finding.highest[1], y + 1)};
            }
            x += run.length;
        }
    }
}

/// Pixels as they are printed, the transparent and the nearest among them.
void count_printed(const io::LayerRuns& layer, LayerFinding& finding) {
    finding.pixels = {};
    for (std::uint32_t row = 0; row < layer.rows(); ++row)
        for (const io::Run run : layer.row(row)) finding.pixels[run.material] += run.length;
}

LayerFinding look_at(const ForeignStack& stack, const PixelMaterials& materials, std::uint32_t index) {
    io::LayerInspection found = stack.layers.inspect(index, materials.palette, materials.others);
    LayerFinding finding;
    finding.fault = std::move(found.fault);
    if (!finding.fault.empty()) return finding;
    sort_colours(found.scan, materials, index, finding);
    finding.size = {static_cast<int>(found.scan.header.width_px), static_cast<int>(found.scan.header.height_px)};
    if (stack.orientation.swap_xy) std::swap(finding.size[0], finding.size[1]);
    if (!found.scan.runs) return finding;
    count_printed(*found.scan.runs, finding);
    find_box(io::as_sliced(std::move(*found.scan.runs), stack.orientation), materials.material_of, finding);
    return finding;
}

std::vector<LayerFinding> look_at_all(const ForeignStack& stack, const PixelMaterials& materials, Progress& progress) {
    std::vector<LayerFinding> findings(stack.layers.layers());
    progress.begin_stage("find the body", findings.size(), "layers");
    parallel_for(
        0, findings.size(), 1,
        [&](std::size_t k) {
            findings[k] = look_at(stack, materials, static_cast<std::uint32_t>(k));
            progress.advance();
        },
        &progress);
    progress.end_stage();
    for (const LayerFinding& finding : findings)
        if (!finding.fault.empty()) throw InputError(fmt::format("{}: {}", stack.name, finding.fault));
    return findings;
}

void expect_one_size(const ForeignStack& stack, const std::vector<LayerFinding>& findings) {
    std::map<std::array<int, 2>, std::size_t> sizes;
    for (const LayerFinding& finding : findings) ++sizes[finding.size];
    if (sizes.size() <= 1) return;
    const auto usual = std::ranges::max_element(sizes, {}, [](const auto& size) { return size.second; });
    const auto odd = std::ranges::find_if(findings, [&](const LayerFinding& f) { return f.size != usual->first; });
    throw InputError(
        fmt::format("{}: {} is {} x {} px, but {} of the {} layers are {} x {}; make all layers of one size (`voxtone "
                    "verify` lists those that are not)",
                    stack.name, stack.layers.layer_name(static_cast<std::uint32_t>(odd - findings.begin())),
                    odd->size[0], odd->size[1], usual->second, findings.size(), usual->first[0], usual->first[1]));
}

/// Of all layers, the most frequent first.
std::vector<StrayColour> strays_of(const std::vector<LayerFinding>& findings) {
    std::map<io::Rgba, StrayColour> by_colour;
    for (const LayerFinding& finding : findings)
        for (const StrayColour& stray : finding.strays) {
            const auto [known, is_new] = by_colour.try_emplace(stray.rgba, stray);
            if (!is_new) known->second.pixels += stray.pixels;
        }
    std::vector<StrayColour> all;
    for (const auto& [rgba, stray] : by_colour) all.push_back(stray);
    std::ranges::stable_sort(all, std::ranges::greater(), &StrayColour::pixels);
    return all;
}

std::uint64_t pixels_of_all(const std::vector<StrayColour>& strays) {
    std::uint64_t sum = 0;
    for (const StrayColour& stray : strays) sum += stray.pixels;
    return sum;
}

std::string place_of(const ForeignStack& stack, const StrayColour& stray) {
    return fmt::format("{}, column {}, row {}", stack.layers.layer_name(stray.layer), stray.x, stray.y);
}

/// "#00aeef=?,#ec008c=?", no more than `most`.
std::string to_assign(const std::vector<StrayColour>& strays, std::size_t most) {
    std::string list;
    for (std::size_t i = 0; i < std::min(strays.size(), most); ++i)
        list += fmt::format("{}{}=?", i > 0 ? "," : "", hex_code(rgb_of(strays[i].rgba)));
    return list;
}

/// The same with what they may be: a colour in the corner is the background's.
std::string likely_assignments(const std::vector<StrayColour>& strays, std::size_t most, const std::string& resin) {
    std::string list;
    for (std::size_t i = 0; i < std::min(strays.size(), most); ++i)
        list += fmt::format("{}{}={}", i > 0 ? "," : "", hex_code(rgb_of(strays[i].rgba)),
                            strays[i].x == 0 && strays[i].y == 0 ? "none" : resin);
    return list;
}

/// Nobody has said anything of any colour.
[[noreturn]] void refuse_untold(const ForeignStack& stack, const std::vector<StrayColour>& opaque, bool any_soft) {
    constexpr std::size_t most_named = 8;
    constexpr double few = 0.02;
    const bool may_be_smoothed = any_soft || opaque.size() > 2;
    // Of many colours those of few pixels are none of a resin.
    std::vector<StrayColour> named = opaque;
    if (named.size() > most_named)
        std::erase_if(named, [&](const auto& s) { return double(s.pixels) < few * double(opaque.front().pixels); });
    throw InputError(fmt::format(
        "{}: nothing says which resin its {} {}; say it, with roles of the set '{}' ({}) or none: --assign \"{}\"{}",
        stack.name, counted(opaque.size(), "colour"), opaque.size() == 1 ? "is" : "are", stack.resin_set, stack.roles,
        to_assign(named, most_named),
        may_be_smoothed
            ? "; leave colours of smoothed edges out and add --nearest, which takes each for the nearest one"
            : ""));
}

[[noreturn]] void refuse_soft(const ForeignStack& stack, const std::vector<StrayColour>& soft) {
    throw InputError(fmt::format(
        "{}: {} half transparent, and a voxel is of one resin or of none (most have {} of alpha {}, the first in {}); "
        "add --nearest, which takes what is at least half opaque for the nearest colour of --assign and the rest for "
        "nothing, or save the layers with hard edges",
        stack.name, pixels_of_all(soft) == 1 ? "1 pixel is" : fmt::format("{} pixels are", pixels_of_all(soft)),
        hex_code(rgb_of(soft[0].rgba)), soft[0].rgba[3], place_of(stack, soft[0])));
}

[[noreturn]] void refuse_opaque(const ForeignStack& stack, const std::vector<StrayColour>& opaque, std::size_t room) {
    constexpr std::size_t most_named = 4;
    const StrayColour& first = opaque[0];
    const std::string what =
        opaque.size() == 1
            ? fmt::format("{} of {}, which stands for no resin, the first in {}", counted(first.pixels, "pixel"),
                          hex_code(rgb_of(first.rgba)), place_of(stack, first))
            : fmt::format("{} of {} colours, each of which stands for no resin, most of {}, the first of these in {}",
                          counted(pixels_of_all(opaque), "pixel"), opaque.size(), hex_code(rgb_of(first.rgba)),
                          place_of(stack, first));
    const std::string nearest = "if edges were smoothed, add --nearest, which takes each for the nearest colour told";
    if (opaque.size() > room) throw InputError(fmt::format("{}: has {}; {}", stack.name, what, nearest));
    throw InputError(fmt::format("{}: has {}; say what {} as well: --assign \"{}\" (or another of {}, none), or, {}",
                                 stack.name, what, opaque.size() == 1 ? "it is" : "they are",
                                 likely_assignments(opaque, most_named, stack.role), stack.roles, nearest));
}

void expect_known(const ForeignStack& stack, const PixelMaterials& materials,
                  const std::vector<LayerFinding>& findings) {
    std::vector<StrayColour> opaque = strays_of(findings), soft;
    std::ranges::copy_if(opaque, std::back_inserter(soft), [](const auto& s) { return s.rgba[3] < 255; });
    std::erase_if(opaque, [](const auto& s) { return s.rgba[3] < 255; });
    if (!opaque.empty() && !stack.any_assigned) refuse_untold(stack, opaque, !soft.empty());
    const auto crowded = std::ranges::find_if(findings, [](const auto& f) { return f.other_pixels > 0; });
    if (crowded != findings.end())
        throw InputError(fmt::format(
            "{}: {} has more than {} colours, and a colour is one resin; save it with hard edges and without loss, or "
            "add --nearest, which takes each for the nearest colour of --assign",
            stack.name, stack.layers.layer_name(static_cast<std::uint32_t>(crowded - findings.begin())),
            io::LayerScan::most_colours));
    if (!opaque.empty()) refuse_opaque(stack, opaque, io::max_materials - materials.palette.size());
    if (!soft.empty()) refuse_soft(stack, soft);
}

/// Colours that were told and occur: one that does not is nobody's nearest.
PixelMaterials nearest_of(const ForeignStack& stack, const PixelMaterials& told,
                          const std::vector<LayerFinding>& findings) {
    PixelMaterials materials;
    for (std::size_t i = 0; i < told.palette.size(); ++i)
        if (std::ranges::any_of(findings, [&](const auto& f) { return f.seen[i]; })) {
            materials.material_of[materials.palette.size()] = told.material_of[i];
            materials.palette.push_back(told.palette[i]);
        }
    if (materials.palette.empty())
        throw InputError(
            fmt::format("{}: no pixel has a colour of --assign, so that none is the nearest one; name "
                        "colours that occur",
                        stack.name));
    materials.others = {static_cast<io::Material>(materials.palette.size()), true};
    if (materials.palette.size() == std::size_t{io::max_materials}) materials.others = told.others;
    materials.others.nearest = true;
    return materials;
}

std::string shown(const io::Rgba& c) {
    return c[3] == 255 ? hex_code(rgb_of(c)) : fmt::format("{} of alpha {}", hex_code(rgb_of(c)), c[3]);
}

/// So many pixels are no edge.
bool may_be_a_resin(const StrayColour& stray, const std::vector<LayerFinding>& findings) {
    constexpr double edges = 0.05;
    std::uint64_t known = 0;
    for (const LayerFinding& finding : findings)
        for (const std::uint64_t pixels : finding.pixels) known += pixels;
    return stray.rgba[3] == 255 && double(stray.pixels) > edges * double(known);
}

void tell_of_nearest(const ForeignStack& stack, const std::vector<LayerFinding>& findings, Progress& progress) {
    const std::vector<StrayColour> strays = strays_of(findings);
    std::uint64_t pixels = pixels_of_all(strays);
    for (const LayerFinding& finding : findings) pixels += finding.other_pixels;
    progress.warn(named_warning(
        "nearest-colour",
        fmt::format("{}: {} of {} that stand for no resin were taken for the nearest colour told (--nearest), most of "
                    "{}, the first in {}{}",
                    stack.name, counted(pixels, "pixel"), counted(strays.size(), "colour"), shown(strays[0].rgba),
                    place_of(stack, strays[0]),
                    may_be_a_resin(strays[0], findings)
                        ? "; so many are hardly an edge: if it is a resin of its own, say which with --assign"
                        : "")));
}

bool all_known(const std::vector<LayerFinding>& findings) {
    return std::ranges::none_of(findings, [](const auto& f) { return f.other_pixels > 0 || !f.strays.empty(); });
}

LayerWindow window_of(const ForeignStack& stack, const std::vector<LayerFinding>& findings) {
    std::array<int, 3> low{big, big, big}, high{-1, -1, -1};
    for (std::size_t k = 0; k < findings.size(); ++k) {
        const LayerFinding& f = findings[k];
        if (f.highest[0] < 0) continue;
        for (std::size_t a = 0; a < 2; ++a) {
            low[a] = std::min(low[a], f.lowest[a]);
            high[a] = std::max(high[a], f.highest[a]);
        }
        low[2] = std::min(low[2], static_cast<int>(k));
        high[2] = static_cast<int>(k) + 1;
    }
    if (high[0] < 0)
        throw InputError(
            fmt::format("{}: no layer has a voxel of any resin: there is nothing to predict; check "
                        "--assign",
                        stack.name));
    return {low, {high[0] - low[0], high[1] - low[1], high[2] - low[2]}};
}

}  // namespace

std::uint64_t ForeignBody::pixels_of(const io::Rgb& rgb) const {
    const auto at = std::ranges::find(materials.palette, rgb);
    return at == materials.palette.end() ? 0 : pixels[static_cast<std::size_t>(at - materials.palette.begin())];
}

std::uint64_t ForeignBody::solid_voxels() const {
    std::uint64_t sum = 0;
    for (std::size_t m = 0; m < pixels.size(); ++m)
        if (materials.material_of[m] != optics::air) sum += pixels[m];
    return sum;
}

ForeignBody find_foreign_body(const ForeignStack& stack, PixelMaterials materials, Progress& progress) {
    std::vector<LayerFinding> findings = look_at_all(stack, materials, progress);
    expect_one_size(stack, findings);
    if (stack.nearest && stack.any_assigned && !all_known(findings)) {
        tell_of_nearest(stack, findings, progress);
        materials = nearest_of(stack, materials, findings);
        findings = look_at_all(stack, materials, progress);
    } else {
        expect_known(stack, materials, findings);
    }
    ForeignBody body{window_of(stack, findings), std::move(materials), {}};
    for (const LayerFinding& finding : findings)
        for (std::size_t m = 0; m < body.pixels.size(); ++m) body.pixels[m] += finding.pixels[m];
    return body;
}

}  // namespace voxtone::slicer
