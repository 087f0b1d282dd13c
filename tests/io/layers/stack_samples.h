// SPDX-License-Identifier: GPL-3.0-or-later
//
// A small stack to write, read and spoil.
#pragma once

#include <filesystem>
#include <string>

#include "io/layers/layer_stack_writer.h"
#include "io/layers/verify.h"
#include "layer_samples.h"

namespace voxtone::io {

inline StackDescription sample_description(std::uint32_t layers, std::uint32_t width = 70, std::uint32_t height = 40) {
    StackDescription stack;
    stack.printer = "stratasys-j750-hm";
    stack.pitch_um = {25400.0 / 600, 25400.0 / 300, 27};
    stack.size_px = {width, height};
    stack.layers = layers;
    stack.resins = {{"VeroCyan", "C", {0, 174, 239}},
                    {"VeroMagenta", "M", {236, 0, 140}},
                    {"VeroYellow", "Y", {255, 242, 0}},
                    {"VeroBlack", "K", {40, 40, 40}},
                    {"VeroWhite", "W", {220, 222, 216}}};
    return stack;
}

inline LayerRuns sample_layer(std::uint32_t index, std::uint32_t width = 70, std::uint32_t height = 40) {
    constexpr std::array<double, 6> weights = {3, 1, 1, 1, 1, 5};
    RandomStream random(11, index);
    return random_layer(random, width, height, weights, 0.05, 0.3);
}

/// Pixels of a layer, row by row from the top.
inline std::vector<Material> layer_pixels(const LayerRuns& layer) {
    std::vector<Material> result;
    for (std::uint32_t y = 0; y < layer.rows(); ++y)
        for (const Run run : layer.row(y)) result.insert(result.end(), run.length, static_cast<Material>(run.material));
    return result;
}

inline LayerRuns layer_from_pixels(const std::vector<Material>& pixels, std::uint32_t width, std::uint32_t height) {
    LayerRuns layer(width, height);
    for (std::uint32_t y = 0; y < height; ++y) {
        for (std::uint32_t x = 0; x < width; ++x) layer.push(1, pixels[std::size_t{y} * width + x]);
        layer.end_row();
    }
    return layer;
}

inline StackDescription write_sample_stack(const std::filesystem::path& out, std::uint32_t layers,
                                           StackOutputs outputs = {}) {
    LayerStackWriter writer(out, sample_description(layers), outputs, true);
    for (std::uint32_t k = 0; k < layers; ++k) writer.write(k, sample_layer(k));
    return writer.finish();
}

/// Whether a fault of this rule is reported in these words.
inline bool has(const StackReport& report, const std::string& rule, const std::string& words = "") {
    for (const auto& fault : report.faults)
        if (fault.rule == rule && (fault.where + fault.what + fault.remedy).find(words) != std::string::npos)
            return true;
    return false;
}

}  // namespace voxtone::io
