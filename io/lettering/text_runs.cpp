// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/lettering/text_runs.h"

#include <fribidi.h>
#include <hb.h>

#include <memory>
#include <numeric>

#include <fmt/core.h>

#include "base/error.h"
#include "base/printable.h"

namespace voxtone::io {

namespace {

/// Code points, and the bytes at which they begin, with the end of the text behind them.
struct Letters {
    std::vector<FriBidiChar> code;
    std::vector<std::size_t> at;
};

Letters letters_of(const std::string& line) {
    struct DestroyLetters {
        void operator()(hb_buffer_t* buffer) const { hb_buffer_destroy(buffer); }
    };
    if (valid_utf8(line) != line)
        throw InputError(
            fmt::format("\"{}\" is no UTF-8, so that it is not known which letters it has: save it as UTF-8", line));
    const std::unique_ptr<hb_buffer_t, DestroyLetters> buffer(hb_buffer_create());
    hb_buffer_add_utf8(buffer.get(), line.data(), int(line.size()), 0, int(line.size()));
    unsigned count = 0;
    const hb_glyph_info_t* info = hb_buffer_get_glyph_infos(buffer.get(), &count);
    Letters letters;
    for (unsigned i = 0; i < count; ++i) {
        letters.code.push_back(info[i].codepoint);
        letters.at.push_back(info[i].cluster);
    }
    letters.at.push_back(line.size());
    return letters;
}

struct Levels {
    std::vector<FriBidiLevel> level;         ///< of each letter; odd: from right to left
    std::vector<FriBidiStrIndex> from_left;  ///< letters as they are seen
};

Levels levels_of(const std::vector<FriBidiChar>& code) {
    const auto count = FriBidiStrIndex(code.size());
    std::vector<FriBidiCharType> types(code.size());
    std::vector<FriBidiBracketType> brackets(code.size());
    fribidi_get_bidi_types(code.data(), count, types.data());
    fribidi_get_bracket_types(code.data(), count, types.data(), brackets.data());
    Levels levels{std::vector<FriBidiLevel>(code.size()), std::vector<FriBidiStrIndex>(code.size())};
    std::iota(levels.from_left.begin(), levels.from_left.end(), 0);
    FriBidiParType direction = FRIBIDI_PAR_ON;  // as the first strong letter
    if (fribidi_get_par_embedding_levels_ex(types.data(), brackets.data(), count, &direction, levels.level.data()) ==
            0 ||
        fribidi_reorder_line(0, types.data(), count, 0, direction, levels.level.data(), nullptr,
                             levels.from_left.data()) == 0)
        throw ResourceError("the order of a text's letters cannot be found: there is no memory");
    return levels;
}

bool has_own_script(hb_script_t script) {
    return script != HB_SCRIPT_COMMON && script != HB_SCRIPT_INHERITED && script != HB_SCRIPT_UNKNOWN;
}

/// Digits, blanks and marks go with the letters before them, those at the beginning of a level with what follows.
std::vector<hb_script_t> scripts_of(const Letters& letters, const std::vector<FriBidiLevel>& level) {
    std::vector<hb_script_t> scripts;
    for (const FriBidiChar code : letters.code)
        scripts.push_back(hb_unicode_script(hb_unicode_funcs_get_default(), code));
    const auto take_from = [&](std::size_t to, std::size_t from) {
        if (level[to] == level[from] && !has_own_script(scripts[to]) && has_own_script(scripts[from]))
            scripts[to] = scripts[from];
    };
    for (std::size_t i = 1; i < scripts.size(); ++i) take_from(i, i - 1);
    for (std::size_t i = scripts.size(); i-- > 1;) take_from(i - 1, i);
    return scripts;
}

}  // namespace

std::vector<TextRun> text_runs(const std::string& line) {
    const Letters letters = letters_of(line);
    if (letters.code.empty()) return {};
    const Levels levels = levels_of(letters.code);
    const std::vector<hb_script_t> scripts = scripts_of(letters, levels.level);
    std::vector<TextRun> runs;
    std::vector<std::size_t> run_of;  // of each letter
    for (std::size_t i = 0; i < letters.code.size(); ++i) {
        if (i == 0 || levels.level[i] != levels.level[i - 1] || scripts[i] != scripts[i - 1])
            runs.push_back({letters.at[i], letters.at[i], levels.level[i] % 2 != 0, std::uint32_t(scripts[i])});
        runs.back().end = letters.at[i + 1];
        run_of.push_back(runs.size() - 1);
    }
    // Letters of one run stand together.
    std::vector<TextRun> from_left;
    std::vector<bool> taken(runs.size());
    for (const FriBidiStrIndex letter : levels.from_left) {
        const std::size_t run = run_of[std::size_t(letter)];
        if (!taken[run]) from_left.push_back(runs[run]);
        taken[run] = true;
    }
    return from_left;
}

}  // namespace voxtone::io
