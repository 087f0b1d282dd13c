// SPDX-License-Identifier: GPL-3.0-or-later
//
// Good, fair or bad: of a whole print, by what is off everywhere on it and by nothing else.
//
// With d_i the difference as seen of cell i, a_i its area and v_i how far it can be seen (sides_seen.h), w_i = a_i v_i,
//
//   mean    m = sum w_i d_i / sum w_i
//   off     s = sum w_i [d_i > bad] / sum w_i
//   wrong   t = sum w_i [d_i > bad, or i lies in a flat area that is flecked or in a texture that is lost] / sum w_i
//   bad     where m > bad  or s > 1/2
//   fair    where m > good or t > 1/10
//   good    otherwise
//
// Why so. The level never falls where nothing of the print gets worse: m, s and t rise with every d_i and t with
// every area that is flecked or blurred. So it does not fall either where a print is made larger (light spreads
// over a fixed length, so that what is off beside edges and in thin parts is a smaller share of it), where resins reach
// more, where the loop goes on. No thing decides by itself: a rule that counts things, or the worst of them, has a
// size below which it does not see any, and a small print is forgiven what a large one is blamed for. Nor is a thing
// forgiven because it is small: each cell counts with its share. What is worst is said in a sentence of its own, and
// changes no level. A tenth is seen at once wherever it lies; of what is half off nobody says that it is as asked.
// Flecks and blur alone make no print bad: its colours are those that were asked for.
// What a page is there for decides all the same (PageVerdict): what cannot be used is no print, however near its
// colours are. A code that no scanner reads (printed_codes.h), a page whose type, most of it, cannot be read
// (type_size.h, region_verdict.h) are bad, and one of which some is gone, or a label, is not good; larger, they are
// read. A code that is read does what it is there for: where that alone would be bad its cells are off by no more than
// `good`. What it cannot see: that a face is worth more than the back of a head.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "io/report/report.h"
#include "slicer/options/resolved_job.h"

namespace voxtone::slicer {

inline constexpr double much_wrong = 0.1;  ///< of what is seen: more is not good

struct WholeVerdict {
    io::VerdictLevel level = io::VerdictLevel::good;
    double mean = 0;              ///< m, CIEDE2000
    double wrong_share = 0;       ///< t, in [0, 1]
    double off_share = 0;         ///< s, in [0, 1]
    std::string decided_by = {};  ///< what gives the level whatever its colours are: a clause; empty: these do
};

/// What can be read of a picture.
struct PageVerdict {
    std::string useless = {};                     ///< what it is of no use for: a clause; empty: nothing
    std::string lost = {};                        ///< what of it is gone: a clause; empty: nothing
    std::vector<char> served;                     ///< per cell: in a code that is read; empty: none is
    double smallest_type_mm = 0, type_times = 1;  ///< size of the smallest face, and how much larger nearly all is read
    double module_mm = 0;                         ///< of codes that are not read, the smallest that is known; 0: none
};

/// One each per cell. `spoilt`: 1 where the cell lies in such an area; empty: none does. Nothing weighs anything:
/// good.
[[nodiscard]] WholeVerdict judge_whole(std::span<const double> difference, std::span<const double> weight,
                                       std::span<const char> spoilt, const VerdictLimits& limits,
                                       const PageVerdict& page = {});

/// "On the whole fair, 2.9: ..."; what the level comes of where the mean alone would not give it.
[[nodiscard]] std::string opening_of(const WholeVerdict& whole, const VerdictLimits& limits);

/// The smallest difference that this part of all weight does not exceed.
[[nodiscard]] double weighted_percentile(std::span<const double> difference, std::span<const double> weight,
                                         double part);

}  // namespace voxtone::slicer
