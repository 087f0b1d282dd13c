// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/pictures/picture_series.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <compare>
#include <map>
#include <set>
#include <string_view>

#include <fmt/format.h>

#include "base/counted.h"

namespace voxtone::io {

namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }

std::string lower(std::string text) {
    for (char& c : text)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c + 32);
    return text;
}

/// As it is written, of any length.
struct Number {
    bool negative = false;
    std::string whole, fraction;  ///< digits; of the whole without leading zeros
    std::size_t width = 0;        ///< digits of the whole, with them

    [[nodiscard]] bool has_zeros() const { return width > whole.size(); }
    [[nodiscard]] double value() const {
        const std::string text = whole + "." + fraction + "0";
        double value = 0;
        std::from_chars(text.data(), text.data() + text.size(), value);
        return negative ? -value : value;
    }
    [[nodiscard]] std::weak_ordering operator<=>(const Number& other) const {
        if (negative != other.negative) return negative ? std::weak_ordering::less : std::weak_ordering::greater;
        const auto by_size =
            std::tuple(whole.size(), std::string_view(whole), std::string_view(fraction)) <=>
            std::tuple(other.whole.size(), std::string_view(other.whole), std::string_view(other.fraction));
        return negative ? 0 <=> by_size : by_size;
    }
    bool operator==(const Number& other) const { return (*this <=> other) == 0; }
};

/// A file's name as text and numbers: a text, a number, a text, ...
struct CutName {
    std::string name, extension;
    std::vector<std::string> texts;
    std::vector<Number> numbers;

    [[nodiscard]] std::string shape() const {
        std::string all;
        for (const std::string& text : texts) all += text + '\n';
        return all;
    }
};

/// No letter, digit or sign stands before the minus at `at`.
bool is_sign(std::string_view base, std::size_t at) {
    constexpr std::string_view before = "_ =(";
    return base[at] == '-' && (at == 0 || before.find(base[at - 1]) != base.npos);
}

/// The number that begins at `at`.
Number number_at(std::string_view base, std::size_t& at) {
    Number number;
    const auto digits = [&] {
        const std::size_t begin = at;
        while (at < base.size() && is_digit(base[at])) ++at;
        return std::string(base.substr(begin, at - begin));
    };
    number.whole = digits();
    number.width = number.whole.size();
    number.whole.erase(0, std::min(number.whole.find_first_not_of('0'), number.whole.size() - 1));
    if (at + 1 < base.size() && (base[at] == '.' || base[at] == ',') && is_digit(base[at + 1])) {
        ++at;
        number.fraction = digits();
    }
    return number;
}

CutName cut(const std::string& name) {
    CutName result{name, {}, {""}, {}};
    const std::size_t dot = name.rfind('.');
    const std::string base = name.substr(0, dot);
    if (dot != name.npos) result.extension = lower(name.substr(dot + 1));
    for (std::size_t at = 0; at < base.size();) {
        const bool negative = is_sign(base, at) && at + 1 < base.size() && is_digit(base[at + 1]);
        if (!negative && !is_digit(base[at])) {
            result.texts.back() += base[at++];
            continue;
        }
        at += negative;
        result.numbers.push_back(number_at(base, at));
        result.numbers.back().negative = negative;
        result.texts.emplace_back();
    }
    return result;
}

struct Numbered {
    const CutName* file;
    Number number;
};
using Series = std::vector<Numbered>;

std::size_t distinct(const std::vector<const CutName*>& group, std::size_t column) {
    std::set<Number> values;
    for (const CutName* file : group) values.insert(file->numbers[column]);
    return values.size();
}

/// Which number counts: that which differs most; of several such a whole one, the last.
std::size_t counting_column(const std::vector<const CutName*>& group) {
    std::size_t best = 0, most = 0;
    bool best_is_whole = false;
    for (std::size_t column = 0; column < group[0]->numbers.size(); ++column) {
        const std::size_t count = distinct(group, column);
        const bool is_whole = std::ranges::all_of(group, [&](auto* f) { return f->numbers[column].fraction.empty(); });
        if (count > most || (count == most && (is_whole || !best_is_whole))) {
            best = column;
            best_is_whole = is_whole;
        }
        most = std::max(most, count);
    }
    return best;
}

/// "999", "1.000", "1.001": what looks like fractions are thousands.
bool has_thousands(const Series& series) {
    bool any = false;
    for (const auto& [file, number] : series) {
        if (number.whole.size() > 3) return false;
        if (number.fraction.empty()) continue;
        if (number.fraction.size() != 3 || number.whole == "0") return false;
        any = true;
    }
    return any && std::ranges::any_of(series, [](const Numbered& n) { return n.number.fraction.empty(); });
}

void join_thousands(Series& series) {
    for (auto& [file, number] : series) {
        if (number.fraction.empty()) continue;
        number.whole += number.fraction;
        number.width += number.fraction.size();
        number.fraction.clear();
    }
}

/// Series of files whose names have the same text, by their other numbers.
std::vector<Series> split(const std::vector<const CutName*>& group) {
    const std::size_t column = counting_column(group);
    const bool tells_all = distinct(group, column) == group.size();
    std::map<std::string, Series> by_others;
    for (const CutName* file : group) {
        std::string others;
        for (std::size_t i = 0; i < file->numbers.size() && !tells_all; ++i)
            if (const Number& n = file->numbers[i]; i != column)
                others += (n.negative ? "-" : "") + n.whole + "." + n.fraction + " ";
        by_others[others].push_back({file, file->numbers[column]});
    }
    std::vector<Series> all;
    for (auto& [others, series] : by_others) {
        if (has_thousands(series)) join_thousands(series);
        std::ranges::sort(series, [](const Numbered& a, const Numbered& b) {
            return std::tie(a.number, a.file->name) < std::tie(b.number, b.file->name);
        });
        all.push_back(std::move(series));
    }
    return all;
}

/// All series of numbered files that `takes` takes; largest first, then by name.
template <class Takes>
std::vector<Series> all_series(const std::vector<CutName>& files, Takes&& takes) {
    std::map<std::string, std::vector<const CutName*>> groups;
    for (const CutName& file : files)
        if (!file.name.starts_with('.') && !file.numbers.empty() && takes(file))
            groups[lower(file.shape()) + file.extension].push_back(&file);
    std::vector<Series> all;
    for (const auto& [shape, group] : groups)
        for (Series& series : split(group)) all.push_back(std::move(series));
    std::ranges::stable_sort(all, [](const Series& a, const Series& b) {
        return a.size() != b.size() ? a.size() > b.size() : a[0].file->name < b[0].file->name;
    });
    return all;
}

std::vector<CutName> cut_all(std::span<const std::string> names) {
    std::vector<CutName> files;
    for (const std::string& name : names) files.push_back(cut(name));
    std::ranges::sort(files, {}, &CutName::name);
    return files;
}

bool is_png(const CutName& file) { return file.extension == "png"; }

/// Of files with one number that which is written as most others are: their letters, then their zeros.
std::vector<std::string> each_number_once(const Series& series) {
    std::map<std::string, std::size_t> shapes;
    std::map<bool, std::size_t> by_zeros;
    for (const auto& [file, number] : series) ++shapes[file->shape() + file->name.substr(file->name.rfind('.'))];
    for (const auto& [file, number] : series) ++by_zeros[number.has_zeros()];
    const auto usual = [&](const Numbered& n) {
        return std::pair(shapes.at(n.file->shape() + n.file->name.substr(n.file->name.rfind('.'))),
                         by_zeros.at(n.number.has_zeros()));
    };
    std::vector<std::string> names;
    for (std::size_t i = 0; i < series.size();) {
        std::size_t best = i;
        const std::size_t first = i;
        for (; i < series.size() && series[i].number == series[first].number; ++i)
            if (usual(series[i]) > usual(series[best])) best = i;
        names.push_back(series[best].file->name);
    }
    return names;
}

/// The one series that `names` are.
Series series_of(const std::vector<CutName>& files) {
    std::vector<Series> all = all_series(files, is_png);
    return all.empty() ? Series() : std::move(all.front());
}

/// The usual difference of neighbours; where many are missing, the least.
double step_of(const Series& series) {
    std::vector<double> steps;
    for (std::size_t i = 1; i < series.size(); ++i)
        steps.push_back(series[i].number.value() - series[i - 1].number.value());
    if (steps.empty()) return 0;
    std::ranges::sort(steps);
    const double least = steps.front(), median = steps[(steps.size() - 1) / 2];
    constexpr double rounding = 1.6;  // heights of a micrometre or two that were rounded
    return least * rounding < median ? least : median;
}

/// A run of missing numbers.
struct Gap {
    std::string from, to;
    const CutName *before, *behind;
    std::uint64_t numbers = 0;
};

std::vector<Gap> gaps_of(const Series& series) {
    constexpr double most_of_a_step = 1.6;
    const double step = step_of(series);
    std::vector<Gap> gaps;
    for (std::size_t i = 1; step > 0 && i < series.size(); ++i) {
        const Number &before = series[i - 1].number, &behind = series[i].number;
        const double wide = behind.value() - before.value();
        if (wide <= most_of_a_step * step) continue;
        const double missing = std::clamp(std::round(wide / step) - 1, 1.0, 1e15);
        const std::size_t digits = std::max(before.fraction.size(), behind.fraction.size());
        const auto shown = [&](double value) { return fmt::format("{:.{}f}", value, digits); };
        gaps.push_back({shown(before.value() + step), shown(before.value() + missing * step), series[i - 1].file,
                        series[i].file, static_cast<std::uint64_t>(missing)});
    }
    return gaps;
}

std::string listed(const std::vector<Gap>& gaps) {
    constexpr std::size_t most = 8;
    std::string text;
    for (std::size_t i = 0; i < std::min(gaps.size(), most); ++i) {
        text += fmt::format("{}{}", i > 0 ? ", " : "", gaps[i].from);
        if (gaps[i].numbers > 1) text += fmt::format("{}{}", gaps[i].numbers == 2 ? ", " : " to ", gaps[i].to);
    }
    if (gaps.size() > most) text += fmt::format(" and {} more gaps", gaps.size() - most);
    return text;
}

std::string from_to(std::span<const std::string> names) {
    if (names.size() == 1) return names[0];
    return names.front() + (names.size() == 2 ? " and " : " to ") + names.back();
}

/// "60 files are left out ..."
std::string left_out(std::span<const std::string> names, std::string_view why) {
    return fmt::format("{} {} left out {}: {}", counted(names.size(), "file"), names.size() == 1 ? "is" : "are", why,
                       from_to(names));
}

bool is_other_picture(const CutName& file) {
    static constexpr std::array<std::string_view, 22> endings{
        "tif", "tiff", "bmp", "jpg", "jpeg", "gif",  "webp", "tga", "pbm", "pgm", "ppm",
        "pnm", "svg",  "dxf", "slc", "jp2",  "heic", "avif", "jxl", "exr", "dcm", "apng"};
    return std::ranges::find(endings, file.extension) != endings.end();
}

/// What lies beside a series, each file under the first reason that fits.
struct LeftOut {
    std::vector<std::string> twice, other_kind, without_number;
    std::vector<std::vector<std::string>> other_series;
};

LeftOut sort_strangers(const Series& series, const std::vector<CutName>& strangers) {
    LeftOut left;
    std::set<Number> taken;
    for (const auto& [file, number] : series) taken.insert(number);
    const std::string shape = lower(series[0].file->shape());
    for (const CutName& file : strangers) {
        const bool same_shape = lower(file.shape()) == shape;
        if (file.name.starts_with('.')) continue;
        if (!is_png(file) && (same_shape || (is_other_picture(file) && !file.numbers.empty())))
            left.other_kind.push_back(file.name);
        else if (is_png(file) && file.numbers.empty())
            left.without_number.push_back(file.name);
    }
    for (const Series& other : all_series(strangers, is_png)) {
        std::vector<std::string> names;
        for (const auto& [file, number] : other) names.push_back(file->name);
        const bool same = lower(other[0].file->shape()) == shape &&
                          std::ranges::all_of(other, [&](const Numbered& n) { return taken.contains(n.number); });
        // A number of the name that tells series apart is told by the names.
        const bool other_numbers = series[0].file->numbers.size() > 1;
        if (same && !other_numbers)
            left.twice.insert(left.twice.end(), names.begin(), names.end());
        else
            left.other_series.push_back(std::move(names));
    }
    return left;
}

}  // namespace

PictureSeries find_series(std::span<const std::string> files) {
    const std::vector<CutName> all = cut_all(files);
    PictureSeries result;
    if (const Series series = series_of(all); !series.empty()) result.names = each_number_once(series);
    const std::set<std::string> taken(result.names.begin(), result.names.end());
    for (const CutName& file : all)
        if (!taken.contains(file.name)) result.strangers.push_back(file.name);
    return result;
}

std::vector<std::string> series_gaps(std::span<const std::string> names) {
    const std::vector<CutName> files = cut_all(names);
    const std::vector<Gap> gaps = gaps_of(series_of(files));
    if (gaps.empty()) return {};
    std::uint64_t missing = 0;
    for (const Gap& gap : gaps) missing += gap.numbers;
    if (missing == 1)
        return {
            fmt::format("number {} is missing between {} and {}: the print is taken to have no such layer, and what "
                        "lies above it to be one layer lower; add the file if it was lost",
                        gaps[0].from, gaps[0].before->name, gaps[0].behind->name)};
    return {
        fmt::format("{} numbers are missing ({}), the first behind {}: the print is taken to have no such layers, "
                    "and what lies above them to be lower; add the files if they were lost",
                    missing, listed(gaps), gaps[0].before->name)};
}

std::vector<std::string> series_doubts(std::span<const std::string> names, std::span<const std::string> strangers) {
    const std::vector<CutName> files = cut_all(names), others = cut_all(strangers);
    const Series series = series_of(files);
    if (series.empty()) return {};
    std::vector<std::string> doubts;
    const auto below_zero = std::ranges::count_if(series, [](const Numbered& n) { return n.number.negative; });
    if (below_zero > 0)
        doubts.push_back(
            fmt::format("{} of {} layers have numbers below 0: {} was taken for the lowest and {} for the "
                        "highest; if the minus is a dash, rename the files",
                        below_zero, series.size(), series.front().file->name, series.back().file->name));
    const LeftOut left = sort_strangers(series, others);
    if (!left.twice.empty())
        doubts.push_back(left_out(left.twice, "for a number that is there already") +
                         "; if they belong to the print, give each layer a number of its own");
    constexpr std::size_t most_named = 4;
    for (std::size_t i = 0; i < std::min(left.other_series.size(), most_named); ++i)
        doubts.push_back(
            left_out(left.other_series[i], "as another series") +
            fmt::format("; if they belong to the print, name them like {}, else move them away", series[0].file->name));
    if (left.other_series.size() > most_named)
        doubts.push_back(
            fmt::format("{} more series of files are left out likewise", left.other_series.size() - most_named));
    if (!left.other_kind.empty())
        doubts.push_back(left_out(left.other_kind, "as no PNG") + "; if they belong to the print, save them as PNG");
    if (!left.without_number.empty())
        doubts.push_back(left_out(left.without_number, "for want of a number") +
                         "; if they belong to the print, give them the number of their layer");
    return doubts;
}

std::string other_pictures(std::span<const std::string> files) {
    const std::vector<CutName> all = cut_all(files);
    const std::vector<Series> series = all_series(all, is_other_picture);
    if (series.empty()) return {};
    return fmt::format("{} like {}", counted(series[0].size(), "file"), series[0][0].file->name);
}

}  // namespace voxtone::io
