// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/spot/response_sweep_job.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <vector>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "base/error.h"
#include "io/files/whole_file.h"
#include "io/pictures/photograph_writer.h"
#include "io/profiles/bssrdf_file.h"
#include "tests/io/files/temporary_folder.h"

using namespace voxtone;
using namespace voxtone::calibration;
using Catch::Matchers::Contains;
namespace fs = std::filesystem;

namespace {

constexpr std::uint32_t width = 3, height = 2, cell_px = 5, left = 3, top = 2, picture_width = 32, picture_height = 26;
constexpr double pitch = 0.5, mm_per_px = 0.1, black = 0.01, card_albedo = 0.5;

/// R between cells, per mm2: a surface that keeps light near on the left and lets it go on the right.
double truth(std::size_t channel, std::size_t from, std::size_t to) {
    const auto at = [](std::size_t cell) { return std::pair(int(cell % width), int(cell / width)); };
    const auto [x, y] = at(from);
    const auto [u, v] = at(to);
    const double r = pitch * std::hypot(x - u, y - v);
    const auto P = [&](int column) { return (0.5 + 0.1 * double(channel)) * std::exp(-r / (column < 2 ? 0.25 : 0.6)); };
    return 0.5 * std::sqrt(P(x) * P(u));
}

/// How a square that sends `power` is seen in one second, of full scale per mm2 of light.
struct Lab {
    fs::path folder;
    std::vector<double> exposures{0.5, 4.0};                                    ///< of each frame, s
    double power = 0.4;                                                         ///< one unit of light is that much
    std::function<double(std::size_t)> lamp = [](std::size_t) { return 1.0; };  ///< of a frame

    void write(const std::string& name, double seconds,
               const std::function<double(std::size_t, int, int)>& light) const {
        io::Photograph photo{name, picture_width, picture_height, io::SampleCoding::linear, 16, {}, seconds};
        for (std::uint32_t y = 0; y < picture_height; ++y)
            for (std::uint32_t x = 0; x < picture_width; ++x) {
                Eigen::Vector3f pixel;
                for (Eigen::Index c = 0; c < 3; ++c)
                    pixel[c] = float(std::min(1.0, black + seconds * light(std::size_t(c), int(x), int(y))));
                photo.pixels.push_back(pixel);
            }
        const fs::path file = folder / name;
        io::write_whole_file(file, io::photograph_bytes(photo, file.string()));
    }

    /// Frames, dark frames, card; the table of them.
    void draw() const {
        const auto cell_of = [](int x, int y) {
            const int column = (x - int(left)) / int(cell_px), row = (y - int(top)) / int(cell_px);
            const bool on = x >= int(left) && y >= int(top) && column < int(width) && row < int(height);
            return on ? row * int(width) + column : -1;
        };
        std::string table = "file,dark,x_mm,y_mm\n";
        for (const double seconds : {0.5, 4.0})
            write(fmt::format("dark-{}.png", seconds), seconds, [](std::size_t, int, int) { return 0.0; });
        for (std::size_t from = 0; from < width * height; ++from)
            for (const double seconds : exposures) {
                const std::string name = fmt::format("frame-{}-{}.png", from, seconds);
                write(name, seconds, [&](std::size_t c, int x, int y) {
                    const int to = cell_of(x, y);
                    return to < 0 ? 0.0 : lamp(from) * power * truth(c, from, std::size_t(to));
                });
                table += fmt::format("{}@{},dark-{}.png@{},{},{}\n", name, seconds, seconds, seconds,
                                     pitch * (double(from % width) + 0.5), pitch * (double(from / width) + 0.5));
            }
        // All that the square sends lands in one cell of the card.
        write("card.png", 0.5, [&](std::size_t, int x, int y) {
            return cell_of(x, y) == 4 ? power * card_albedo / (pitch * pitch) : 0.0;
        });
        io::write_whole_file(folder / "frames.csv", table);
    }

    [[nodiscard]] ResponseSweepJob job() const {
        ResponseSweepJob job;
        job.frames = (folder / "frames.csv").string();
        job.card = {{{folder / "card.png", 0.5}}, {{folder / "dark-0.5.png", 0.5}}};
        job.card_albedo = card_albedo;
        job.geometry = {mm_per_px, {left, top}, {width, height}, pitch, 4};
        job.out = (folder / "surface.bssrdf").string();
        job.overwrite = true;
        return job;
    }
};

}  // namespace

TEST_CASE("A square of light swept over a surface gives back its R, cell by cell") {
    const io::TemporaryFolder folder;
    const Lab lab{folder.path()};
    lab.draw();
    Progress quiet;
    const JobResult result = run_response_sweep(lab.job(), quiet);
    CHECK_THAT(result.text, Contains("3 x 2 points at 0.5 mm"));
    const io::BssrdfFile data = io::read_bssrdf(lab.job().out);
    REQUIRE(data.channels.is_rgb());
    const auto offsets = optics::half_window(4);
    double worst = 0, off_other_way = 0;
    for (std::size_t c = 0; c < 3; ++c) {
        const optics::ChannelResponses& channel = data.responses.channels[c];
        for (std::size_t k = 0; k < offsets.size(); ++k)
            for (std::size_t from = 0; from < width * height; ++from) {
                const int column = int(from % width) + offsets[k].x, row = int(from / width) + offsets[k].y;
                const double found = double(channel.pairs[k * width * height + from]);
                if (column < 0 || column >= int(width) || row >= int(height)) {
                    CHECK(found == 0);
                    continue;
                }
                const double wanted = truth(c, from, std::size_t(row) * width + std::size_t(column));
                // Samples of 16 bits are steps of 1e-5 per mm2.
                worst = std::max(worst, (std::abs(found - wanted) - 2e-5) / wanted);
                off_other_way = std::max(off_other_way, std::abs(found / truth(c, 0, from) - 1));
            }
        for (std::size_t from = 0; from < width * height; ++from) {
            double all = 0;
            for (std::size_t to = 0; to < width * height; ++to) all += truth(c, from, to) * pitch * pitch;
            CHECK(double(channel.total[from]) == Approx(all).epsilon(0.002));
        }
    }
    CHECK(worst < 0.002);
    CHECK(off_other_way > 0.5);  // so that a mix-up of cells would show
}

TEST_CASE("What is wrong with a sweep is told in a sentence that names the frame") {
    const io::TemporaryFolder folder;
    Lab lab{folder.path(), {4.0}};  // each photograph that is read takes a fifth of a second
    lab.draw();
    Progress quiet;
    const auto fails = [&](ResponseSweepJob job) {
        try {
            (void)run_response_sweep(job, quiet);
        } catch (const Error& error) {
            return std::string(error.what());
        }
        return std::string("nothing is wrong");
    };
    const auto with_table = [&](const std::string& text) {
        ResponseSweepJob job = lab.job();
        job.frames = (folder.path() / "other.csv").string();
        io::write_whole_file(job.frames, text);
        return fails(job);
    };
    CHECK_THAT(with_table("file,dark,x_mm,y_mm\nframe-0-4.png@4,dark-4.png@4,,0.25\n"),
               Contains("line 2") && Contains("x_mm") && Contains("square"));
    CHECK_THAT(with_table("file,dark,x_mm,y_mm\nframe-0-4.png@4,dark-4.png@4,9,0.25\n"), Contains("off the surface"));
    CHECK_THAT(with_table("file,dark,x_mm,y_mm\nframe-0-4.png@4,,0.25,0.25\n"), Contains("dark frame"));
    CHECK_THAT(with_table("file,dark,x_mm,y_mm\nframe-0-4.png@4,dark-4.png@4,0.25,0.25\n"),
               Contains("cell (1, 0) has no frame"));
    CHECK_THAT(with_table("file,x_mm\na.png,1\n"), Contains("file,dark,x_mm,y_mm"));
    ResponseSweepJob job = lab.job();
    job.geometry.corner_px = {20, 2};
    CHECK_THAT(fails(job), Contains("within them") && Contains("--corner"));
    job = lab.job();
    job.card_albedo = 1.2;
    CHECK_THAT(fails(job), Contains("--card-albedo") && Contains("at most 1"));
    job = lab.job();
    job.card.lit[0].seconds = job.card.dark[0].seconds = 8;  // then there was less light, and cells send back more
    CHECK_THAT(fails(job), Contains("more than it got"));
    job = lab.job();
    job.card.dark = job.card.lit;
    CHECK_THAT(fails(job), Contains("swapped"));
    job = lab.job();
    job.out = "x.json";
    CHECK_THAT(fails(job), Contains(".bssrdf"));

    lab.lamp = [](std::size_t from) { return from == 4 ? 1.5 : 1.0; };
    lab.draw();
    CHECK_THAT(fails(lab.job()), Contains("cell (1, 1)") && Contains("1.50 times") && Contains("alike"));
    lab.lamp = [](std::size_t) { return 1.0; };
    lab.power = 40;
    lab.draw();
    CHECK_THAT(fails(lab.job()), Contains("saturated"));
}
