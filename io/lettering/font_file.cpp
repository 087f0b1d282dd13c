// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/lettering/font_file.h"

#include <fontconfig/fontconfig.h>

#include <algorithm>
#include <cctype>
#include <memory>

#include <fmt/core.h>

#include "base/error.h"

namespace voxtone::io {

namespace {

struct Destroy {
    void operator()(FcConfig* config) const { FcConfigDestroy(config); }
    void operator()(FcPattern* pattern) const { FcPatternDestroy(pattern); }
};
using Config = std::unique_ptr<FcConfig, Destroy>;
using Pattern = std::unique_ptr<FcPattern, Destroy>;

std::string lower(std::string text) {
    std::ranges::transform(text, text.begin(), [](unsigned char c) { return char(std::tolower(c)); });
    return text;
}

/// Whether one of the pattern's families is called so, in any case of letters.
bool has_family(const Pattern& pattern, const std::string& family) {
    FcChar8* name = nullptr;
    for (int i = 0; FcPatternGetString(pattern.get(), FC_FAMILY, i, &name) == FcResultMatch; ++i)
        if (lower(reinterpret_cast<const char*>(name)) == lower(family)) return true;
    return false;
}

}  // namespace

bool is_font_path(const std::string& name) {
    const std::string low = lower(name);
    return name.find('/') != std::string::npos || low.ends_with(".ttf") || low.ends_with(".otf") ||
           low.ends_with(".ttc") || low.ends_with(".pfb");
}

std::filesystem::path find_font(const std::string& name) {
    if (is_font_path(name)) return name;
    const Config config(FcInitLoadConfigAndFonts());
    const Pattern asked(FcNameParse(reinterpret_cast<const FcChar8*>(name.c_str())));
    if (!config || !asked) throw InputError(fmt::format("the font '{}' cannot be looked up: name its file", name));
    FcChar8* family = nullptr;
    const std::string wanted = FcPatternGetString(asked.get(), FC_FAMILY, 0, &family) == FcResultMatch
                                   ? reinterpret_cast<const char*>(family)
                                   : name;
    FcConfigSubstitute(config.get(), asked.get(), FcMatchPattern);
    FcDefaultSubstitute(asked.get());
    FcResult result = FcResultNoMatch;
    const Pattern found(FcFontMatch(config.get(), asked.get(), &result));
    FcChar8* file = nullptr;
    if (!found || !has_family(found, wanted) || FcPatternGetString(found.get(), FC_FILE, 0, &file) != FcResultMatch)
        throw InputError(fmt::format(
            "this machine has no font '{}': install it, name another one (`fc-list : family` lists them), or name a "
            "font's file (font=letters.ttf)",
            wanted));
    return reinterpret_cast<const char*>(file);
}

}  // namespace voxtone::io
