// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/compare/body_reading.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "base/error.h"
#include "base/parallel.h"
#include "base/warning.h"
#include "calibration/compare/body_light.h"
#include "calibration/compare/body_place.h"
#include "calibration/photo/patch_sampling.h"
#include "optics/scene/fresnel.h"

namespace voxtone::calibration {

namespace {

constexpr int fine = 3;                // rays along each side of a cell
constexpr double least_cosine = 0.4;   // of the view: more aslant the gloss of the sky's rim covers the print
constexpr double outline_mm = 0.3;     // beside an outline: light goes through thin rims, and what is off in place
constexpr double least_light = 0.35;   // of even light: shadows
constexpr double some_left_out = 0.6;  // of what is seen of the body: told
constexpr std::size_t least_cells = 200;
constexpr float ground_grey = 0.18f;

/// The window of the photograph that is compared.
struct Window {
    Eigen::Vector2d corner_px;
    double px_per_cell;
    int columns, rows;
};

Window window_of(const io::Photograph& photo, const PredictedBody& body, const BodyCamera& camera) {
    Eigen::Vector2d low = Eigen::Vector2d::Constant(1e30), high = -low;
    for (const Eigen::Vector3f& p : body.position) {
        const Eigen::Vector2d px = camera.to_px(camera.before(p.cast<double>()));
        low = low.cwiseMin(px), high = high.cwiseMax(px);
    }
    Window window;
    window.px_per_cell = camera.px_per_mm(body.middle()) * body.cell_mm;
    constexpr double free_cells = 6;
    low -= Eigen::Vector2d::Constant(free_cells * window.px_per_cell);
    high += Eigen::Vector2d::Constant(free_cells * window.px_per_cell);
    low = low.cwiseMax(0.0);
    high = high.cwiseMin(Eigen::Vector2d(photo.width_px, photo.height_px));
    window.corner_px = low;
    window.columns = std::max(1, int((high.x() - low.x()) / window.px_per_cell));
    window.rows = std::max(1, int((high.y() - low.y()) / window.px_per_cell));
    return window;
}

/// What a cell sees of the body.
struct CellView {
    LitPlace place;
    Eigen::Vector3f at = Eigen::Vector3f::Zero();
    bool body = false;  ///< sees it at all
    bool counts = false;
};

std::vector<Eigen::Vector3d> even_directions(int count) {
    std::vector<Eigen::Vector3d> ways;
    for (int i = 0; i < count; ++i) {  // along a spiral
        const double z = 1 - 2 * (i + 0.5) / count, r = std::sqrt(1 - z * z),
                     turn = i * std::numbers::pi * (3 - std::sqrt(5.0));
        ways.emplace_back(r * std::cos(turn), r * std::sin(turn), z);
    }
    return ways;
}

/// Of places that are seen: what their normal has of each term of the sky, less what the body covers; and how much that
/// is.
struct SkyOfPlaces {
    std::vector<SkyTerms> diffuse;
    std::vector<double> covered;
};

SkyOfPlaces sky_of(const PredictedBody& body, const std::vector<std::uint32_t>& places) {
    constexpr int count = 256;
    const std::vector<Eigen::Vector3d> ways = even_directions(count);
    const std::vector<std::uint8_t> sees = body.sees_sky(places, ways);
    std::vector<SkyTerms> terms;
    for (const Eigen::Vector3d& way : ways) terms.push_back(sky_terms_of(way));
    SkyOfPlaces sky{std::vector<SkyTerms>(body.position.size()), std::vector<double>(body.position.size(), 0)};
    parallel_for(0, places.size(), 256, [&](std::size_t i) {
        const Eigen::Vector3d normal = body.normal[places[i]].cast<double>();
        SkyTerms& diffuse = sky.diffuse[places[i]];
        diffuse = diffuse_terms_of(normal);
        for (std::size_t d = 0; d < ways.size(); ++d) {
            const double cosine = normal.dot(ways[d]);
            if (cosine <= 0 || sees[i * ways.size() + d]) continue;
            const double share = 4.0 / count * cosine;
            sky.covered[places[i]] += share;
            for (std::size_t k = 0; k < sky_terms; ++k) diffuse[k] -= share * terms[d][k];
        }
    });
    return sky;
}

/// All places that the camera may see from there or from beside it.
SkyOfPlaces sky_before(const PredictedBody& body, const BodyCamera& camera) {
    constexpr double least = -0.2;  // cosine
    std::vector<std::uint32_t> places;
    for (std::uint32_t i = 0; i < body.position.size(); ++i)
        if (body.normal[i].cast<double>().dot((camera.position() - body.position[i].cast<double>()).normalized()) >
            least)
            places.push_back(i);
    return sky_of(body, places);
}

/// What a place mirrors and lets through towards the camera.
void look_at(LitPlace& place, const Eigen::Vector3d& up, const Eigen::Vector3d& to_camera, double eta) {
    const double cosine = up.dot(to_camera);
    place.mirrored = sky_terms_of(2 * cosine * up - to_camera);
    place.fresnel = optics::fresnel_reflectance(std::clamp(cosine, 0.05, 1.0), eta);
    place.transmitted = (1 - place.fresnel) / (1 - optics::fresnel_reflectance(1, eta));
}

/// The body in the colours that this light gives it towards the camera.
PredictedBody lit_body(PredictedBody body, const SkyOfPlaces& sky, const BodyCamera& camera, const BodyLight& light) {
    parallel_for(0, body.position.size(), 1024, [&](std::size_t i) {
        LitPlace place;
        place.predicted = body.rgb[i].cast<double>();
        place.diffuse = sky.diffuse[i], place.covered = sky.covered[i];
        look_at(place, body.normal[i].cast<double>(),
                (camera.position() - body.position[i].cast<double>()).normalized(), body.set.eta);
        body.rgb[i] = light.model(place).cast<float>();
    });
    return body;
}

/// Away from outlines, also those of parts before others.
void leave_out_rims(std::vector<CellView>& cells, const std::vector<float>& depth, const Window& window,
                    double cell_mm) {
    cv::Mat off(window.rows, window.columns, CV_8UC1, cv::Scalar(0));
    const auto at = [&](int x, int y) { return std::size_t(y) * std::size_t(window.columns) + std::size_t(x); };
    const auto jump = float(6 * cell_mm);  // ahead, from cell to cell: 66 degrees are 2.3
    for (int y = 0; y < window.rows; ++y)
        for (int x = 0; x < window.columns; ++x) {
            bool rim = !cells[at(x, y)].counts;
            if (x + 1 < window.columns) rim |= std::abs(depth[at(x + 1, y)] - depth[at(x, y)]) > jump;
            if (y + 1 < window.rows) rim |= std::abs(depth[at(x, y + 1)] - depth[at(x, y)]) > jump;
            off.at<std::uint8_t>(y, x) = rim;
        }
    const int reach = 2 * int(std::ceil(outline_mm / cell_mm)) + 1;
    cv::dilate(off, off, cv::getStructuringElement(cv::MORPH_ELLIPSE, {reach, reach}), {-1, -1}, 1, cv::BORDER_CONSTANT,
               cv::Scalar(1));
    for (int y = 0; y < window.rows; ++y)
        for (int x = 0; x < window.columns; ++x) cells[at(x, y)].counts &= off.at<std::uint8_t>(y, x) == 0;
}

/// What each cell sees, and the prediction's colours there.
std::vector<CellView> views_of(const PredictedBody& body, const SkyOfPlaces& sky, const BodyCamera& camera,
                               const Window& window) {
    const BodyCamera in_cells = camera.window(window.corner_px, 1 / window.px_per_cell);
    const BodyPicture picture =
        picture_of(body, in_cells.window({0, 0}, fine), fine * window.columns, fine * window.rows);
    std::vector<CellView> cells(std::size_t(window.columns) * std::size_t(window.rows));
    std::vector<float> depth(cells.size(), 0.0f);
    parallel_for(0, cells.size(), 64, [&](std::size_t cell) {
        const int column = int(cell % std::size_t(window.columns)), row = int(cell / std::size_t(window.columns));
        CellView& view = cells[cell];
        Eigen::Vector3f rgb = Eigen::Vector3f::Zero(), normal = rgb, position = rgb;
        int on_body = 0;
        for (int s = 0; s < fine * fine; ++s) {
            const std::size_t p = picture.index(fine * column + s % fine, fine * row + s / fine);
            if (!picture.sees(p)) continue;
            ++on_body;
            rgb += picture.of(body, body.rgb, p);
            normal += picture.of(body, body.normal, p);
            position += picture.of(body, body.position, p);
            depth[cell] = picture.depth[p];
            const auto& corners = body.triangles[picture.triangle[p]];
            for (int c = 0; c < 3; ++c) {
                const auto weight = double(picture.weight[p][c]);
                for (std::size_t k = 0; k < sky_terms; ++k)
                    view.place.diffuse[k] += weight * sky.diffuse[corners[std::size_t(c)]][k];
                view.place.covered += weight * sky.covered[corners[std::size_t(c)]];
            }
        }
        if (on_body == 0) return;
        view.body = true;
        view.at = position / float(on_body);
        for (double& term : view.place.diffuse) term /= on_body;
        view.place.covered /= on_body;
        view.place.predicted = rgb.cast<double>() / on_body;
        const Eigen::Vector3d up = normal.cast<double>().normalized(),
                              to_camera = (camera.position() - position.cast<double>() / on_body).normalized();
        look_at(view.place, up, to_camera, body.set.eta);
        const double cosine = up.dot(to_camera);
        view.counts = on_body == fine * fine && cosine >= least_cosine;
    });
    leave_out_rims(cells, depth, window, body.cell_mm);
    return cells;
}

/// What cells of the photograph and of the prediction have, seen by one camera.
struct BodyCells {
    Window window;
    PrintPlace place;
    std::vector<CellView> cells;
    CellSamples samples;
    double clipped = 0;  ///< of those that would count

    [[nodiscard]] std::vector<LitPlace> well_seen() const {
        std::vector<LitPlace> places;
        for (const CellView& cell : cells)
            if (cell.counts) places.push_back(cell.place);
        return places;
    }
};

BodyCells cells_before(const io::Photograph& photo, const PredictedBody& body, const SkyOfPlaces& sky,
                       const BodyCamera& camera, const Eigen::Vector3d& clip) {
    const Window window = window_of(photo, body, camera);
    Eigen::Matrix3d to_px = Eigen::Matrix3d::Identity();
    to_px.topLeftCorner<2, 2>() *= window.px_per_cell;
    to_px.topRightCorner<2, 1>() = window.corner_px;
    BodyCells seen{window,
                   PrintPlace(Rectification(to_px), {window.columns, window.rows}),
                   views_of(body, sky, camera, window),
                   {}};
    seen.samples = sample_cells(photo, seen.place, window.columns, window.rows, clip);
    std::size_t clipped = 0, good = 0;
    for (std::size_t i = 0; i < seen.cells.size(); ++i) {
        seen.cells[i].place.seen = seen.samples.value[i].cast<double>();
        clipped += seen.cells[i].counts && !seen.samples.good[i];
        seen.cells[i].counts &= seen.samples.good[i] != 0;
        good += seen.cells[i].counts;
    }
    if (good < least_cells)
        throw InputError(fmt::format(
            "{}: of the body only {} cells are well seen, away from outlines and not aslant, and {} are "
            "the least; come nearer, expose less where it is clipped, or look at a side that is less curved",
            photo.name, good, least_cells));
    seen.clipped = double(clipped) / double(good + clipped);
    return seen;
}

/// Least and most of what cells that count have.
double light_falls_to(const std::vector<CellView>& cells, const BodyLight& light) {
    double least = 1e30, most = 0;
    for (const CellView& cell : cells)
        if (cell.counts) {
            const double on = light.on(cell.place).mean();
            least = std::min(least, on), most = std::max(most, on);
        }
    return most > 0 ? std::clamp(least / most, 0.0, 1.0) : 1;
}

}  // namespace

BodyReading read_body(io::Photograph photo, const PredictedBody& body, io::SampleCoding coding) {
    BodyReading out;
    PrintReading& reading = out.reading;
    reading.photograph = photo.name;
    reading.width_px = photo.width_px, reading.height_px = photo.height_px;
    const Eigen::Vector3d clip = clipping_level(photo);
    decode(photo, coding);
    PlacedBody placed = place_body(photo, body);
    const SkyOfPlaces sky = sky_before(body, placed.camera);
    BodyCells seen = cells_before(photo, body, sky, placed.camera, clip);
    constexpr int rounds = 2;
    for (int round = 0; round < rounds; ++round) {
        const PredictedBody lit = lit_body(body, sky, placed.camera, BodyLight::fit(seen.well_seen()));
        placed.camera = refine_place(photo, lit, placed.camera);
        seen = cells_before(photo, body, sky, placed.camera, clip);
    }
    const Window& window = seen.window;
    std::vector<CellView>& cells = seen.cells;
    reading.found.place = seen.place;
    reading.found.correlation = placed.correlation;
    reading.cells = std::move(seen.samples);
    reading.clipped = seen.clipped;
    const BodyLight light = BodyLight::fit(seen.well_seen());
    PredictedPrint& print = out.print;
    print.name = body.name, print.model = body.model, print.illuminant = body.illuminant, print.set = body.set;
    print.columns = window.columns, print.rows = window.rows;
    print.cell_mm = Eigen::Vector2d::Constant(body.cell_mm);
    print.rgb.assign(cells.size(), Eigen::Vector3f::Constant(ground_grey));
    std::size_t counted = 0, of_body = 0;
    for (std::size_t i = 0; i < cells.size(); ++i) {
        of_body += cells[i].body;
        if (cells[i].body) print.rgb[i] = cells[i].place.predicted.cast<float>();
        cells[i].counts &= light.on(cells[i].place).mean() >= least_light && !light.highlight(cells[i].place);
        counted += cells[i].counts;
        if (cells[i].counts) reading.cells.value[i] = light.colour(cells[i].place).cast<float>();
        reading.cells.good[i] = cells[i].counts;
    }
    print.by_paths = print.rgb;
    print.seen = body.eye(window.columns, window.rows, print.cell_mm);
    print.of_body = true;
    reading.light_from_body = true;
    reading.light_falls_to = light_falls_to(cells, light);
    reading.left_out = 1 - double(counted) / double(std::max<std::size_t>(of_body, 1));
    reading.overlap = placed.overlap;
    const BodyCamera& camera = placed.camera;
    reading.camera = {camera.position(), camera.position() + camera.before(body.middle()).z() * camera.ahead(),
                      camera.up(), camera.focal_px() * optics::film_width_mm / photo.width_px};
    if (reading.left_out > some_left_out)
        reading.warnings.push_back(named_warning(
            "body-left-out",
            fmt::format("{}: {:.0f} % of what is seen of the body were left out: aslant, beside outlines, in shadow, "
                        "mirroring or overexposed.",
                        photo.name, 100 * reading.left_out)));
    return out;
}

}  // namespace voxtone::calibration
