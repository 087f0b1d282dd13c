// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/options/mark_words.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <functional>
#include <map>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/units.h"
#include "io/lettering/font_file.h"
#include "optics/colour/colour.h"
#include "slicer/options/option_values.h"
#include "slicer/options/option_words.h"

namespace voxtone::slicer {

namespace {

constexpr double mm_per_point = mm_per_inch / 72;
constexpr double usual_em_mm = 6 * mm_per_point, usual_code_mm = 8, usual_bars_mm = 40;
constexpr double most_size_mm = 1000;
constexpr int most_relief_voxels = 100;

constexpr const char *text_key = "text", *file_key = "file", *qr_key = "qr", *data_matrix_key = "datamatrix",
                     *font_key = "font";
const std::map<std::string, MarkKind, std::less<>> kinds_by_key{
    {text_key, MarkKind::text},         {qr_key, MarkKind::qr},       {data_matrix_key, MarkKind::data_matrix},
    {"gs1", MarkKind::gs1_data_matrix}, {"gs1-qr", MarkKind::gs1_qr}, {"gs1-128", MarkKind::gs1_128},
    {file_key, MarkKind::picture}};
const std::vector<std::string> words_of_marks{"place", "at", "size", "turn", "engrave", "raise"};
const std::vector<std::string> words_of_labels{text_key,  qr_key,   data_matrix_key, "gs1",   "gs1-qr",
                                               "gs1-128", font_key, "colour",        "resin", "ground"};

std::vector<std::string> words_of(MarkFamily family) {
    std::vector<std::string> keys =
        family == MarkFamily::label ? words_of_labels : std::vector<std::string>{file_key, "ground"};
    keys.insert(keys.end(), words_of_marks.begin(), words_of_marks.end());
    return keys;
}

std::string subject_of(MarkFamily family, const MarkWords& words) {
    constexpr std::size_t most_letters = 40;
    std::string text = words.empty() ? std::string() : words[0].second;
    if (text.size() > most_letters) text = text.substr(0, most_letters) + "...";
    std::ranges::replace(text, '\n', ' ');
    return fmt::format("--{} '{}'", family == MarkFamily::label ? "label" : "decal", text);
}

[[noreturn]] void refuse_mark(const std::string& said, const std::string& why) {
    throw UsageError(fmt::format("{}: {}", said, why));
}

std::string trimmed_word(const std::string& text) {
    const std::size_t first = text.find_first_not_of(" \t");
    return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

/// "6pt" too.
double size_word(const std::string& text, const std::string& said) {
    const std::string word = trimmed_word(text);
    const bool points = word.ends_with("pt");
    const double mm = points ? parse_length_mm(word.substr(0, word.size() - 2), said + ": size") * mm_per_point
                             : parse_length_mm(word, said + ": size");
    if (!(mm > 0 && mm <= most_size_mm)) refuse_mark(said, fmt::format("size={} is not above 0 and up to 1 m", text));
    return mm;
}

/// So many lengths between commas, mm where there is no unit; empty: it is not that.
std::vector<double> length_words(const std::string& text, std::size_t count) {
    std::vector<double> lengths;
    for (const std::string& part : parse_list(text)) try {
            lengths.push_back(parse_length_mm(part, "place"));
        } catch (const UsageError&) {
            return {};
        }
    return lengths.size() == count ? lengths : std::vector<double>{};
}

MarkPlace place_word(const std::string& text, const std::string& said) {
    if (const auto side = value_of<MarkSide>(text)) return *side;
    if (text.starts_with("uv:")) {
        const std::vector<double> uv = length_words(text.substr(3), 4);
        if (uv.empty() || !(uv[0] < uv[2] && uv[1] < uv[3]))
            refuse_mark(said, fmt::format("place={} is no rectangle of the texture: write uv:left,bottom,right,top in "
                                          "texture coordinates, such as uv:0.1,0.1,0.4,0.2",
                                          text));
        return UvRectangle{uv[0], uv[1], uv[2], uv[3]};
    }
    const std::vector<double> point = length_words(text, 3);
    if (point.empty())
        refuse_mark(said,
                    fmt::format("place={} is none of {}, no point x,y,z in mm from the corner of the print's box, and "
                                "no uv:left,bottom,right,top",
                                text, fmt::join(names_of<MarkSide>(), ", ")));
    return Eigen::Vector3d(point[0], point[1], point[2]);
}

Eigen::Vector3f colour_word(const std::string& key, const std::string& text, const std::string& said) {
    if (text == "black") return Eigen::Vector3f::Zero();
    if (text == "white") return Eigen::Vector3f::Ones();
    unsigned code = 0;
    const char* const end = text.data() + text.size();
    if (text.size() != 7 || text[0] != '#' || std::from_chars(text.data() + 1, end, code, 16).ptr != end)
        refuse_mark(said, fmt::format("{}={} is no colour: write black, white or #rrggbb (sRGB)", key, text));
    const auto channel = [&](int shift) { return float(optics::srgb_decode((code >> shift & 0xff) / 255.0)); };
    return {channel(16), channel(8), channel(0)};
}

int voxels_word(const std::string& key, const std::string& text, const std::string& said) {
    int voxels = 0;
    const char* const end = text.data() + text.size();
    if (std::from_chars(text.data(), end, voxels).ptr != end || voxels < 1 || voxels > most_relief_voxels)
        refuse_mark(said,
                    fmt::format("{}={} is not a whole number of voxels from 1 to {}", key, text, most_relief_voxels));
    return voxels;
}

void take_subject(MarkOptions& mark, const std::string& key, const std::string& value) {
    mark.kind = kinds_by_key.at(key);
    (mark.kind == MarkKind::picture ? mark.file : mark.text) = value;
}

void take_word(MarkOptions& mark, const std::string& key, const std::string& value) {
    const std::string& said = mark.said;
    if (key == font_key) {
        mark.font = value;
    } else if (key == "place") {
        mark.place = place_word(value, said);
    } else if (key == "at") {
        const std::vector<double> at = length_words(value, 2);
        if (at.empty())
            refuse_mark(said, fmt::format("at={} is no place: write to the right,up in mm, such as 5,-2", value));
        mark.at_mm = Eigen::Vector2d(at[0], at[1]);
    } else if (key == "size") {
        mark.size_mm = size_word(value, said);
    } else if (key == "turn") {
        mark.turn_deg = parse_number<double>("turn", value);
    } else if (key == "ground") {
        if (value != "none") mark.ground_rgb = colour_word(key, value, said);
        if (value == "none") mark.ground_rgb.reset();
    } else if (key == "colour") {
        mark.ink = value == "contrast" ? MarkInk::contrast : value == "none" ? MarkInk::none : MarkInk::colour;
        if (mark.ink == MarkInk::colour) mark.ink_rgb = colour_word(key, value, said);
    } else if (key == "resin") {
        mark.resin = value;
    } else if (key == "raise" || key == "engrave") {
        mark.relief_voxels = voxels_word(key, value, said) * (key == "raise" ? 1 : -1);
    }
}

void check_mark(const MarkOptions& mark) {
    if (mark.kind == MarkKind::picture && mark.file.empty()) refuse_mark(mark.said, "names no picture");
    if (mark.kind == MarkKind::picture && !(mark.size_mm > 0) && !std::holds_alternative<UvRectangle>(mark.place))
        refuse_mark(mark.said, "how wide it is must be said: size=20mm");
    if (mark.kind != MarkKind::picture && trimmed_word(mark.text).empty())
        refuse_mark(mark.said, "says nothing: write what it is to say, 'A-17' or 'qr=A-17'");
    if (mark.kind != MarkKind::text && !mark.font.empty())
        refuse_mark(mark.said, "font= is for text, which a code has not");
    if (mark.at_mm &&
        (!std::holds_alternative<MarkSide>(mark.place) || std::get<MarkSide>(mark.place) <= MarkSide::flattest))
        refuse_mark(mark.said, "at= is counted from the middle of a side: say which, such as place=front");
    if (!mark.resin.empty() && mark.ground_rgb)
        refuse_mark(mark.said, "resin= takes what is below the ink alone: ground= does not go with it");
    if (std::holds_alternative<UvRectangle>(mark.place) && mark.relief_voxels != 0)
        refuse_mark(mark.said, "a rectangle of the texture takes colour alone: for a relief name a side or a point");
    if (mark.ink == MarkInk::none && mark.relief_voxels == 0 && !mark.ground_rgb)
        refuse_mark(mark.said, "colour=none leaves nothing to be seen without engrave= or raise=");
}

/// Codes are read as dark on light by every reader, so they bring their own light ground; dark ink on a ground, or
/// light.
void complete_mark(MarkOptions& mark, bool ground_said) {
    const bool code = is_code(mark.kind);
    if (!mark.resin.empty()) mark.ink = MarkInk::colour;  // which it is, the loaded resins say
    if (code && mark.ink == MarkInk::contrast && (!ground_said || mark.ground_rgb)) {
        mark.ink = MarkInk::colour;
        mark.ink_rgb.setZero();
    }
    if (code && !ground_said && mark.resin.empty() && mark.ink == MarkInk::colour)
        mark.ground_rgb = Eigen::Vector3f::Ones();
    if (mark.kind == MarkKind::text && mark.font.empty()) mark.font = io::default_font;
    if (mark.size_mm > 0 || mark.kind == MarkKind::picture) return;
    mark.size_mm = mark.kind == MarkKind::gs1_128 ? usual_bars_mm : code ? usual_code_mm : usual_em_mm;
}

/// Where the '=' of a known word stands within another word: "A-17, size=6pt" would print just that. npos: nowhere.
std::size_t equals_within(MarkFamily family, std::string_view spelled) {
    const std::vector<std::string> keys = words_of(family);
    const auto is_blank = [](char c) { return c == ' ' || c == '\t' || c == ','; };
    for (std::size_t i = spelled.find('='); i != std::string_view::npos; i = spelled.find('=', i + 1)) {
        std::size_t key = i;
        while (key > 0 && (std::isalnum(static_cast<unsigned char>(spelled[key - 1])) != 0 || spelled[key - 1] == '-'))
            --key;
        std::size_t before = key;
        while (before > 0 && is_blank(spelled[before - 1])) --before;
        const bool begins = before == 0 || spelled[before - 1] == ';';
        if (!begins && before < key && std::ranges::find(keys, spelled.substr(key, i - key)) != keys.end()) return i;
    }
    return std::string_view::npos;
}

}  // namespace

bool is_mark_subject(std::string_view key) { return kinds_by_key.contains(key); }

MarkWords split_mark(MarkFamily family, std::string_view spelled) {
    std::vector<std::string> raw(1);
    std::vector<std::size_t> equals;  // of each word, the first '=' that is meant
    equals.push_back(std::string::npos);
    for (std::size_t i = 0; i < spelled.size(); ++i) {
        const char c = spelled[i];
        if (c == '\\' && i + 1 < spelled.size()) {
            raw.back() += spelled[++i] == 'n' ? '\n' : spelled[i];
        } else if (c == ';') {
            raw.emplace_back();
            equals.push_back(std::string::npos);
        } else {
            if (c == '=' && equals.back() == std::string::npos) equals.back() = raw.back().size();
            raw.back() += c;
        }
    }
    const std::vector<std::string> keys = words_of(family);
    MarkWords words;
    for (std::size_t w = 0; w < raw.size(); ++w) {
        const std::string key = equals[w] == std::string::npos ? "" : trimmed_word(raw[w].substr(0, equals[w]));
        const bool is_known = std::ranges::find(keys, key) != keys.end();
        if (w == 0 && !is_known)
            words.emplace_back(family == MarkFamily::label ? text_key : file_key, trimmed_word(raw[w]));
        else if (equals[w] != std::string::npos)
            words.emplace_back(key, trimmed_word(raw[w].substr(equals[w] + 1)));
        else if (!trimmed_word(raw[w]).empty())
            words.emplace_back("", trimmed_word(raw[w]));
    }
    if (const std::size_t stray = equals_within(family, spelled); stray != std::string::npos) {
        const std::string here(spelled.substr(0, stray));
        refuse_mark(subject_of(family, words),
                    fmt::format("words about it stand behind semicolons: write '; {0}=' (or {0}\\= where it "
                                "is meant to be read so)",
                                here.substr(here.find_last_of(" \t,") + 1)));
    }
    return words;
}

std::string spell_mark(const MarkWords& words) {
    std::string spelled;
    for (const auto& [key, value] : words) {
        spelled += fmt::format("{}{}=", spelled.empty() ? "" : "; ", key);
        const bool hides_word = equals_within(MarkFamily::label, value) != std::string::npos ||
                                equals_within(MarkFamily::decal, value) != std::string::npos;
        for (const char c : value) {
            if (c == ';' || c == '\\' || (c == '=' && hides_word)) spelled += '\\';
            spelled += c == '\n' ? "\\n" : std::string(1, c);
        }
    }
    return spelled;
}

MarkOptions parse_mark(MarkFamily family, const std::string& spelled) {
    const MarkWords words = split_mark(family, spelled);
    const std::vector<std::string> keys = words_of(family);
    MarkOptions mark;
    mark.said = subject_of(family, words);
    std::vector<std::string> said_keys;
    bool has_subject = false;
    for (const auto& [key, value] : words) {
        if (std::ranges::find(keys, key) == keys.end())
            refuse_mark(mark.said,
                        fmt::format("'{}' is none of its words: {}", key.empty() ? value : key, fmt::join(keys, ", ")));
        if (std::ranges::find(said_keys, key) != said_keys.end())
            refuse_mark(mark.said, fmt::format("{}= is said twice", key));
        said_keys.push_back(key);
        const bool is_subject = is_mark_subject(key);
        if (is_subject && has_subject) refuse_mark(mark.said, "is one text or one code; give a --label for each");
        if (is_subject) take_subject(mark, key, value);
        has_subject = has_subject || is_subject;
    }
    if (!has_subject) refuse_mark(mark.said, family == MarkFamily::label ? "says nothing" : "names no picture");
    if (family == MarkFamily::decal) mark.place = MarkSide::flattest;  // a picture is there to be seen
    for (const auto& [key, value] : words) take_word(mark, key, value);
    if (!mark.resin.empty() && std::ranges::find(said_keys, "colour") != said_keys.end())
        refuse_mark(mark.said, "has the colour of its resin: say resin= or colour=, not both");
    if (std::ranges::find(said_keys, "engrave") != said_keys.end() &&
        std::ranges::find(said_keys, "raise") != said_keys.end())
        refuse_mark(mark.said, "is engraved or raised, not both");
    complete_mark(mark, std::ranges::find(said_keys, "ground") != said_keys.end());
    check_mark(mark);
    return mark;
}

std::string with_files(MarkFamily family, const std::string& spelled,
                       const std::function<std::string(const std::string&)>& place) {
    MarkWords words = split_mark(family, spelled);
    bool changed = false;
    for (auto& [key, value] : words) {
        if (value.empty() || !(key == file_key || (key == font_key && io::is_font_path(value)))) continue;
        value = place(value);
        changed = true;
    }
    return changed ? spell_mark(words) : spelled;
}

}  // namespace voxtone::slicer
