// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/openimageio/colour_layer.h"

#include <algorithm>
#include <string_view>

namespace voxtone::io {

namespace {

std::string lower(std::string_view text) {
    std::string result(text);
    for (char& c : result)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c + 32);
    return result;
}

std::string_view layer_of(std::string_view channel) {
    const std::size_t dot = channel.rfind('.');
    return dot == channel.npos ? std::string_view() : channel.substr(0, dot);
}

std::string kind_of(std::string_view channel) {
    const std::size_t dot = channel.rfind('.');
    return lower(dot == channel.npos ? channel : channel.substr(dot + 1));
}

/// The channel of a layer that is called one of these; -1: none.
int find_kind(const std::vector<std::string>& channels, std::string_view layer, std::string_view letter,
              std::string_view word) {
    for (std::size_t i = 0; i < channels.size(); ++i) {
        const std::string kind = kind_of(channels[i]);
        if (layer_of(channels[i]) == layer && (kind == letter || kind == word)) return static_cast<int>(i);
    }
    return -1;
}

enum Rank { nameless, combined, coloured, nameless_grey, grey };

bool is_combined(std::string_view layer) {
    const std::size_t dot = layer.rfind('.');
    return lower(dot == layer.npos ? layer : layer.substr(dot + 1)) == "combined";
}

}  // namespace

std::vector<std::string> layer_names(const std::vector<std::string>& channels) {
    std::vector<std::string> names;
    for (const std::string& channel : channels)
        if (std::string name(layer_of(channel)); std::ranges::find(names, name) == names.end())
            names.push_back(std::move(name));
    return names;
}

std::optional<ColourLayer> find_colour_layer(const std::vector<std::string>& channels, const std::string& part) {
    std::optional<ColourLayer> best;
    for (const std::string& layer : layer_names(channels)) {
        const int red = find_kind(channels, layer, "r", "red"), green = find_kind(channels, layer, "g", "green"),
                  blue = find_kind(channels, layer, "b", "blue"), alpha = find_kind(channels, layer, "a", "alpha"),
                  luminance = find_kind(channels, layer, "y", "luminance");
        const bool has_colour = red >= 0 && green >= 0 && blue >= 0;
        // X, Y and Z are a direction or a place.
        const bool has_grey = luminance >= 0 && find_kind(channels, layer, "x", "x") < 0;
        if (!has_colour && !has_grey) continue;
        const std::string& name = layer.empty() ? part : layer;
        const int rank = !has_colour         ? (name.empty() ? nameless_grey : grey)
                         : name.empty()      ? nameless
                         : is_combined(name) ? combined
                                             : coloured;
        if (best && best->rank <= rank) continue;
        best = ColourLayer{name, {red, green, blue, alpha}, rank};
        if (!has_colour) best->channels = {luminance, luminance, luminance, alpha};
    }
    if (!best && channels.size() == 1) best = ColourLayer{part, {0, 0, 0, -1}, grey};
    return best;
}

}  // namespace voxtone::io
