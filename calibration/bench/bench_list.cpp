// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/bench/bench_list.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/printable.h"
#include "calibration/patches/table_cells.h"
#include "io/disk/named_path.h"
#include "io/files/csv_table.h"
#include "io/files/utf8.h"
#include "io/files/whole_file.h"

namespace voxtone::calibration {
namespace {

constexpr std::uint64_t most_list_bytes = 1u << 20;
constexpr std::string_view list_header = "file,shows,resin,thickness_mm";

class ListReader {
public:
    ListReader(std::string_view text, const std::string& source) : text_(text), source_(source) {}

    BenchList read() {
        io::CsvReader csv(text_, io::CsvRules::lenient);
        line_ = csv.header().line;
        const std::vector<std::string>& names = csv.header().cells;
        if (names.empty()) throw InputError(fmt::format("{}: no header line; expected {}.", source_, list_header));
        if (const std::string header = fmt::format("{}", fmt::join(names, ",")); header != list_header)
            fail(fmt::format("\"{}\", expected the header {}", printable(header.substr(0, 60)), list_header));
        io::CsvRow cells;
        for (std::string fault; csv.next(cells, fault);) {
            line_ = cells.line;
            row({cells.cells.begin(), cells.cells.end()});
        }
        if (list_.checker.empty()) missing("checker", "the photograph of a colour checker, which tells what white is");
        if (list_.sheet.empty()) missing("sheet", "the printed edge without a slab, which tells its white and black");
        if (list_.slabs.empty()) missing("slab", "at least one photograph of a slab");
        return std::move(list_);
    }

private:
    [[noreturn]] void fail(const std::string& what) const {
        throw InputError(fmt::format("{}: line {}: {}.", source_, line_, what));
    }
    [[noreturn]] void missing(const char* word, const char* what) const {
        throw InputError(fmt::format("{}: no line shows \"{}\": {}.", source_, word, what));
    }

    void one(std::string& place, std::string_view file, std::string_view shows) const {
        if (!place.empty()) fail(fmt::format("a second photograph shows the {}; one is used", shows));
        place = file;
    }

    void row(const std::vector<std::string_view>& cells) {
        if (cells.size() < 2 || cells.size() > 4)
            fail(fmt::format("{} cells, but the header has 4 ({})", cells.size(), list_header));
        const std::string_view file = cells[0], shows = cells[1];
        const auto more = [&](std::size_t k) { return k < cells.size() ? cells[k] : std::string_view(); };
        if (file.empty()) fail("no file");
        if (shows == "slab") {
            list_.slabs.push_back(slab(file, more(2), more(3)));
            return;
        }
        if (!more(2).empty() || !more(3).empty())
            fail(fmt::format("resin and thickness belong to a slab, but the line shows \"{}\"", printable(shows)));
        if (shows == "checker")
            one(list_.checker, file, shows);
        else if (shows == "paper")
            one(list_.paper, file, shows);
        else if (shows == "sheet")
            one(list_.sheet, file, shows);
        else
            fail(fmt::format("shows \"{}\"; expected checker, paper, sheet or slab", printable(shows.substr(0, 40))));
    }

    [[nodiscard]] SlabPhotograph slab(std::string_view file, std::string_view resin, std::string_view mm) const {
        if (resin.empty() || resin.size() > 32 || printable(resin) != resin)
            fail("the resin of a slab is a short word such as C or W");
        SlabPhotograph result{std::string(file), std::string(resin), 0};
        result.thickness_mm = number_with_comma(mm).value_or(0);
        if (!(result.thickness_mm >= 0.05 && result.thickness_mm <= 10))
            fail(fmt::format("thickness_mm is \"{}\"; expected the slab's thickness in mm, from 0.05 to 10",
                             printable(mm.substr(0, 40))));
        for (const SlabPhotograph& other : list_.slabs)
            if (other.file == file) fail(fmt::format("{} is listed twice", printable(file)));
        return result;
    }

    std::string_view text_;
    const std::string& source_;
    std::size_t line_ = 0;
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
    const std::vector<std::uint8_t> bytes = io::read_whole_file(file, most_list_bytes);
    BenchList list =
        parse_bench_list(io::text_as_utf8({reinterpret_cast<const char*>(bytes.data()), bytes.size()}), file.string());
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
