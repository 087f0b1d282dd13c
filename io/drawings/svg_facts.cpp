// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/drawings/svg_facts.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <fontconfig/fontconfig.h>

#include "base/error.h"
#include "base/printable.h"
#include "base/warning.h"
#include "io/files/utf8.h"
#include "io/files/xml_reader.h"

namespace voxtone::io {

namespace {

constexpr std::string_view blanks = " \t\r\n";

std::string_view trimmed(std::string_view text) {
    text.remove_prefix(std::min(text.find_first_not_of(blanks), text.size()));
    return text.substr(0, text.find_last_not_of(blanks) + 1);
}

struct Facts {
    bool has_text = false, has_html = false, has_choice = false;
    std::set<std::string> family_lists;  ///< as they stand in the file
    std::vector<std::string> files;      ///< named pictures and parts
    std::string letters;
};

/// Of all "font-family: ..." of a style.
void add_families(std::string_view style, Facts& facts) {
    constexpr std::string_view property = "font-family";
    for (std::size_t at = style.find(property); at != style.npos; at = style.find(property, at + 1)) {
        std::string_view value = trimmed(style.substr(at + property.size()));
        if (!value.starts_with(':')) continue;
        value = trimmed(value.substr(1, value.find_first_of(";}<", 1) - 1));
        if (!value.empty()) facts.family_lists.emplace(value);
    }
}

bool shows_another_file(std::string_view element) {
    return element == "image" || element == "use" || element == "feImage";
}

void add_element(const XmlReader& xml, Facts& facts) {
    const std::string_view element = xml.name();
    facts.has_text = facts.has_text || element == "text";
    facts.has_html = facts.has_html || element == "foreignObject";
    facts.has_choice = facts.has_choice || element == "switch";
    for (const auto& [key, value] : xml.attributes()) {
        if (key == "font-family") facts.family_lists.emplace(trimmed(value));
        if (key == "style") add_families(value, facts);
        if (XmlReader::local(key) != "href" || !shows_another_file(element)) continue;
        const std::string_view place = trimmed(value);
        if (!place.empty() && !place.starts_with('#') && !place.starts_with("data:")) facts.files.emplace_back(place);
    }
    if (element == "text" || element == "tspan" || element == "textPath")
        facts.letters += XmlReader::decode(xml.text());
}

/// As far as it can be read; what is broken was the drawing's to say.
Facts facts_of(std::string_view text) {
    Facts facts;
    const auto root = [&] {  // behind a document type, which the reader takes for an attack
        const std::size_t type = text.find("<!DOCTYPE");
        if (type == text.npos) return text;
        const std::size_t inner = text.find_first_of("[>", type);
        const std::size_t end = inner != text.npos && text[inner] == '[' ? text.find("]", inner) : inner;
        return end == text.npos ? std::string_view() : text.substr(std::min(text.find('>', end), text.size()));
    }();
    try {
        XmlReader xml(root, "drawing");
        for (XmlReader::Event event = xml.next(); event != XmlReader::Event::finished; event = xml.next())
            if (event == XmlReader::Event::start) add_element(xml, facts);
    } catch (const InputError&) {
    }
    for (std::size_t at = text.find("<style"); at != text.npos; at = text.find("<style", at + 1))
        add_families(text.substr(at, text.find("</style", at) - at), facts);
    return facts;
}

/// "'Frutiger 55', Arial" -> Frutiger 55, Arial.
std::vector<std::string> families_in(std::string_view list) {
    std::vector<std::string> families;
    while (!list.empty()) {
        const std::size_t comma = std::min(list.find(','), list.size());
        std::string_view family = trimmed(list.substr(0, comma));
        if (family.size() > 1 && (family.front() == '\'' || family.front() == '"'))
            family = trimmed(family.substr(1, family.size() - 2));
        if (!family.empty()) families.emplace_back(family);
        list.remove_prefix(std::min(comma + 1, list.size()));
    }
    return families;
}

bool is_general(const std::string& family) {
    return family == "serif" || family == "sans-serif" || family == "monospace" || family == "cursive" ||
           family == "fantasy" || family == "system-ui" || family == "sans" || family == "inherit";
}

using Pattern = std::unique_ptr<FcPattern, decltype(&FcPatternDestroy)>;

const FcChar8* fc(const std::string& text) { return reinterpret_cast<const FcChar8*>(text.c_str()); }

Pattern pattern_of(const std::vector<std::string>& families) {
    Pattern pattern(FcPatternCreate(), &FcPatternDestroy);
    for (const std::string& family : families) FcPatternAddString(pattern.get(), FC_FAMILY, fc(family));
    FcConfigSubstitute(nullptr, pattern.get(), FcMatchPattern);
    FcDefaultSubstitute(pattern.get());
    return pattern;
}

/// The font that text in these is set in; nothing where this machine has none.
struct Match {
    std::string family;
    bool is_asked = false;
};

std::optional<Match> match_of(const std::vector<std::string>& families) {
    const Pattern pattern = pattern_of(families);
    FcResult result = FcResultMatch;
    const Pattern font(FcFontMatch(nullptr, pattern.get(), &result), &FcPatternDestroy);
    FcChar8* family = nullptr;
    if (!font || FcPatternGetString(font.get(), FC_FAMILY, 0, &family) != FcResultMatch) return std::nullopt;
    Match match{reinterpret_cast<const char*>(family)};
    for (int n = 0; FcPatternGetString(font.get(), FC_FAMILY, n, &family) == FcResultMatch; ++n)
        match.is_asked = match.is_asked || FcStrCmpIgnoreCase(family, fc(families.front())) == 0;
    return match;
}

/// Letters that no font of this machine has, each once.
std::string letters_without_font(const std::string& letters) {
    const Pattern pattern = pattern_of({"sans-serif"});
    FcResult result = FcResultMatch;
    FcCharSet* known = nullptr;
    const std::unique_ptr<FcFontSet, decltype(&FcFontSetDestroy)> fonts(
        FcFontSort(nullptr, pattern.get(), FcTrue, &known, &result), &FcFontSetDestroy);
    if (!fonts || !known) return {};
    const std::unique_ptr<FcCharSet, decltype(&FcCharSetDestroy)> owned(known, &FcCharSetDestroy);
    std::string missing;
    std::set<FcChar32> told;
    const auto* at = reinterpret_cast<const FcChar8*>(letters.data());
    for (int left = static_cast<int>(letters.size()); left > 0;) {
        FcChar32 code = 0;
        const int length = FcUtf8ToUcs4(at, &code, left);
        if (length <= 0) break;
        at += length;
        left -= length;
        if (code > ' ' && !FcCharSetHasChar(known, code) && told.insert(code).second) append_utf8(missing, code);
    }
    return missing;
}

void add_fonts(const Facts& facts, const std::string& name, DecodedImage& image) {
    std::set<std::string> lists = facts.family_lists;
    if (lists.empty()) lists.insert("Times New Roman");  // librsvg's own
    for (const std::string& list : lists) {
        const std::vector<std::string> families = families_in(list);
        if (families.empty()) continue;
        const std::optional<Match> match = match_of(families);
        if (!match)
            throw InputError(fmt::format(
                "{} holds text, and this machine has no font: install one, or turn the text into paths (in Inkscape: "
                "Path, Object to Path)",
                name));
        if (match->is_asked || is_general(families.front())) continue;
        image.warnings.push_back(named_warning(
            "other-font",
            fmt::format("{}: its text asks for the font {}, which this machine has not, and is set in {}: "
                        "install it, or turn the text into paths (in Inkscape: Path, Object to Path)",
                        name, printable(families.front()), printable(match->family))));
    }
    if (const std::string missing = letters_without_font(facts.letters); !missing.empty())
        image.warnings.push_back(named_warning(
            "other-font",
            fmt::format("{}: no font of this machine has the letters {}, which come out as boxes: install "
                        "one, or turn the text into paths (in Inkscape: Path, Object to Path)",
                        name, printable(missing))));
}

}  // namespace

void add_svg_facts(std::string_view text, const std::string& name, DecodedImage& image) {
    const Facts facts = facts_of(text);
    if (facts.has_text) add_fonts(facts, name, image);
    if (!facts.files.empty())
        image.lost_colour = fmt::format(
            "{} shows what is in another file ({}), which is not opened: put it into the drawing (in "
            "Inkscape: Extensions, Images, Embed Images), or save that as PNG.",
            name, printable(facts.files.front()));
    else if (facts.has_html && !facts.has_choice)
        image.lost_colour = fmt::format(
            "{} holds text as HTML (foreignObject), which is not drawn: export it with text as paths, or as PNG.",
            name);
}

}  // namespace voxtone::io
