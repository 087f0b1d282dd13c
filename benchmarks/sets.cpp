// SPDX-License-Identifier: GPL-3.0-or-later
#include "benchmarks/sets.h"

#include "io/files/json_object.h"
#include "tests/places.h"

namespace voxtone::benchmarks {
namespace {

std::vector<SetEntry> entries(const char* kind) {
    constexpr double least_mm = 1, most_mm = 1000;
    const auto all = io::JsonObject::read(std::filesystem::path(test::source_dir()) / "benchmarks/sets.json");
    all.allow_only({"rules", "pictures", "bodies", "pages"});
    std::vector<SetEntry> found;
    for (const io::JsonObject& entry : all.objects(kind)) {
        entry.allow_only({"name", "set", "group", "file", "size_mm", "shows", "licence", "source", "sha256"});
        const std::string set = entry.text("set");
        if (set != "fitting" && set != "held-out") entry.fail("set", "must be fitting or held-out");
        found.push_back({entry.text("name"), entry.text("file"), set == "held-out",
                         entry.has("size_mm") ? entry.number("size_mm", least_mm, most_mm) : 0});
        for (const char* said : {"licence", "source", "shows"}) (void)entry.text(said);
        constexpr std::size_t digits = 64;
        if (entry.text("sha256").size() != digits) entry.fail("sha256", "must have 64 hexadecimal digits");
    }
    return found;
}

}  // namespace

std::vector<SetEntry> pictures() { return entries("pictures"); }
std::vector<SetEntry> bodies() { return entries("bodies"); }

bool is_held_out_page(const std::string& name) {
    const auto all = io::JsonObject::read(std::filesystem::path(test::source_dir()) / "benchmarks/sets.json");
    for (const io::JsonObject& page : all.objects("pages"))
        if (page.text("name") == name) return page.text("set") == "held-out";
    all.fail("pages", "must name the page " + name);
}

}  // namespace voxtone::benchmarks
