// SPDX-License-Identifier: GPL-3.0-or-later
#include "photo_cases.h"

#include <cmath>

#include "halftone_skin.h"
#include "io/pictures/picture.h"

namespace voxtone::accuracy {
namespace {

using namespace optics;

struct Piece {
    const char *name, *shown, *file;
    double left_mm, top_mm;  ///< of the picture printed 20 mm wide
    bool tuning;
};
constexpr std::array<Piece, 4> pieces{{
    {"kodim23", "two parrots, heads and feathers", "img_kodim23/23.png", 2.4, 4.4, true},
    {"astronaut", "an astronaut's suit, badges and helmet", "img_astronaut/astronaut.png", 5.4, 11.6, true},
    {"hubble", "distant galaxies on black", "img_hubble/hubble_deep_field.jpg", 12.0, 7.4, false},
    {"marble", "dark marble", "img_marble/Marble006_1K_Color.jpg", 13.0, 8.0, false},
}};
constexpr double width_mm = 20;
constexpr int nx = 144, ny = 54;  // 6.1 x 4.6 mm

/// A piece of a picture, 20 mm wide.
class Sampler {
public:
    Sampler(const std::filesystem::path& models, const Piece& piece)
        : piece_(piece),
          picture_(io::read_picture(models / piece.file)),
          px_per_mm_(picture_.width_px / width_mm),
          height_mm_(picture_.height_px / px_per_mm_) {}
    /// Linear sRGB at a place of the piece, mm from its lower left corner, averaged over about `spacing_mm`.
    [[nodiscard]] Eigen::Vector3f at(double x_mm, double y_mm, double spacing_mm) const {
        const double right = piece_.left_mm + x_mm, down = piece_.top_mm + ny * j750_mm[1] - y_mm;
        return picture_.texture->sample(static_cast<float>(right / width_mm), static_cast<float>(1 - down / height_mm_),
                                        static_cast<float>(std::log2(px_per_mm_ * spacing_mm)));
    }

private:
    const Piece& piece_;
    io::Picture picture_;
    double px_per_mm_, height_mm_;
};

}  // namespace

std::vector<SuiteCase> photo_cases(const std::filesystem::path& models) {
    std::vector<SuiteCase> cases;
    const HalftoneSkin skin(suite_resins(), {"C", "M", "Y", "K", "W"}, skin_layers * j750_mm[2],
                            (slab_layers - skin_layers) * j750_mm[2]);
    for (const Piece& piece : pieces) {
        if (!std::filesystem::exists(models / piece.file)) continue;
        const Sampler picture(models, piece);
        std::vector<halftone::CumulativeMixture> mixtures;
        for (int y = 0; y < ny; ++y)
            for (int x = 0; x < nx; ++x)
                mixtures.push_back(
                    skin.of_linear(picture.at((x + 0.5) * j750_mm[0], (y + 0.5) * j750_mm[1], j750_mm[0])));
        SuiteCase c;
        c.name = piece.name;
        c.shown = piece.shown;
        c.tuning = piece.tuning;
        c.resins = suite_resins();
        c.noise = 0.6;
        c.volume = make_resin_volume({nx, ny, slab_layers}, j750_mm, [&](int x, int y, int z) {
            return z >= slab_layers - skin_layers ? skin.at(mixtures[static_cast<std::size_t>(y * nx + x)], x, y, z)
                                                  : resin::W;
        });
        cases.push_back(std::move(c));
    }
    return cases;
}

std::vector<Rgb> photo_target(const std::filesystem::path& models, const std::string& name, const Surface& surface) {
    std::vector<Rgb> target;
    for (const Piece& piece : pieces) {
        if (name != piece.name || !std::filesystem::exists(models / piece.file)) continue;
        const Sampler picture(models, piece);
        for (const SurfaceCell& cell : surface.cells) {
            const Eigen::Vector3f rgb =
                picture.at(static_cast<double>(cell.centre_mm[0]), static_cast<double>(cell.centre_mm[1]), j750_mm[1]);
            target.push_back({rgb[0], rgb[1], rgb[2]});
        }
    }
    return target;
}

}  // namespace voxtone::accuracy
