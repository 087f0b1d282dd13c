// SPDX-License-Identifier: GPL-3.0-or-later
//
// The judge of what a camera reads from squares that have ends: light paths through a slab of squares let into a base,
// without a line of the program (no header of it is included; random numbers, Fresnel and phase function are its own).
// A path begins at the camera straight above, evenly over a window, and is led backwards; at each collision the light,
// which falls at 45 degrees towards -x upon all of the slab, is joined through the resins that lie on its way (Woodcock
// collisions; joins exact). Smooth surface to air above; below air above a black sheet, or nothing that reflects.
// Sides are without end: the outermost material goes on.
//
// From standard input, words apart by blanks, mm and mm^-1:
//   eta g under(air|black) base_mm top_mm channels materials PATHS SEED THREADS
//   per material and channel: sigma_t albedo                      (channel by channel within a material)
//   material of the base everywhere, count, then x0 y0 x1 y1 material of each rectangle in it; later ones replace
//   the same of the layer on top
//   windows, then x0 y0 x1 y1 of each
//   perhaps: checkers, then of each material cell_x cell_y sigma_x sigma_y one other: this material is, from place to
//   place, the two materials in cells from the origin on, blurred by a Gaussian of these standard deviations
//   perhaps: mm of clear resin over all of it, of the same index, which takes up nothing
// To standard output a line a window: rho(45 -> 0) = pi L / E and its standard error of each channel.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iomanip>
#include <iostream>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace {

constexpr double pi = 3.14159265358979323846;

/// Splitmix of a counter: a stream a path.
class Draw {
public:
    explicit Draw(std::uint64_t seed) : state_(seed) {}
    double operator()() {
        std::uint64_t z = (state_ += 0x9e3779b97f4a7c15ULL);
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
        return (double((z ^ (z >> 31)) >> 11) + 0.5) * 0x1p-53;
    }

private:
    std::uint64_t state_;
};

struct Stuff {
    double sigma_t, albedo;
};

struct Rectangle {
    double x0, y0, x1, y1;
    int material;
};

/// Which material lies where: a grid of the rectangles' edges.
/// A square wave of -1 and 1 and half-period `cell`, blurred by a Gaussian: its Fourier series, from a table.
class Wave {
public:
    Wave() = default;
    Wave(double cell, double sigma) : period_(2 * cell), table_(samples) {
        for (std::size_t i = 0; i < samples; ++i) {
            const double x = period_ * (double(i) + 0.5) / double(samples);
            if (sigma <= 0) {
                table_[i] = x < cell ? 1 : -1;
                continue;
            }
            for (int k = 1; k < 2000; k += 2) {
                const double wave = pi * k / cell;
                table_[i] += 4 / (pi * k) * std::sin(wave * x) * std::exp(-wave * wave * sigma * sigma / 2);
            }
        }
    }
    [[nodiscard]] double operator()(double x) const {
        const double turns = x / period_;
        return table_[std::min(std::size_t((turns - std::floor(turns)) * double(samples)), samples - 1)];
    }

private:
    static constexpr std::size_t samples = 4096;
    double period_ = 1;
    std::vector<double> table_;
};

struct Checker {
    Wave x, y;
    int one = 0, other = 0;
};

class Plan {
public:
    void read(std::istream& in) {
        std::size_t count = 0;
        int ground = 0;
        in >> ground >> count;
        std::vector<Rectangle> all(count);
        for (Rectangle& r : all) in >> r.x0 >> r.y0 >> r.x1 >> r.y1 >> r.material;
        for (const Rectangle& r : all) x_.insert(x_.end(), {r.x0, r.x1}), y_.insert(y_.end(), {r.y0, r.y1});
        for (auto* edges : {&x_, &y_}) {
            std::sort(edges->begin(), edges->end());
            edges->erase(std::unique(edges->begin(), edges->end()), edges->end());
        }
        cell_.assign((x_.size() + 1) * (y_.size() + 1), ground);
        for (std::size_t j = 0; j + 1 < y_.size(); ++j)
            for (std::size_t i = 0; i + 1 < x_.size(); ++i)
                for (const Rectangle& r : all)
                    if (r.x0 <= x_[i] && x_[i + 1] <= r.x1 && r.y0 <= y_[j] && y_[j + 1] <= r.y1)
                        cell_[(j + 1) * (x_.size() + 1) + i + 1] = r.material;
    }
    [[nodiscard]] std::size_t column(double x) const {
        return std::size_t(std::upper_bound(x_.begin(), x_.end(), x) - x_.begin());
    }
    [[nodiscard]] std::size_t row(double y) const {
        return std::size_t(std::upper_bound(y_.begin(), y_.end(), y) - y_.begin());
    }
    [[nodiscard]] int at(std::size_t column, std::size_t row) const { return cell_[row * (x_.size() + 1) + column]; }
    [[nodiscard]] double right_of(std::size_t column) const { return column < x_.size() ? x_[column] : 1e300; }

private:
    std::vector<double> x_, y_;
    std::vector<int> cell_;
};

double fresnel(double eta, double inside) {
    const double sine2 = eta * eta * (1 - inside * inside);
    if (sine2 >= 1) return 1;
    const double outside = std::sqrt(1 - sine2);
    const double s = (eta * inside - outside) / (eta * inside + outside);
    const double p = (inside - eta * outside) / (inside + eta * outside);
    return (s * s + p * p) / 2;
}

struct Vector {
    double x, y, z;
};

struct Slab {
    double eta = 1.5, g = 0, base_mm = 0, top_mm = 0, coat_mm = 0;
    bool air_below = true;
    std::size_t channels = 0;
    std::vector<std::vector<Stuff>> stuff;  ///< by material, by channel
    Plan base, top;
    std::vector<std::pair<int, Checker>> checkers;  ///< by material

    [[nodiscard]] const Checker* checker(int material) const {
        for (const auto& [of, checker] : checkers)
            if (of == material) return &checker;
        return nullptr;
    }
    [[nodiscard]] Stuff stuff_at(int material, std::size_t channel, double x, double y) const {
        const Checker* const found = checker(material);
        if (!found) return stuff[std::size_t(material)][channel];
        const Stuff a = stuff[std::size_t(found->one)][channel], b = stuff[std::size_t(found->other)][channel];
        const double share = 0.5 + 0.5 * found->x(x) * found->y(y);
        const double extinction = share * a.sigma_t + (1 - share) * b.sigma_t;
        return {extinction, (share * a.sigma_t * a.albedo + (1 - share) * b.sigma_t * b.albedo) / extinction};
    }

    /// Optical depth from a place upwards, against the light: towards +x by `slope` of each mm up.
    [[nodiscard]] double depth_of(Vector p, std::size_t channel, double cosine, double slope, double most) const {
        double depth = 0;
        for (const Plan* plan : {&base, &top}) {
            const double ceiling = plan == &base ? base_mm : base_mm + top_mm;
            if (p.z >= ceiling) continue;
            const std::size_t row = plan->row(p.y);
            std::size_t column = plan->column(p.x);
            while (p.z < ceiling && depth < most) {
                const int material = plan->at(column, row);
                constexpr double step_mm = 0.008;  // through checkers
                const double to_edge = (plan->right_of(column) - p.x) / slope;
                const double up = std::min({ceiling - p.z, to_edge, checker(material) ? step_mm : 1e300});
                const double sigma = stuff_at(material, channel, p.x + slope * up / 2, p.y).sigma_t;
                depth += sigma * up / cosine;
                p.x += slope * up;
                p.z = up == ceiling - p.z ? ceiling : p.z + up;
                if (up == to_edge) ++column;
            }
        }
        return depth;
    }
    [[nodiscard]] Stuff at(const Vector& p, std::size_t channel) const {
        const Plan& plan = p.z < base_mm ? base : top;
        return stuff_at(plan.at(plan.column(p.x), plan.row(p.y)), channel, p.x, p.y);
    }
};

double henyey(double g, double cosine) {
    const double d = 1 + g * g - 2 * g * cosine;
    return (1 - g * g) / (4 * pi * d * std::sqrt(d));
}

Vector scattered(double g, const Vector& w, Draw& draw) {
    const double u = draw();
    double cosine = 2 * u - 1;
    if (std::abs(g) > 1e-6) {
        const double s = (1 - g * g) / (1 - g + 2 * g * u);
        cosine = (1 + g * g - s * s) / (2 * g);
    }
    const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine)), phi = 2 * pi * draw();
    // Two directions across w.
    const double sign = w.z < 0 ? -1 : 1, a = -1 / (sign + w.z), b = w.x * w.y * a;
    const Vector s{1 + sign * w.x * w.x * a, sign * b, -sign * w.x}, t{b, sign + w.y * w.y * a, -w.y};
    const double x = sine * std::cos(phi), y = sine * std::sin(phi);
    Vector v{x * s.x + y * t.x + cosine * w.x, x * s.y + y * t.y + cosine * w.y, x * s.z + y * t.z + cosine * w.z};
    const double n = 1 / std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
    return {v.x * n, v.y * n, v.z * n};
}

/// pi L / E of one path.
double path_of(const Slab& slab, const Rectangle& window, std::size_t channel, double majorant, Draw& draw) {
    constexpr double most_depth = 20;
    const double cos_in = std::sqrt(1 - 0.5 / (slab.eta * slab.eta)), slope = std::sqrt(1 - cos_in * cos_in) / cos_in;
    const Vector light{-std::sqrt(1 - cos_in * cos_in), 0, -cos_in};
    const double height = slab.base_mm + slab.top_mm;
    const double scale =
        pi * (1 - fresnel(slab.eta, 1)) / (slab.eta * slab.eta) * (1 - fresnel(slab.eta, cos_in)) / cos_in;
    Vector p{window.x0 + draw() * (window.x1 - window.x0), window.y0 + draw() * (window.y1 - window.y0), height};
    Vector w{0, 0, -1};
    double weight = 1, sum = 0;
    for (;;) {
        double step = -std::log(draw()) / majorant;
        // To a boundary, or a collision that may be none.
        const double wall = w.z < 0 ? -p.z / w.z : w.z > 0 ? (height - p.z) / w.z : 1e300;
        if (step >= wall) {
            p = {p.x + wall * w.x, p.y + wall * w.y, w.z < 0 ? 0 : height};
            if (w.z < 0 && !slab.air_below) return scale * sum;
            if (draw() >= fresnel(slab.eta, std::abs(w.z))) return scale * sum;
            // Through the coat, where its outer face sends it back, and down again.
            const double coat = w.z > 0 ? 2 * slab.coat_mm / w.z : 0;
            p.x += coat * w.x, p.y += coat * w.y;
            w.z = -w.z;
            continue;
        }
        p = {p.x + step * w.x, p.y + step * w.y, p.z + step * w.z};
        const Stuff here = slab.at(p, channel);
        if (draw() * majorant >= here.sigma_t) continue;
        weight *= here.albedo;
        // What comes to the camera goes along -w.
        const double phase = henyey(slab.g, -(light.x * w.x + light.y * w.y + light.z * w.z));
        const double depth = slab.depth_of(p, channel, cos_in, slope, most_depth);
        if (depth < most_depth) sum += weight * phase * std::exp(-depth);
        constexpr double least = 0.1;
        if (weight < least) {
            if (draw() >= 0.5) return scale * sum;
            weight *= 2;
        }
        w = scattered(slab.g, w, draw);
    }
}

}  // namespace

int main() {
    std::ios::sync_with_stdio(false);
    Slab slab;
    std::string under;
    std::size_t materials = 0, paths = 0, windows = 0, threads = 1;
    std::uint64_t seed = 1;
    std::cin >> slab.eta >> slab.g >> under >> slab.base_mm >> slab.top_mm >> slab.channels >> materials >> paths >>
        seed >> threads;
    slab.air_below = under == "air";
    slab.stuff.assign(materials, std::vector<Stuff>(slab.channels));
    for (auto& material : slab.stuff)
        for (Stuff& s : material) std::cin >> s.sigma_t >> s.albedo;
    slab.base.read(std::cin);
    slab.top.read(std::cin);
    std::cin >> windows;
    std::vector<Rectangle> where(windows);
    for (Rectangle& r : where) std::cin >> r.x0 >> r.y0 >> r.x1 >> r.y1;
    const bool read = bool(std::cin);
    std::size_t checkers = 0;
    for (std::cin >> checkers; std::cin && slab.checkers.size() < checkers;) {
        int material = 0, one = 0, other = 0;
        double cell_x = 1, cell_y = 1, sigma_x = 0, sigma_y = 0;
        std::cin >> material >> cell_x >> cell_y >> sigma_x >> sigma_y >> one >> other;
        slab.checkers.push_back({material, {Wave(cell_x, sigma_x), Wave(cell_y, sigma_y), one, other}});
    }
    double coat_mm = 0;
    if (std::cin && std::cin >> coat_mm) slab.coat_mm = coat_mm;
    if (!read || paths < 2 || threads < 1) {
        std::cerr << "square_tracer: see the head of its source for what it reads\n";
        return 2;
    }
    std::vector<double> majorant(slab.channels, 0);
    for (const auto& material : slab.stuff)
        for (std::size_t c = 0; c < slab.channels; ++c) majorant[c] = std::max(majorant[c], material[c].sigma_t);
    const std::size_t values = windows * slab.channels;
    std::vector<double> mean(values), error(values);
    std::vector<std::thread> crew;
    for (std::size_t t = 0; t < threads; ++t)
        crew.emplace_back([&, t] {
            for (std::size_t v = t; v < values; v += threads) {
                double sum = 0, squares = 0;
                for (std::size_t i = 0; i < paths; ++i) {
                    Draw draw((seed * 0x2545f4914f6cdd1dULL) ^ ((v * paths + i) * 0xd1342543de82ef95ULL));
                    const double value =
                        path_of(slab, where[v / slab.channels], v % slab.channels, majorant[v % slab.channels], draw);
                    sum += value, squares += value * value;
                }
                mean[v] = sum / double(paths);
                error[v] = std::sqrt(std::max(squares / double(paths) - mean[v] * mean[v], 0.0) / double(paths - 1));
            }
        });
    for (std::thread& worker : crew) worker.join();
    std::cout << std::setprecision(7);
    for (std::size_t v = 0; v < values; ++v)
        std::cout << mean[v] << ' ' << error[v] << ((v + 1) % slab.channels == 0 ? '\n' : ' ');
    return 0;
}
