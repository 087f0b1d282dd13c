// SPDX-License-Identifier: GPL-3.0-or-later
//
// How much of a plate parts take by their outlines, against their boxes. Usage: nesting_benchmark MODEL...; each model
// is taken in turn, 20 to 60 mm large, until there are 40 outlines; the plate is that of a J750. Columns of the plate
// up to the rightmost part are what a jetting printer passes over. First fit by boxes takes the largest box first and
// lays it at the first free place, from the left and from the front.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <vector>

#include "slicer/part/opened_job.h"
#include "slicer/plate/nesting.h"
#include "slicer/plate/part_outline.h"

using namespace voxtone;
using namespace voxtone::slicer;

namespace {

constexpr int outlines = 40;

Outline outline_of_model(const char* model, double size_mm) {
    SliceOptions options;
    options.model = model;
    options.out = "unused";
    options.size_mm = size_mm;
    const OpenedJob job = open_job(options);
    Progress progress;
    return outline_of(prepare_body(job.options, job.printer, progress));
}

Outline box_of(const Outline& outline) {
    Outline box(outline.width(), outline.height());
    for (int x = 0; x < box.width(); ++x)
        for (int y = 0; y < box.height(); ++y) box.set(x, y);
    return box;
}

/// Columns up to the right end of the rightmost; nothing where one found no room.
std::optional<int> columns(const std::vector<NestItem>& items, const std::array<int, 2>& plate, int gap) {
    int most = 0;
    const auto places = nest(items, plate, gap);
    for (std::size_t i = 0; i < items.size(); ++i) {
        if (!places[i]) return std::nullopt;
        most = std::max(most, places[i]->x + items[i].turns[std::size_t(places[i]->turn)].width());
    }
    return most;
}

std::optional<int> first_fit(std::vector<std::array<int, 2>> boxes, const std::array<int, 2>& plate, int gap) {
    std::ranges::stable_sort(boxes, [](const auto& a, const auto& b) { return a[0] * a[1] > b[0] * b[1]; });
    struct Laid {
        int x, y, width, height;
    };
    std::vector<Laid> laid;
    int most = 0;
    for (const auto& [width, height] : boxes) {
        const auto free = [&, w = width, h = height](int x, int y) {
            return std::ranges::none_of(laid, [&](const Laid& other) {
                return x < other.x + other.width + gap && other.x < x + w + gap && y < other.y + other.height + gap &&
                       other.y < y + h + gap;
            });
        };
        std::optional<std::array<int, 2>> at;
        for (int x = 0; x + width <= plate[0] && !at; ++x)
            for (int y = 0; y + height <= plate[1] && !at; ++y)
                if (free(x, y)) at = {x, y};
        if (!at) return std::nullopt;
        laid.push_back({(*at)[0], (*at)[1], width, height});
        most = std::max(most, (*at)[0] + width);
    }
    return most;
}

void say(const char* what, std::optional<int> columns, const std::array<int, 2>& plate, double seconds,
         double against) {
    if (!columns) {
        std::printf("%-34s not all found room\n", what);
        return;
    }
    const double mm2 = *columns * nest_cell_mm * plate[1] * nest_cell_mm;
    std::printf("%-34s %6.1f mm  %8.0f mm2  %5.1f %%  %.2f s\n", what, *columns * nest_cell_mm, mm2,
                against > 0 ? 100 * (*columns / against - 1) : 0.0, seconds);
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2) {
        std::fprintf(stderr, "usage: nesting_benchmark MODEL...\n");
        return 2;
    }
    const std::array<int, 2> plate{cells_within(490), cells_within(390)};
    const int gap = cells_above(2);
    std::vector<NestItem> by_outline, turned, by_box;
    std::vector<std::array<int, 2>> boxes;
    double area = 0;
    for (int n = 0; n < outlines; ++n) {
        const Outline outline = outline_of_model(argv[1 + n % (argc - 1)], 20 + 40.0 * ((7 * n) % outlines) / outlines);
        area += double(outline.area()) * nest_cell_mm * nest_cell_mm;
        boxes.push_back({outline.width(), outline.height()});
        by_box.push_back({{box_of(outline)}, std::size_t(n)});
        by_outline.push_back({{outline}, std::size_t(n)});
        turned.push_back({{outline, outline.turned(1), outline.turned(2), outline.turned(3)}, std::size_t(n)});
    }
    std::printf("%d outlines of %d models, %.0f mm2; plate of %.0f x %.0f mm, gap of %.1f mm\n", outlines, argc - 1,
                area, plate[0] * nest_cell_mm, plate[1] * nest_cell_mm, gap * nest_cell_mm);
    const auto timed = [](auto&& work, double& seconds) {
        const auto begin = std::chrono::steady_clock::now();
        auto result = work();
        seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
        return result;
    };
    double seconds = 0;
    const auto first = timed([&] { return first_fit(boxes, plate, gap); }, seconds);
    const double against = first ? *first : 0;
    say("first fit by boxes", first, plate, seconds, 0);
    const auto best_box = timed([&] { return columns(by_box, plate, gap); }, seconds);
    say("boxes, best of the orders", best_box, plate, seconds, against);
    const auto outlined = timed([&] { return columns(by_outline, plate, gap); }, seconds);
    say("outlines", outlined, plate, seconds, against);
    const auto with_turns = timed([&] { return columns(turned, plate, gap); }, seconds);
    say("outlines, turned by right angles", with_turns, plate, seconds, against);
    return 0;
}
