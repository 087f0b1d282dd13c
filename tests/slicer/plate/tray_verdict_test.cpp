// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/plate/tray_verdict.h"

#include <string>
#include <utility>

#include <catch2/catch.hpp>

using namespace voxtone;
using io::VerdictLevel;

namespace {

/// Bodies "a", "b" ... of these levels.
io::ReportVerdict verdict(const std::vector<VerdictLevel>& levels) {
    std::vector<io::ReportPart> rows(levels.size());
    std::vector<const io::ReportPart*> bodies;
    for (std::size_t n = 0; n < rows.size(); ++n) {
        rows[n].name = std::string(1, char('a' + n));
        rows[n].level = levels[n];
        bodies.push_back(&rows[n]);
    }
    return slicer::tray_verdict(bodies);
}

}  // namespace

TEST_CASE("A tray is as good as its worst body, and says of how many it speaks") {
    using enum VerdictLevel;
    struct Row {
        std::vector<VerdictLevel> levels;
        VerdictLevel level;
        std::string headline, why;
    };
    const std::string each = ". Each has its reason and what to try on its own page.",
                      limits = ". What limits them is on their own pages.";
    for (const auto& [levels, level, headline, why] : std::vector<Row>{
             {{good}, good, "It will look as asked", ""},
             {{good, good}, good, "All bodies will look as asked", ""},
             {{unknown, good}, good, "It will look as asked", " Not predicted: a."},
             {{good, good, unknown}, good, "All bodies will look as asked", " Not predicted: c."},
             {{fair, good, unknown, good},
              fair,
              "2 of 4 bodies will look as asked, 1 nearly",
              "a" + limits + " Not predicted: c."},
             {{fair, fair}, fair, "2 of 2 bodies will look nearly as asked", "a, b" + limits},
             {{good, bad}, bad, "1 of 2 bodies will not look as asked", "b" + each},
             {{bad, fair, bad, fair},
              bad,
              "2 of 4 bodies will not look as asked, 2 will nearly",
              "a, c; nearly: b, d" + each},
             {{unknown, bad}, bad, "1 of 2 bodies will not look as asked", "b" + each + " Not predicted: a."},
             {std::vector(7, bad), bad, "7 of 7 bodies will not look as asked", "a, b, c, d, e and 2 more" + each},
             {std::vector(5, bad), bad, "5 of 5 bodies will not look as asked", "a, b, c, d, e" + each}}) {
        const io::ReportVerdict said = verdict(levels);
        CAPTURE(headline);
        CHECK(said.level == level);
        CHECK(said.headline == headline);
        CHECK(said.why == why);
        CHECK(said.sentence == headline + "." + (why.empty() ? "" : " ") + why);
    }
    const io::ReportVerdict nothing = verdict({unknown, unknown});
    CHECK(nothing.level == unknown);
    CHECK(nothing.headline == "Nothing was predicted");
    CHECK(nothing.why.find("Not predicted") == std::string::npos);
}
