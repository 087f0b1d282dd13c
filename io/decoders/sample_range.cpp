// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/decoders/sample_range.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"
#include "base/warning.h"

namespace voxtone::io {

namespace {

constexpr float most_byte_code = 255, most_word_code = 65535;

/// Whether a colour's sample is above some value; of most pictures the first ones are.
template <class Value>
bool some_above(const std::vector<Value>& rgba, Value value) {
    for (std::size_t i = 0; i < rgba.size(); ++i)
        if (i % 4 != 3 && rgba[i] > value) return true;
    return false;
}

/// What holds of samples of one kind, colours or alpha.
struct SampleRange {
    float least = std::numeric_limits<float>::infinity(), most = 0;
    std::size_t between = 0, beyond = 0;  ///< how many lie above 0 and below 1; how many are 1 or more
    bool whole = true;                    ///< none is negative, a fraction or no number
};

template <class Value>
SampleRange range_of(const std::vector<Value>& rgba, bool alpha) {
    SampleRange range;
    std::size_t unseen = 0;
    for (std::size_t i = 0; i < rgba.size(); ++i) {
        if ((i % 4 == 3) != alpha) continue;
        const auto value = static_cast<float>(rgba[i]);
        range.least = std::min(range.least, value);
        ++(value >= 1 ? range.beyond : value > 0 ? range.between : unseen);
        range.most = std::max(range.most, value);
        range.whole = range.whole && value >= 0 && value == std::floor(value);
    }
    return range;
}

/// Codes that are in floats or words already. Alpha is of the same kind, or in the range of its type up to `opaque`.
template <class Code, class Value>
std::vector<Code> codes_of(const std::vector<Value>& rgba, float opaque) {
    constexpr auto most = static_cast<float>(std::numeric_limits<Code>::max());
    const SampleRange alpha = range_of(rgba, true);
    const bool coded = alpha.whole && alpha.most > 1 && alpha.most <= most;
    std::vector<Code> codes(rgba.size());
    for (std::size_t i = 0; i < rgba.size(); ++i) {
        auto value = static_cast<float>(rgba[i]);
        if (i % 4 == 3 && !coded) value = value > 0 ? std::min(value / opaque, 1.0f) * most : 0;
        codes[i] = static_cast<Code>(value + 0.5f);
    }
    return codes;
}

void warn_of_range(const RawSamples& samples, std::string text) {
    samples.warnings.push_back(named_warning("colour-range", text));
}

void mend_floats(const RawSamples& samples, const std::string& name) {
    constexpr float least_byte = 32, least_word = 4096;  // of the brightest
    const SampleRange range = range_of(samples.floats, false);
    const bool bytes = range.whole && range.most >= least_byte && range.most <= most_byte_code;
    const bool words = range.whole && range.most >= least_word && range.most <= most_word_code;
    if (bytes) samples.bytes = codes_of<std::uint8_t>(samples.floats, 1);
    if (words) samples.words = codes_of<std::uint16_t>(samples.floats, 1);
    if (bytes || words) {
        samples.floats = {};
        if (samples.curve == PictureCurve::linear) samples.curve = PictureCurve::srgb;
        warn_of_range(samples, fmt::format("The samples of the picture {} are whole numbers up to {:g}, where floating "
                                           "point has 1 for white: they were taken as sRGB codes of 0 to {:g}.",
                                           name, range.most, bytes ? most_byte_code : most_word_code));
        return;
    }
    // Of numbers that are none of light hardly one lies between black and white.
    constexpr float much_brighter = 2, few = 0.01f;
    const bool all = range.least >= 1 && range.most >= much_brighter;
    const bool nearly_all = range.most >= least_byte && float(range.between) <= few * float(range.beyond);
    if (all || nearly_all)
        throw InputError(fmt::format(
            "{} of the picture {} is 1 or more ({:g} to {:g}), where floating point has 1 for white, so that it would "
            "be white all over{}; divide its samples so that white is 1, or save it as PNG",
            all ? "every sample" : "nearly every sample that is not 0", name, range.least, range.most,
            all ? "" : " but for its blacks"));
}

void mend_words(const RawSamples& samples, const std::string& name) {
    constexpr float least_byte = 16;
    constexpr std::uint16_t dark = 4095;
    if (some_above(samples.words, dark)) return;
    const SampleRange range = range_of(samples.words, false);
    if (samples.curve != PictureCurve::srgb || range.most < 1) return;
    if (range.most < least_byte || range.most > most_byte_code)
        return warn_of_range(samples,
                             fmt::format("No sample of the picture {} is above {:g} of {:g}, so that it is black all "
                                         "over. If its numbers have fewer than 16 bits, scale them.",
                                         name, range.most, most_word_code));
    samples.bytes = codes_of<std::uint8_t>(samples.words, most_word_code);
    samples.words = {};
    warn_of_range(samples, fmt::format("No sample of the picture {} is above 255, of 16 bits: they were taken as codes "
                                       "of 8 bits.",
                                       name));
}

void look_at_bytes(const RawSamples& samples, const std::string& name) {
    if (!some_above<std::uint8_t>(samples.bytes, 1) && some_above<std::uint8_t>(samples.bytes, 0))
        warn_of_range(samples, fmt::format("No sample of the picture {} is above 1 of 255, so that it is black all "
                                           "over. If 1 is white, scale them.",
                                           name));
}

}  // namespace

void mend_sample_range(const RawSamples& samples, const std::string& name) {
    if (!samples.floats.empty())
        mend_floats(samples, name);
    else if (!samples.words.empty())
        mend_words(samples, name);
    else
        look_at_bytes(samples, name);
}

}  // namespace voxtone::io
