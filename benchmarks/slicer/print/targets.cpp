// SPDX-License-Identifier: GPL-3.0-or-later
#include "targets.h"

#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include "benchmarks/sets.h"
#include "gratings.h"
#include "io/files/whole_file.h"
#include "io/pictures/picture.h"
#include "io/pictures/picture_writer.h"
#include "optics/colour/colour.h"
#include "stroke_font.h"

namespace voxtone::loop_benchmark {
namespace {

namespace fs = std::filesystem;

constexpr double page_width_mm = 20, page_px_per_mm = 40;
/// Linear light of black on white: L* 15.5, as black ink on paper, and just within the gamut of 1 mm of Vero Black, so
/// that letters count among the in-gamut pixels.
constexpr double ink_light = 0.02;

/// Linear sRGB of a place; y points up.
using Paint = std::function<Eigen::Vector3d(double x, double y)>;

struct Window {
    double x0, y0, width, height;
};

Window middle(double width, double height, const Crop& crop) {
    const double w = crop.width_mm > 0 ? std::min(width, crop.width_mm) : width,
                 h = crop.height_mm > 0 ? std::min(height, crop.height_mm) : height;
    return {(width - w) / 2, (height - h) / 2, w, h};
}

void write_page(const fs::path& file, const Window& window, double px_per_mm, int samples, const Paint& paint) {
    io::LinearPicture picture;
    picture.width_px = static_cast<std::uint32_t>(std::lround(window.width * px_per_mm));
    picture.height_px = static_cast<std::uint32_t>(std::lround(window.height * px_per_mm));
    picture.pixels.reserve(std::size_t{picture.width_px} * picture.height_px);
    for (std::uint32_t j = 0; j < picture.height_px; ++j)
        for (std::uint32_t i = 0; i < picture.width_px; ++i) {
            Eigen::Vector3d sum = Eigen::Vector3d::Zero();
            for (int b = 0; b < samples; ++b)
                for (int a = 0; a < samples; ++a)
                    sum += paint(window.x0 + (i + (a + 0.5) / samples) / px_per_mm,
                                 window.y0 + window.height - (j + (b + 0.5) / samples) / px_per_mm);
            const Eigen::Vector3f mean = (sum / (samples * samples)).cast<float>();
            picture.pixels.emplace_back(mean[0], mean[1], mean[2], 1.0F);
        }
    io::write_whole_file(file, io::png_bytes(io::encode_over(picture, Eigen::Vector3f::Ones())));
}

struct TextLine {
    std::string text;
    double points;
};

/// Black on white, one line below the other.
class TextPage {
public:
    TextPage(const std::vector<TextLine>& lines, double height) : height_(height) {
        std::vector<Stroke> strokes;
        double y = height - 0.6;
        for (const auto& [text, points] : lines) {
            y -= 0.95 * points * mm_per_point;
            add_text(strokes, text, 0.7, y, points);
            y -= 0.28 * points * mm_per_point;
        }
        ink_ = draw_strokes(strokes, page_width_mm, height, px_per_mm);
    }
    [[nodiscard]] Eigen::Vector3d operator()(double x, double y) const {
        const auto columns = static_cast<std::size_t>(std::lround(page_width_mm * px_per_mm));
        const std::size_t i = static_cast<std::size_t>(x * px_per_mm),
                          j = static_cast<std::size_t>((height_ - y) * px_per_mm);
        return Eigen::Vector3d::Constant(1 - (1 - ink_light) *
                                                 static_cast<double>(ink_[std::min(j * columns + i, ink_.size() - 1)]));
    }

private:
    static constexpr double px_per_mm = 4 * page_px_per_mm;
    double height_;
    std::vector<float> ink_;
};

const std::vector<TextLine>& fitting_text() {
    static const std::vector<TextLine> lines{
        {"Sphinx", 12}, {"of black", 10}, {"quartz, 8 pt", 8}, {"judge my vow 7", 7}, {"Pack 5 dozen jugs", 6}};
    return lines;
}

const std::vector<TextLine>& small_text() {
    static const std::vector<TextLine> lines{
        {"Paper is white, ink", 6}, {"is not  thin lines", 6}, {"of it fade, 0.2 mm", 6}, {"Axes 13-48, kg 976", 6}};
    return lines;
}

const std::vector<TextLine>& held_out_text() {
    static const std::vector<TextLine> lines{
        {"Slow zebras jump", 6}, {"over quiet foxes,", 6}, {"batch 5072 of 84,", 6}, {"wax, 19 g - 36 kg", 6}};
    return lines;
}

/// 36 black and 36 white sectors; in the middle a grey disc where they are finer than 4 line pairs per mm.
Eigen::Vector3d siemens_star(double x, double y) {
    constexpr double radius = 6.5, hub = 36 / (2 * std::numbers::pi * 4);
    const double r = std::hypot(x - 10, y - 7);
    if (r > radius) return Eigen::Vector3d::Ones();
    if (r < hub) return Eigen::Vector3d::Constant(0.5);
    const double turn = std::atan2(y - 7, x - 10) / (2 * std::numbers::pi) * 36;
    return Eigen::Vector3d::Constant(turn - std::floor(turn) < 0.5 ? ink_light : 1.0);
}

/// Source: sRGB codes that GretagMacbeth published for the ColorChecker chart of 24 patches (C. S. McCamy, H. Marcus,
/// J. G. Davidson, J. Appl. Photogr. Eng. 2, 95 (1976)), in the chart's order, row by row.
constexpr std::array<std::array<int, 3>, 24> checker_codes{{
    {115, 82, 68},   {194, 150, 130}, {98, 122, 157},  {87, 108, 67},   {133, 128, 177}, {103, 189, 170},
    {214, 126, 44},  {80, 91, 166},   {193, 90, 99},   {94, 60, 108},   {157, 188, 64},  {224, 163, 46},
    {56, 61, 150},   {70, 148, 73},   {175, 54, 60},   {231, 199, 31},  {187, 86, 149},  {8, 133, 161},
    {243, 243, 242}, {200, 200, 200}, {160, 160, 160}, {122, 122, 121}, {85, 85, 85},    {52, 52, 52},
}};

Eigen::Vector3d colour_checker(double x, double y) {
    constexpr double width = 20, height = 14, gap = 0.35;
    const double u = x / (width / 6), v = (height - y) / (height / 4);
    const int column = std::min(5, static_cast<int>(u)), row = std::min(3, static_cast<int>(v));
    const double from_x = (u - column) * width / 6, from_y = (v - row) * height / 4;
    if (from_x < gap / 2 || from_x > width / 6 - gap / 2 || from_y < gap / 2 || from_y > height / 4 - gap / 2)
        return Eigen::Vector3d::Constant(0.05);
    const auto& codes = checker_codes[static_cast<std::size_t>(6 * row + column)];
    Eigen::Vector3d rgb;
    for (std::size_t c = 0; c < 3; ++c) rgb[static_cast<Eigen::Index>(c)] = optics::srgb_decode(codes[c] / 255.0);
    return rgb;
}

}  // namespace

std::vector<Target> make_targets(const fs::path& models, const fs::path& work, const std::string& only,
                                 const Crop& crop, std::vector<std::string>& missing) {
    fs::create_directories(work);
    std::vector<Target> targets;
    const auto wanted = [&](const std::string& name) { return name.find(only) != std::string::npos; };
    for (const benchmarks::SetEntry& p : benchmarks::pictures()) {
        if (!wanted(p.name)) continue;
        if (!fs::exists(models / p.file)) {
            missing.push_back(p.name);
            continue;
        }
        const io::Picture picture = io::read_picture(models / p.file);
        const double px_per_mm = std::min(picture.width_px / page_width_mm, page_px_per_mm);
        const double height = page_width_mm * picture.height_px / picture.width_px;
        const float lod = std::log2(static_cast<float>(picture.width_px / page_width_mm / px_per_mm));
        const Window window = middle(page_width_mm, height, crop);
        const fs::path file = work / (p.name + ".png");
        write_page(file, window, px_per_mm, 1, [&](double x, double y) -> Eigen::Vector3d {
            return picture.texture->sample(static_cast<float>(x / page_width_mm), static_cast<float>(y / height), lod)
                .cast<double>();
        });
        targets.push_back({p.name, file, window.width, window.height, false, p.held_out});
    }
    const auto page = [&](const std::string& name, double height, const Paint& paint, int samples,
                          bool held_out = false) {
        const Window window = middle(page_width_mm, height, crop);
        const fs::path file = work / (name + ".png");
        write_page(file, window, page_px_per_mm, samples, paint);
        targets.push_back({name, file, window.width, window.height, false, held_out});
    };
    if (wanted("text")) page("text", 20, TextPage(fitting_text(), 20), 4);
    if (wanted("small_type")) page("small_type", 12, TextPage(small_text(), 12), 4);
    if (wanted("fine_print")) page("fine_print", 12, TextPage(held_out_text(), 12), 4, true);
    if (wanted("siemens_star")) page("siemens_star", 14, siemens_star, 4);
    if (wanted("colour_checker")) page("colour_checker", 14, colour_checker, 4);
    if (wanted("gratings")) {
        // A smaller page has smaller blocks.
        const Window window = middle(page_width_mm, 14, crop);
        const std::vector<GratingBlock> blocks = grating_blocks(window.width, window.height);
        const fs::path file = work / "gratings.png";
        write_page(file, {0, 0, window.width, window.height}, page_px_per_mm, 2,
                   [&](double x, double y) { return Eigen::Vector3d::Constant(grating_light(blocks, x, y)).eval(); });
        targets.push_back({"gratings", file, window.width, window.height, true});
    }
    return targets;
}

}  // namespace voxtone::loop_benchmark
