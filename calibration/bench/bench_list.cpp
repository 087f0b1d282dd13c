// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/bench/bench_list.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/printable.h"
#include "calibration/tables/table_cells.h"
#include "calibration/tables/text_table.h"
#include "io/disk/named_path.h"

namespace voxtone::calibration {
namespace {

constexpr std::uint64_t most_list_bytes = 1u << 20;
constexpr std::string_view list_header = "file,shows,resin,thickness_mm";

class ListReader {
public:
    ListReader(std::string_view text, const std::string& source)
        : csv_(text, source, fmt::format("expected {}", list_header), {}, CsvText::ShortRows::filled) {}

    BenchList read() {
        if (const std::string header = fmt::format("{}", fmt::join(csv_.names(), ",")); header != list_header)
            csv_.fail(fmt::format("\"{}\", expected the header {}", printable(header.substr(0, 60)), list_header));
        while (csv_.next()) row(csv_.cells());
        if (list_.checker.empty()) missing("checker", "the photograph of a colour checker, which tells what white is");
        if (list_.sheet.empty()) missing("sheet", "the printed edge without a slab, which tells its white and black");
        if (list_.slabs.empty()) missing("slab", "at least one photograph of a slab");
        return std::move(list_);
    }

private:
    [[noreturn]] void missing(const char* word, const char* what) const {
        throw InputError(fmt::format("{}: no line shows \"{}\": {}.", csv_.source(), word, what));
    }

    void one(std::string& place, std::string_view file, std::string_view shows) const {
        if (!place.empty()) csv_.fail(fmt::format("a second photograph shows the {}; one is used", shows));
        place = file;
    }

    void row(const std::vector<std::string>& cells) {
        const std::string &file = cells[0], &shows = cells[1];
        if (file.empty()) csv_.fail(0, "no file");
        if (shows == "slab") {
            list_.slabs.push_back(slab(file, cells[2]));
            return;
        }
        if (!cells[2].empty() || !cells[3].empty())
            csv_.fail(fmt::format("resin and thickness belong to a slab, but the line shows \"{}\"", printable(shows)));
        if (shows == "checker")
            one(list_.checker, file, shows);
        else if (shows == "paper")
            one(list_.paper, file, shows);
        else if (shows == "sheet")
            one(list_.sheet, file, shows);
        else
            csv_.fail(1, fmt::format("{}; expected checker, paper, sheet or slab", shown(shows)));
    }

    [[nodiscard]] SlabPhotograph slab(const std::string& file, const std::string& resin) const {
        if (resin.empty() || resin.size() > 32 || printable(resin) != resin)
            csv_.fail(2, "the resin of a slab is a short word such as C or W");
        const SlabPhotograph result{file, resin, csv_.number(3)};
        if (!(result.thickness_mm >= 0.05 && result.thickness_mm <= 10))
            csv_.fail(3, fmt::format("{}; expected the slab's thickness in mm, from 0.05 to 10", result.thickness_mm));
        for (const SlabPhotograph& other : list_.slabs)
            if (other.file == file) csv_.fail(fmt::format("{} is listed twice", printable(file)));
        return result;
    }

    CsvText csv_;
    BenchList list_;
};

}  // namespace

BenchList parse_bench_list(std::string_view text, const std::string& source) {
    BenchList list = ListReader(text, source).read();
    // Those of one slab beside each other, in the order in which slabs are met first.
    std::vector<SlabPhotograph> sorted;
    for (const SlabPhotograph& first : list.slabs) {
        const auto same = [&](const SlabPhotograph& s) {
            return s.resin == first.resin && s.thickness_mm == first.thickness_mm;
        };
        if (std::ranges::none_of(sorted, same)) std::ranges::copy_if(list.slabs, std::back_inserter(sorted), same);
    }
    list.slabs = std::move(sorted);
    return list;
}

BenchList read_bench_list(const std::filesystem::path& file) {
    BenchList list = parse_bench_list(read_text(file, most_list_bytes), file.string());
    const auto seen = [&](const std::string& name) { return io::named_path(file.parent_path(), name).string(); };
    for (std::string* name : {&list.checker, &list.paper, &list.sheet})
        if (!name->empty()) *name = seen(*name);
    for (SlabPhotograph& slab : list.slabs) slab.file = seen(slab.file);
    return list;
}

std::string bench_list_text(const BenchList& list) {
    std::string text(list_header);
    text += fmt::format("\n{},checker,,\n", list.checker);
    if (!list.paper.empty()) text += fmt::format("{},paper,,\n", list.paper);
    text += fmt::format("{},sheet,,\n", list.sheet);
    for (const SlabPhotograph& slab : list.slabs)
        text += fmt::format("{},slab,{},{}\n", slab.file, slab.resin, slab.thickness_mm);
    return text;
}

}  // namespace voxtone::calibration
