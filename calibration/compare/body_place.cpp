// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/compare/body_place.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include <fmt/format.h>
#include <Eigen/Cholesky>
#include <opencv2/imgproc.hpp>

#include "base/error.h"
#include "calibration/compare/print_finder.h"
#include "optics/numerics/median.h"

namespace voxtone::calibration {

namespace {

constexpr double least_log = 0.03;  // of white: added before logarithms, so that noise in blacks does not count
constexpr double least_pattern_correlation = 0.6;  // of the pattern; a right place has 0.8 to 0.99
constexpr double least_overlap = 0.8;              // of the outlines
constexpr float well_inside = 0.97f;
constexpr float least_inside = 0.6f;  // of what a pattern is smoothed over
constexpr double focal_doubt = 0.2;   // standard deviation of ln of the focal length that was told
constexpr double degree = std::numbers::pi / 180;

/// The photograph in larger pixels, and where something stands before the ground in it, or may stand.
struct Reduced {
    int by = 1;
    cv::Mat rgb, inside, perhaps;  // CV_32FC3, CV_32FC1
};

Reduced reduced(const io::Photograph& photo, const Silhouette& silhouette, int by) {
    const int columns = int(photo.width_px) / by, rows = int(photo.height_px) / by;
    Reduced picture{by, cv::Mat(rows, columns, CV_32FC3), cv::Mat(rows, columns, CV_32FC1),
                    cv::Mat(rows, columns, CV_32FC1)};
    for (int y = 0; y < rows; ++y)
        for (int x = 0; x < columns; ++x) {
            Eigen::Vector3f sum = Eigen::Vector3f::Zero();
            for (int v = 0; v < by; ++v)
                for (int u = 0; u < by; ++u)
                    sum += photo.pixels[photo.index(std::uint32_t(x * by + u), std::uint32_t(y * by + v))];
            sum /= float(by * by);
            picture.rgb.at<cv::Vec3f>(y, x) = {sum[0], sum[1], sum[2]};
            const auto of = [&](int at, int limit) {
                return std::size_t(std::min(int((at + 0.5) * by / silhouette.reduced), limit - 1));
            };
            const auto part =
                silhouette.part[of(y, silhouette.rows) * std::size_t(silhouette.columns) + of(x, silhouette.columns)];
            picture.inside.at<float>(y, x) = part == Silhouette::thing;
            picture.perhaps.at<float>(y, x) = part == Silhouette::thing_or_its_shadow;
        }
    return picture;
}

/// The same of the prediction, its outline without holes as that of the photograph is.
struct Drawn {
    BodyPicture picture;
    cv::Mat rgb, inside, sees;
};

Drawn drawn(const PredictedBody& body, const BodyCamera& camera, int columns, int rows) {
    Drawn d{picture_of(body, camera, columns, rows), cv::Mat::zeros(rows, columns, CV_32FC3), {}, {}};
    cv::Mat sees = cv::Mat::zeros(rows, columns, CV_8UC1);
    for (int y = 0; y < rows; ++y)
        for (int x = 0; x < columns; ++x) {
            const std::size_t pixel = d.picture.index(x, y);
            if (!d.picture.sees(pixel)) continue;
            sees.at<std::uint8_t>(y, x) = 1;
            const Eigen::Vector3f rgb = d.picture.of(body, body.rgb, pixel);
            d.rgb.at<cv::Vec3f>(y, x) = {rgb[0], rgb[1], rgb[2]};
        }
    std::vector<std::vector<cv::Point>> contours;
    cv::findContours(sees, contours, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
    cv::Mat filled = cv::Mat::zeros(rows, columns, CV_8UC1);
    cv::drawContours(filled, contours, -1, cv::Scalar(1), cv::FILLED);
    filled.convertTo(d.inside, CV_32F);
    sees.convertTo(d.sees, CV_32F);
    return d;
}

cv::Mat blurred(const cv::Mat& picture, double sigma) {
    cv::Mat out;
    cv::GaussianBlur(picture, out, {}, sigma, sigma, cv::BORDER_CONSTANT);
    return out;
}

/// Logarithms smoothed on what is inside alone, less what lies around, as far as it is inside; `weight`: how much of
/// what is smoothed is inside.
cv::Mat pattern(const cv::Mat& rgb, const cv::Mat& inside, double sigma, cv::Mat& weight) {
    std::array<std::vector<float>, 3> values;
    for (int y = 0; y < rgb.rows; ++y)
        for (int x = 0; x < rgb.cols; ++x)
            if (inside.at<float>(y, x) > 0)
                for (int c = 0; c < 3; ++c) values[std::size_t(c)].push_back(rgb.at<cv::Vec3f>(y, x)[c]);
    std::array<float, 3> white{1, 1, 1};
    for (std::size_t c = 0; c < 3; ++c) {
        if (values[c].empty()) continue;
        const auto at = values[c].begin() + std::ptrdiff_t(double(values[c].size() - 1) * 0.95);
        std::nth_element(values[c].begin(), at, values[c].end());
        white[c] = std::max(*at, 1e-6f);
    }
    cv::Mat logs = cv::Mat::zeros(rgb.size(), CV_32FC3);
    for (int y = 0; y < rgb.rows; ++y)
        for (int x = 0; x < rgb.cols; ++x)
            for (int c = 0; c < 3; ++c)
                logs.at<cv::Vec3f>(y, x)[c] =
                    inside.at<float>(y, x) *
                    std::log(std::max(rgb.at<cv::Vec3f>(y, x)[c] / white[std::size_t(c)], 0.0f) + float(least_log));
    const double wide = 5 * sigma + 4;
    const cv::Mat near = blurred(logs, sigma), far = blurred(logs, wide), far_weight = blurred(inside, wide);
    weight = blurred(inside, sigma);
    cv::Mat out = cv::Mat::zeros(rgb.size(), CV_32FC3);
    for (int y = 0; y < rgb.rows; ++y)
        for (int x = 0; x < rgb.cols; ++x) {
            const float w = weight.at<float>(y, x), f = far_weight.at<float>(y, x);
            if (!(w > 0.1f)) continue;
            for (int c = 0; c < 3; ++c)
                out.at<cv::Vec3f>(y, x)[c] = near.at<cv::Vec3f>(y, x)[c] / w - far.at<cv::Vec3f>(y, x)[c] / f;
        }
    return out;
}

/// Of two pictures about 0, over all channels, where enough is inside.
double pattern_correlation(const cv::Mat& a, const cv::Mat& b, const cv::Mat& weight) {
    double ab = 0, aa = 0, bb = 0;
    for (int y = 0; y < a.rows; ++y)
        for (int x = 0; x < a.cols; ++x) {
            if (weight.at<float>(y, x) < least_inside) continue;
            const cv::Vec3f &p = a.at<cv::Vec3f>(y, x), &q = b.at<cv::Vec3f>(y, x);
            ab += double(p.dot(q)), aa += double(p.dot(p)), bb += double(q.dot(q));
        }
    return ab / std::sqrt(std::max(aa * bb, 1e-30));
}

/// The photograph's outline, where a shadow may lie as the prediction has it.
cv::Mat outline_beside(const Reduced& seen, const cv::Mat& own) { return seen.inside + seen.perhaps.mul(own); }

double overlap_of(const cv::Mat& a, const cv::Mat& b) {
    const double both = a.dot(b), one = cv::sum(a)[0] + cv::sum(b)[0] - both;
    return both / std::max(one, 1.0);
}

/// How far off and aside: area and middle of both outlines agree.
void centre(BodyCamera& camera, const PredictedBody& body, const Reduced& seen) {
    const Eigen::Vector3d pivot = body.middle();
    constexpr int rounds = 4;
    for (int round = 0; round < rounds; ++round) {
        const BodyCamera here = camera.window({0, 0}, 1.0 / seen.by);
        const Drawn d = drawn(body, here, seen.rgb.cols, seen.rgb.rows);
        const cv::Moments own = cv::moments(d.inside), wanted = cv::moments(outline_beside(seen, d.inside));
        if (own.m00 < 1) return;
        const Eigen::Vector2d off(wanted.m10 / wanted.m00 - own.m10 / own.m00,
                                  wanted.m01 / wanted.m00 - own.m01 / own.m00);
        const double depth = camera.before(pivot).z();
        BodyCamera::Step step = BodyCamera::Step::Zero();
        step.segment<2>(3) = off / here.px_per_mm(pivot);
        step[5] = depth * (std::clamp(std::sqrt(own.m00 / wanted.m00), 0.3, 3.0) - 1);
        camera.move(step, pivot);
    }
}

struct Level {
    int by;          ///< pixels of the photograph along a pixel
    double sigma;    ///< in those
    double outline;  ///< weight of the outline against the pattern
};

/// What is held against each other at a level.
struct Misfit {
    Drawn own;
    cv::Mat own_outline, seen_outline, own_pattern, seen_pattern, pattern_weight;
    double correlation, overlap;
    /// Of what a place is judged by.
    [[nodiscard]] double score(const Level& level) const {
        return (correlation + level.outline * overlap) / (1 + level.outline);
    }
};

Misfit misfit_of(const PredictedBody& body, const BodyCamera& camera, const Reduced& seen, const Level& level) {
    Misfit m{drawn(body, camera.window({0, 0}, 1.0 / seen.by), seen.rgb.cols, seen.rgb.rows), {}, {}, {}, {}, {}, 0, 0};
    m.own_outline = blurred(m.own.inside, level.sigma);
    const cv::Mat outline = outline_beside(seen, m.own.inside);
    m.seen_outline = blurred(outline, level.sigma);
    const cv::Mat both = m.own.sees.mul(outline);
    m.own_pattern = pattern(m.own.rgb, both, level.sigma, m.pattern_weight);
    m.seen_pattern = pattern(seen.rgb, both, level.sigma, m.pattern_weight);
    m.correlation = pattern_correlation(m.own_pattern, m.seen_pattern, m.pattern_weight);
    m.overlap = overlap_of(m.own.inside, outline);
    return m;
}

/// Where a place of the body lies before the camera that moves as each pixel does: the one that is seen there, or the
/// nearest that is.
std::vector<Eigen::Vector3f> places_before(const PredictedBody& body, const BodyCamera& camera, const Drawn& own) {
    cv::Mat outside, distance, label;
    own.sees.convertTo(outside, CV_8U);
    outside = 1 - outside;
    cv::distanceTransform(outside, distance, label, cv::DIST_L2, cv::DIST_MASK_5, cv::DIST_LABEL_PIXEL);
    std::vector<std::size_t> of_label;
    for (int y = 0; y < label.rows; ++y)
        for (int x = 0; x < label.cols; ++x)
            if (!outside.at<std::uint8_t>(y, x)) {
                const auto at = std::size_t(label.at<int>(y, x));
                if (of_label.size() <= at) of_label.resize(at + 1);
                of_label[at] = own.picture.index(x, y);
            }
    std::vector<Eigen::Vector3f> places(own.picture.triangle.size());
    for (int y = 0; y < label.rows; ++y)
        for (int x = 0; x < label.cols; ++x) {
            const std::size_t pixel = of_label[std::size_t(label.at<int>(y, x))];
            places[own.picture.index(x, y)] =
                camera.before(own.picture.of(body, body.position, pixel).cast<double>()).cast<float>();
        }
    return places;
}

/// One step of Gauss-Newton; gives back how far it moves the body's rim, in pixels of the level.
double improve(BodyCamera& camera, const PredictedBody& body, const Misfit& m, const Level& level) {
    constexpr int n = BodyCamera::numbers;
    const Eigen::Vector3d pivot = body.middle();
    const BodyCamera here = camera.window({0, 0}, 1.0 / level.by);
    const std::vector<Eigen::Vector3f> places = places_before(body, here, m.own);
    Eigen::Matrix<double, n, n> normal = Eigen::Matrix<double, n, n>::Zero();
    Eigen::Matrix<double, n, 1> right = Eigen::Matrix<double, n, 1>::Zero();
    const auto add = [&](const cv::Mat& own, const cv::Mat& seen, double share, const cv::Mat* within) {
        cv::Mat along_x, along_y;
        const cv::Mat both = 0.5 * (own + seen);
        cv::Sobel(both, along_x, CV_32F, 1, 0, 3, 1.0 / 8, 0, cv::BORDER_REPLICATE);
        cv::Sobel(both, along_y, CV_32F, 0, 1, 3, 1.0 / 8, 0, cv::BORDER_REPLICATE);
        const int channels = own.channels();
        cv::Mat off = seen - own;
        const auto counts = [&](int x, int y) { return !within || within->at<float>(y, x) >= least_inside; };
        double squares = 0;
        for (int y = 0; y < off.rows; ++y)
            for (int x = 0; x < off.cols; ++x)
                for (int c = 0; c < channels; ++c)
                    if (counts(x, y)) squares += std::pow(double(off.ptr<float>(y)[channels * x + c]), 2);
        const double scale = squares / std::max(cv::sum(m.own.inside)[0] * channels, 1.0);
        if (!(scale > 0)) return;
        for (int y = 1; y + 1 < own.rows; ++y)
            for (int x = 1; x + 1 < own.cols; ++x) {
                const float *gx = along_x.ptr<float>(y) + channels * x, *gy = along_y.ptr<float>(y) + channels * x,
                            *r = off.ptr<float>(y) + channels * x;
                if (!counts(x, y)) continue;
                double most = 0;
                for (int c = 0; c < channels; ++c)
                    most = std::max({most, std::abs(double(gx[c])), std::abs(double(gy[c]))});
                if (most < 1e-6) continue;
                const auto by = here.by_step(places[m.own.picture.index(x, y)].cast<double>(), pivot);
                for (int c = 0; c < channels; ++c) {
                    const double weight = share / scale * std::pow(scale / (scale + double(r[c]) * double(r[c])), 2);
                    const Eigen::Matrix<double, n, 1> row =
                        -(double(gx[c]) * by.row(0) + double(gy[c]) * by.row(1)).transpose();
                    normal += weight * row * row.transpose();
                    right += weight * double(r[c]) * row;
                }
            }
    };
    add(m.own_pattern, m.seen_pattern, 1, &m.pattern_weight);
    add(m.own_outline, m.seen_outline, level.outline, nullptr);
    normal.row(6).setZero(), normal.col(6).setZero();
    normal(6, 6) = 1, right[6] = 0;
    normal.diagonal() *= 1 + 1e-3;
    normal.diagonal().array() += 1e-9;
    BodyCamera::Step step = normal.ldlt().solve(right);
    // No farther at once than Gauss-Newton's straight lines may be believed.
    const double turned = step.head<3>().norm(), most = 8 * degree;
    if (turned > most) step *= most / turned;
    camera.move(step, pivot);
    const double reach_px = std::sqrt(cv::sum(m.own.inside)[0]) / 2, px_per_mm = here.px_per_mm(pivot);
    return step.head<3>().norm() * reach_px + step.segment<2>(3).norm() * px_per_mm +
           std::abs(step[5]) / here.before(pivot).z() * reach_px;
}

/// What a place's colours say of the camera, and what the outline said before: an outline in a photograph is where a
/// threshold has it, to some pixels, and its scale may come of depth or of focal length.
class PatternStep {
public:
    static constexpr int n = BodyCamera::numbers;
    using Matrix = Eigen::Matrix<double, n, n>;
    using Vector = BodyCamera::Step;

    /// `moved`: steps since the outline.
    PatternStep(const Level& level, double reach_px, double px_per_mm, double depth_mm, const Vector& moved) {
        constexpr double outline_px = 3;
        const double neighbours =
            4 * std::numbers::pi * level.sigma * level.sigma;  // within the blur they say the same
        const auto add = [&](const Vector& row) {
            normal_ += neighbours * row * row.transpose();
            right_ -= neighbours * row.dot(moved) * row;
        };
        for (int k = 0; k < 3; ++k) add(Vector::Unit(k) * (reach_px / outline_px));
        for (int k = 3; k < 5; ++k) add(Vector::Unit(k) * (px_per_mm / outline_px));
        add((Vector::Unit(6) - Vector::Unit(5) / depth_mm) * (reach_px / outline_px));  // wider or narrower all round
        add(Vector::Unit(6) / focal_doubt);
    }
    void add(const Matrix& normal, const Vector& right, double weight) {
        normal_ += weight * normal;
        right_ += weight * right;
    }
    [[nodiscard]] Vector solved() const { return normal_.ldlt().solve(right_); }

private:
    Matrix normal_ = Matrix::Zero();
    Vector right_ = Vector::Zero();
};

/// One step of Gauss-Newton by the pattern, where all that it is smoothed over is inside. The prediction's gradients
/// have no noise, which would shorten the step; contrasts of the photograph's channels are taken as they are. Gives
/// back how far it moves places, in pixels of the level.
double improve_by_pattern(BodyCamera& camera, const PredictedBody& body, const Misfit& m, const Level& level,
                          BodyCamera::Step& moved) {
    const Eigen::Vector3d pivot = body.middle();
    const BodyCamera here = camera.window({0, 0}, 1.0 / level.by);
    cv::Mat along_x, along_y;
    cv::Sobel(m.own_pattern, along_x, CV_32F, 1, 0, 3, 1.0 / 8, 0, cv::BORDER_REPLICATE);
    cv::Sobel(m.own_pattern, along_y, CV_32F, 0, 1, 3, 1.0 / 8, 0, cv::BORDER_REPLICATE);
    const auto each = [&](auto&& what) {
        for (int y = 1; y + 1 < along_x.rows; ++y)
            for (int x = 1; x + 1 < along_x.cols; ++x)
                if (m.pattern_weight.at<float>(y, x) >= well_inside && m.own.picture.sees(m.own.picture.index(x, y)))
                    what(x, y);
    };
    Eigen::Vector3d both = Eigen::Vector3d::Zero(), own = both;
    double count = 0;
    each([&](int x, int y) {
        for (int c = 0; c < 3; ++c) {
            const auto p = double(m.own_pattern.at<cv::Vec3f>(y, x)[c]);
            both[c] += p * double(m.seen_pattern.at<cv::Vec3f>(y, x)[c]), own[c] += p * p;
        }
        ++count;
    });
    if (count == 0) return 0;
    const Eigen::Vector3d contrast = both.cwiseQuotient(own.cwiseMax(1e-12)).cwiseMax(0.1);
    const auto off = [&](int x, int y, int c) {
        return double(m.seen_pattern.at<cv::Vec3f>(y, x)[c]) -
               contrast[c] * double(m.own_pattern.at<cv::Vec3f>(y, x)[c]);
    };
    struct Window {
        double count = 0, squares = 0;
        std::array<double, 3> off{};
        std::array<PatternStep::Vector, 3> row{PatternStep::Vector::Zero(), PatternStep::Vector::Zero(),
                                               PatternStep::Vector::Zero()};
        PatternStep::Matrix normal = PatternStep::Matrix::Zero();
        PatternStep::Vector right = PatternStep::Vector::Zero();
    };
    const int edge = std::max(16, int(10 * level.sigma)), across = along_x.cols / edge + 1;
    std::vector<Window> windows(std::size_t(across) * std::size_t(along_x.rows / edge + 1));
    PatternStep::Matrix flow = PatternStep::Matrix::Zero();
    each([&](int x, int y) {
        const std::size_t pixel = m.own.picture.index(x, y);
        const auto by = here.by_step(here.before(m.own.picture.of(body, body.position, pixel).cast<double>()), pivot);
        flow += by.transpose() * by / count;
        Window& window = windows[std::size_t(y / edge * across + x / edge)];
        ++window.count;
        for (int c = 0; c < 3; ++c) {
            const double r = off(x, y, c), gx = double(along_x.at<cv::Vec3f>(y, x)[c]),
                         gy = double(along_y.at<cv::Vec3f>(y, x)[c]);
            const PatternStep::Vector row = -contrast[c] * (gx * by.row(0) + gy * by.row(1)).transpose();
            window.normal += row * row.transpose();
            window.right += r * row;
            window.squares += r * r;
            window.off[std::size_t(c)] += r, window.row[std::size_t(c)] += row;
        }
    });
    // What a window has in common is light or gloss.
    std::vector<double> variances;
    for (Window& window : windows) {
        if (window.count == 0) continue;
        for (std::size_t c = 0; c < 3; ++c) {
            window.normal -= window.row[c] * window.row[c].transpose() / window.count;
            window.right -= window.off[c] * window.row[c] / window.count;
            window.squares -= window.off[c] * window.off[c] / window.count;
        }
        variances.push_back(window.squares / (3 * window.count));
    }
    const double usual = std::max(optics::median(variances), 1e-12);
    PatternStep fit(level, std::sqrt(cv::sum(m.own.inside)[0]) / 2, here.px_per_mm(pivot), here.before(pivot).z(),
                    moved);
    for (const Window& window : windows)
        if (window.count > 0)
            fit.add(window.normal, window.right, 1 / std::max(window.squares / (3 * window.count), usual));
    const BodyCamera::Step step = fit.solved();
    camera.move(step, pivot);
    moved += step;
    return std::sqrt(std::max(0.0, step.dot(flow * step)));
}

struct Fitted {
    BodyCamera camera;
    double score = -2, correlation = -1, overlap = 0;
};

/// Of all steps of a level the one that fits best is kept.
Fitted refine(Fitted best, const PredictedBody& body, const Reduced& seen, const Level& level, int most_steps) {
    BodyCamera camera = best.camera;
    best.score = -2;
    for (int step = 0; step <= most_steps; ++step) {
        const Misfit m = misfit_of(body, camera, seen, level);
        const double score = m.score(level);
        if (score > best.score) best = {camera, score, m.correlation, m.overlap};
        if (score < best.score - 0.1 || step == most_steps) break;
        if (improve(camera, body, m, level) < 0.02 * level.sigma) break;
    }
    return best;
}

/// A level whose picture has some so many pixels along its longer side.
int reduced_by(const io::Photograph& photo, double px) {
    return std::max(1, int(std::lround(std::max(photo.width_px, photo.height_px) / px)));
}

/// Turned a little about all three axes, the best of all that come to rest on a coarse picture.
Fitted coarse_place(const PredictedBody& body, const BodyCamera& start, const Reduced& seen, int tries) {
    const Level level{seen.by, 0.012 * std::max(seen.rgb.cols, seen.rgb.rows), 1};
    constexpr double aside = 16 * degree;
    Fitted best;
    for (int k = 0; k < tries; ++k) {
        constexpr std::array<std::array<int, 3>, 9> ways{
            {{0, 0, 0}, {0, 1, 0}, {0, -1, 0}, {1, 0, 0}, {-1, 0, 0}, {1, 1, 0}, {-1, -1, 0}, {1, -1, 0}, {-1, 1, 0}}};
        BodyCamera camera = start;
        BodyCamera::Step step = BodyCamera::Step::Zero();
        for (int a = 0; a < 3; ++a) step[a] = aside * ways[std::size_t(k)][std::size_t(a)];
        camera.move(step, body.middle());
        centre(camera, body, seen);
        const Fitted found = refine({.camera = camera}, body, seen, level, 10);
        if (found.score > best.score) best = found;
    }
    return best;
}

bool is_right(const Fitted& f) { return f.correlation >= least_pattern_correlation && f.overlap >= least_overlap; }

io::Photograph mirrored(const io::Photograph& photo) {
    io::Photograph out = photo;
    for (std::uint32_t y = 0; y < photo.height_px; ++y)
        for (std::uint32_t x = 0; x < photo.width_px; ++x)
            out.pixels[out.index(x, y)] = photo.pixels[photo.index(photo.width_px - 1 - x, y)];
    return out;
}

/// Why nothing fits: seen from another side, mirrored, or another print. Throws InputError.
[[noreturn]] void tell_why(const io::Photograph& photo, const PredictedBody& body, const Fitted& found, int by) {
    const auto best_side = [&](const io::Photograph& picture) {
        const Reduced seen = reduced(picture, find_silhouette(picture), by);
        std::pair<Fitted, std::string> best;
        for (const PredictedBody::OtherSide& side : body.other_sides) {
            const Fitted f =
                coarse_place(body, BodyCamera(side.start(int(photo.width_px), int(photo.height_px))), seen, 1);
            if (f.score > best.first.score) best = {f, side.name};
        }
        return best;
    };
    const auto [upright, side] = best_side(photo);
    const auto [flipped, _] = best_side(mirrored(photo));
    if (is_right(flipped) && flipped.score > upright.score)
        throw InputError(fmt::format(
            "{}: the print is mirrored against {}: only its mirror image fits the photograph, so that set-up or camera "
            "mirrors; print `voxtone target marker`, which tells the axis, and set what its page says in the printer's "
            "profile, or give the photograph as it was taken",
            photo.name, body.name));
    if (is_right(upright))
        throw InputError(fmt::format("{}: {} is seen from another side: --view {} fits the photograph; say so",
                                     photo.name, body.name, side));
    throw InputError(fmt::format(
        "{}: this is no photograph of {} from about there: the pattern correlates by {:.2f} at best, and {:.1f} is the "
        "least, the outlines overlap by {:.0f} %, and {:.0f} % is the least; say from where it was taken, within some "
        "20 degrees (--view, --turn, --up, as `proof` has them), or give the photograph of this print",
        photo.name, body.name, found.correlation, least_pattern_correlation, 100 * found.overlap, 100 * least_overlap));
}

}  // namespace

PlacedBody place_body(const io::Photograph& photo, const PredictedBody& body) {
    const Silhouette silhouette = find_silhouette(photo);
    const int coarse = reduced_by(photo, 160), middle = reduced_by(photo, 400);
    Reduced seen = reduced(photo, silhouette, coarse);
    const BodyCamera start(body.start(int(photo.width_px), int(photo.height_px)));
    Fitted best = coarse_place(body, start, seen, 1);
    if (!is_right(best)) best = coarse_place(body, start, seen, 9);
    seen = reduced(photo, silhouette, middle);
    best = refine(best, body, seen, {middle, 3, 0.5}, 12);
    if (!is_right(best)) tell_why(photo, body, best, coarse);
    const Fitted judged = best;  // noise counts little there
    best = refine(best, body, seen, {middle, 1.5, 0.2}, 12);
    const double px_per_cell = best.camera.px_per_mm(body.middle()) * body.cell_mm;
    if (px_per_cell < 1)
        throw InputError(fmt::format(
            "{}: the photograph is too small: a cell of the prediction ({:.3f} mm) is {:.2f} pixels wide, and at least "
            "one is needed; come nearer, or compare larger cells (--cell {:.2f}mm)",
            photo.name, body.cell_mm, px_per_cell, 1.1 * body.cell_mm / px_per_cell));
    return {best.camera, judged.correlation, judged.overlap};
}

BodyCamera refine_place(const io::Photograph& photo, const PredictedBody& body, BodyCamera camera) {
    const int fine = reduced_by(photo, 1000);
    const Reduced seen = reduced(photo, find_silhouette(photo), fine);
    BodyCamera::Step moved = BodyCamera::Step::Zero();
    constexpr int most_steps = 8;
    for (const Level level : {Level{fine, 3, 0}, Level{fine, 1.5, 0}})
        for (int step = 0; step < most_steps; ++step)
            if (improve_by_pattern(camera, body, misfit_of(body, camera, seen, level), level, moved) < 0.01) break;
    return camera;
}

}  // namespace voxtone::calibration
