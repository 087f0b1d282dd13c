// SPDX-License-Identifier: GPL-3.0-or-later
#include "graphics_pages.h"

#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>

#include "benchmarks/sets.h"
#include "io/files/whole_file.h"
#include "io/pictures/picture.h"
#include "io/pictures/picture_writer.h"
#include "optics/colour/colour.h"
#include "printed_codes.h"
#include "stroke_font.h"

namespace voxtone::loop_benchmark {
namespace {

namespace fs = std::filesystem;

constexpr double px_per_mm = 40;
constexpr int samples = 3;

Eigen::Vector3d colour(int r, int g, int b) {
    return {optics::srgb_decode(r / 255.0), optics::srgb_decode(g / 255.0), optics::srgb_decode(b / 255.0)};
}

const Eigen::Vector3d white(1, 1, 1), black = colour(20, 20, 20), grey = colour(128, 128, 128);
const std::array<Eigen::Vector3d, 8> eight{colour(220, 30, 40),  colour(0, 150, 70),  colour(20, 60, 170),
                                           colour(250, 210, 20), colour(0, 150, 200), colour(200, 30, 130),
                                           colour(120, 80, 50),  colour(20, 20, 20)};

/// Later things lie upon earlier ones; y points up.
class Page {
public:
    Page(double width, double height, Eigen::Vector3d ground) : width_(width), height_(height), ground_(ground) {}
    [[nodiscard]] double width() const { return width_; }
    [[nodiscard]] double height() const { return height_; }
    void rectangle(double x, double y, double w, double h, const Eigen::Vector3d& rgb) {
        things_.push_back([=](double px, double py) -> std::optional<Eigen::Vector3d> {
            if (px < x || px >= x + w || py < y || py >= y + h) return std::nullopt;
            return rgb;
        });
    }
    void disc(double x, double y, double radius, const std::function<Eigen::Vector3d(double)>& by_radius) {
        things_.push_back([=](double px, double py) -> std::optional<Eigen::Vector3d> {
            const double r = std::hypot(px - x, py - y) / radius;
            if (r >= 1) return std::nullopt;
            return by_radius(r);
        });
    }
    void text(const std::string& text, double x, double y, double points, const Eigen::Vector3d& rgb) {
        std::vector<Stroke> strokes;
        add_text(strokes, text, x, y, points);
        lines(strokes, rgb);
    }
    void lines(const std::vector<Stroke>& strokes, const Eigen::Vector3d& rgb) {
        things_.push_back([=](double px, double py) -> std::optional<Eigen::Vector3d> {
            for (const Stroke& s : strokes) {
                const double dx = s.x1 - s.x0, dy = s.y1 - s.y0, length2 = dx * dx + dy * dy;
                const double t =
                    length2 > 0 ? std::clamp(((px - s.x0) * dx + (py - s.y0) * dy) / length2, 0.0, 1.0) : 0.0;
                if (std::hypot(px - s.x0 - t * dx, py - s.y0 - t * dy) < s.width / 2) return rgb;
            }
            return std::nullopt;
        });
    }
    void paint(const std::function<std::optional<Eigen::Vector3d>(double, double)>& thing) { things_.push_back(thing); }
    [[nodiscard]] Eigen::Vector3d at(double x, double y) const {
        for (auto thing = things_.rbegin(); thing != things_.rend(); ++thing)
            if (const auto rgb = (*thing)(x, y)) return *rgb;
        return ground_;
    }

private:
    double width_, height_;
    Eigen::Vector3d ground_;
    std::vector<std::function<std::optional<Eigen::Vector3d>(double, double)>> things_;
};

void write(const Page& page, const fs::path& file) {
    io::LinearPicture picture;
    picture.width_px = static_cast<std::uint32_t>(std::lround(page.width() * px_per_mm));
    picture.height_px = static_cast<std::uint32_t>(std::lround(page.height() * px_per_mm));
    for (std::uint32_t j = 0; j < picture.height_px; ++j)
        for (std::uint32_t i = 0; i < picture.width_px; ++i) {
            Eigen::Vector3d sum = Eigen::Vector3d::Zero();
            for (int b = 0; b < samples; ++b)
                for (int a = 0; a < samples; ++a)
                    sum += page.at((i + (a + 0.5) / samples) / px_per_mm,
                                   page.height() - (j + (b + 0.5) / samples) / px_per_mm);
            const Eigen::Vector3f mean = (sum / (samples * samples)).cast<float>();
            picture.pixels.emplace_back(mean[0], mean[1], mean[2], 1.0F);
        }
    io::write_whole_file(file, io::png_bytes(io::encode_over(picture, Eigen::Vector3f::Ones())));
}

/// Eight colours, 2.4 mm, with a small square of each beside.
Page solids(const Eigen::Vector3d& ground) {
    Page page(14, 8, ground);
    for (std::size_t k = 0; k < eight.size(); ++k) {
        if ((eight[k] - ground).norm() < 0.05) continue;
        const double x = 0.7 + 3.4 * static_cast<double>(k % 4), y = k < 4 ? 4.6 : 0.9;
        page.rectangle(x, y, 2.4, 2.4, eight[k]);
        page.rectangle(x + 0.7, y - 0.75, 1.0, 0.45, eight[k]);
    }
    return page;
}

Page two_large() {
    Page page(20, 11, white);
    page.rectangle(0.8, 1, 9, 9, eight[0]);
    page.rectangle(10.6, 1, 8.6, 9, black);
    page.rectangle(3.5, 4, 3.5, 3, white);
    return page;
}

Page logo() {
    Page page(12, 9, white);
    page.disc(4, 4.5, 3.4, [](double r) {
        if (r > 0.85) return eight[2];
        if (r > 0.7) return white;
        return Eigen::Vector3d(eight[3] + (eight[0] - eight[3]) * (r / 0.7));  // from yellow to red
    });
    page.text("voxel", 7.7, 5, 10, eight[2]);
    page.text("tone", 7.7, 2.5, 10, black);
    return page;
}

Page type(const Eigen::Vector3d& ground, const Eigen::Vector3d& ink, const std::vector<std::string>& words) {
    Page page(14, 11, ground);
    double y = 10.6;
    const std::array<double, 5> points{14, 10, 8, 6, 4};
    for (std::size_t k = 0; k < points.size(); ++k) {
        y -= 0.95 * points[k] * mm_per_point;
        page.text(words[k], 0.6, y, points[k], ink);
        y -= 0.3 * points[k] * mm_per_point;
    }
    return page;
}

Page hairlines() {
    Page page(12, 8, white);
    std::vector<Stroke> lines;
    double x = 0.8;
    for (const double width : {0.1, 0.15, 0.2, 0.3, 0.4, 0.6}) {
        lines.push_back({x, 0.8, x, 7.2, width});
        lines.push_back({6.2, x + 0.2, 11.4, x + 0.2, width});
        x += 0.9;
    }
    page.lines(lines, black);
    return page;
}

Page codes() {
    Page page(codes_width_mm, codes_height_mm, white);
    for (const PrintedCode& code : printed_codes()) {
        const double height = code.height / static_cast<double>(code.dark.size());
        for (std::size_t row = 0; row < code.dark.size(); ++row)
            for (std::size_t column = 0; column < code.dark[row].size(); ++column)
                if (code.dark[row][column])
                    page.rectangle(code.x + static_cast<double>(column) * code.module_mm,
                                   code.y + code.height - static_cast<double>(row + 1) * height, code.module_mm, height,
                                   black);
    }
    return page;
}

/// Twelve colours with gaps of a third of a millimetre.
Page checker() {
    Page page(14, 8, colour(60, 60, 60));
    const std::array<Eigen::Vector3d, 12> patch{colour(115, 82, 68),   colour(194, 150, 130), colour(98, 122, 157),
                                                colour(87, 108, 67),   colour(214, 126, 44),  colour(80, 91, 166),
                                                colour(193, 90, 99),   colour(157, 188, 64),  colour(243, 243, 242),
                                                colour(160, 160, 160), colour(85, 85, 85),    colour(231, 199, 31)};
    for (std::size_t k = 0; k < patch.size(); ++k)
        page.rectangle(0.2 + 3.45 * static_cast<double>(k % 4), 0.2 + 2.6 * static_cast<double>(k / 4), 3.15, 2.3,
                       patch[k]);
    return page;
}

}  // namespace

std::vector<Target> make_graphics(const fs::path& models, const fs::path& work, const std::string& only,
                                  std::vector<std::string>& missing) {
    fs::create_directories(work);
    std::vector<Target> targets;
    const auto add = [&](const std::string& name, const std::function<Page()>& make) {
        if (name.find(only) == std::string::npos) return;
        const Page page = make();
        const fs::path file = work / (name + ".png");
        write(page, file);
        targets.push_back({name, file, page.width(), page.height(), false, benchmarks::is_held_out_page(name)});
    };
    add("solids_on_white", [] { return solids(white); });
    add("solids_on_black", [] { return solids(black); });
    add("solids_on_grey", [] { return solids(grey); });
    add("large_solids", two_large);
    add("logo", logo);
    add("type_on_white", [] {
        return type(white, black, {"Sphinx", "of black", "quartz, 8", "judge my vow", "Pack 5 dozen jugs"});
    });
    add("type_on_black", [] {
        return type(black, white, {"Zebra", "jumps 13", "over quiet", "foxes, 19 kg -", "batch 5072 of 84, wax"});
    });
    add("type_on_blue", [] {
        return type(eight[2], eight[3], {"Axes", "of 13 - 48", "kg 976, ink", "is not thin", "lines of it fade"});
    });
    add("hairlines", hairlines);
    add("codes", codes);
    add("gaps", checker);
    const fs::path photograph = models / "img_kodim23/23.png";
    if (std::string("captioned").find(only) != std::string::npos) {
        if (!fs::exists(photograph))
            missing.emplace_back("captioned");
        else
            add("captioned", [&] {
                const io::Picture picture = io::read_picture(photograph);
                Page page(14, 11, white);
                page.paint([picture](double x, double y) -> std::optional<Eigen::Vector3d> {
                    const double u = (x - 1) / 12, v = (y - 2) / 8;
                    if (u < 0 || u >= 1 || v < 0 || v >= 1) return std::nullopt;
                    const float lod = std::log2(static_cast<float>(picture.width_px / 12.0 / px_per_mm));
                    return picture.texture->sample(static_cast<float>(u), static_cast<float>(v), std::max(lod, 0.0F))
                        .cast<double>();
                });
                page.text("two parrots, 8 pt", 1, 0.8, 8, black);
                return page;
            });
    }
    return targets;
}

}  // namespace voxtone::loop_benchmark
