// SPDX-License-Identifier: GPL-3.0-or-later
//
// The judge of indices and phase functions by resin: light paths through a box of voxels without a line of the program
// (no header of it is included; random numbers, Fresnel, phase function and the walk are its own). A path begins at the
// top, evenly over a strip, from diffuse light that the surface lets in, and is led backwards from voxel to voxel until
// it leaves by the top or the bottom; the four sides mirror. What is followed is radiance / index^2, which refraction
// leaves as it is, so that a box that absorbs nothing sends back 1.
//
// From standard input, words apart by blanks, mm and mm^-1:
//   inside(straight|faces) x y z, the pitch, then nx ny nz, channels materials strips PATHS SEED
//   per material: index g, then per channel sigma_t albedo
//   the voxels: a material each, x fastest, then y, then z from the bottom
// straight: rays go straight from voxel to voxel, and the surface has the index of the voxel that lies at it; faces:
// each face between voxels of different index reflects and refracts too.
// To standard output a line a strip along x: the share that comes back and its standard error of each channel.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iomanip>
#include <iostream>
#include <string>
#include <vector>

namespace {

constexpr double pi = 3.14159265358979323846;
using Vector = std::array<double, 3>;

/// Splitmix of a counter: a stream a path.
class Draw {
public:
    explicit Draw(std::uint64_t seed) : state_(seed * 0xd1342543de82ef95ULL + 0x2545f4914f6cdd1dULL) {}
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
    double index = 1, g = 0;
    std::vector<double> sigma_t, albedo;
};

/// Unpolarised reflectance from `from` into `to` at a cosine, by the angles; `sine` gets that beyond (above 1: none).
double reflectance(double cosine, double from, double to, double& sine) {
    const double in = std::acos(std::min(1.0, cosine));
    sine = from / to * std::sin(in);
    if (sine >= 1) return 1;
    const double out = std::asin(sine);
    if (in < 1e-6) return std::pow((from - to) / (from + to), 2);
    return 0.5 * (std::pow(std::sin(in - out) / std::sin(in + out), 2) +
                  std::pow(std::tan(in - out) / std::tan(in + out), 2));
}

/// True where the ray goes through, refracted; else it is mirrored.
bool cross(Vector& d, std::size_t axis, double from, double to, Draw& draw) {
    double sine = 0;
    const double R = reflectance(std::abs(d[axis]), from, to, sine);
    if (draw() < R) {
        d[axis] = -d[axis];
        return false;
    }
    const double along = std::copysign(std::sqrt(1 - sine * sine), d[axis]);
    for (std::size_t a = 0; a < 3; ++a) d[a] *= a == axis ? 0 : from / to;
    d[axis] = along;
    return true;
}

void scatter(Vector& d, double g, Draw& draw) {
    double cosine = 2 * draw() - 1;
    if (std::abs(g) > 1e-6) {
        const double q = (1 - g * g) / (1 + g * cosine);
        cosine = (1 + g * g - q * q) / (2 * g);
    }
    const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine)), phi = 2 * pi * draw();
    // Two directions across d from the axis that is farthest from it.
    const std::size_t far = std::abs(d[0]) < 0.6 ? 0 : 1;
    Vector e{}, f{};
    for (std::size_t a = 0; a < 3; ++a) e[a] = (a == far ? 1 : 0) - d[far] * d[a];
    const double length = std::sqrt(e[0] * e[0] + e[1] * e[1] + e[2] * e[2]);
    for (double& v : e) v /= length;
    for (std::size_t a = 0; a < 3; ++a) f[a] = d[(a + 1) % 3] * e[(a + 2) % 3] - d[(a + 2) % 3] * e[(a + 1) % 3];
    Vector to{};
    for (std::size_t a = 0; a < 3; ++a) to[a] = cosine * d[a] + sine * (std::cos(phi) * e[a] + std::sin(phi) * f[a]);
    d = to;
}

struct Box {
    bool faces = false;
    Vector pitch{};
    std::array<int, 3> n{};
    std::vector<Stuff> stuff;
    std::vector<int> voxels;
    [[nodiscard]] const Stuff& at(const std::array<int, 3>& v) const {
        return stuff[std::size_t(voxels[std::size_t((v[2] * n[1] + v[1]) * n[0] + v[0])])];
    }

    /// Weight of one path from a strip.
    double path(std::size_t channel, double x0, double x1, Draw& draw) const {
        Vector at{x0 + (x1 - x0) * draw(), draw() * n[1] * pitch[1], n[2] * pitch[2]};
        std::array<int, 3> v{};
        for (std::size_t a = 0; a < 3; ++a) v[a] = std::min(n[a] - 1, int(at[a] / pitch[a]));
        Vector d{};
        do {  // by the cosine law, until the surface lets it in
            const double r = std::sqrt(draw()), phi = 2 * pi * draw();
            d = {r * std::cos(phi), r * std::sin(phi), -std::sqrt(1 - r * r)};
        } while (!cross(d, 2, 1, this->at(v).index, draw));
        double weight = 1, left = -std::log(draw());
        for (;;) {
            double step = 1e30;
            std::size_t axis = 0;
            for (std::size_t a = 0; a < 3; ++a) {
                if (d[a] == 0) continue;
                const double to = ((d[a] > 0 ? v[a] + 1 : v[a]) * pitch[a] - at[a]) / d[a];
                if (to < step) step = std::max(0.0, to), axis = a;
            }
            const Stuff& here = this->at(v);
            const double sigma_t = here.sigma_t[channel];
            if (sigma_t * step > left) {
                for (std::size_t a = 0; a < 3; ++a) at[a] += d[a] * left / sigma_t;
                weight *= here.albedo[channel];
                if (weight < 0.05) {
                    if (draw() * 0.05 > weight) return 0;
                    weight = 0.05;
                }
                scatter(d, here.g, draw);
                left = -std::log(draw());
                continue;
            }
            left -= sigma_t * step;
            for (std::size_t a = 0; a < 3; ++a) at[a] += d[a] * step;
            const int towards = d[axis] > 0 ? 1 : -1, next = v[axis] + towards;
            at[axis] = (v[axis] + (towards > 0 ? 1 : 0)) * pitch[axis];
            if (next >= 0 && next < n[axis]) {
                std::array<int, 3> beyond = v;
                beyond[axis] = next;
                const double from = here.index, to = this->at(beyond).index;
                if (!faces || from == to || cross(d, axis, from, to, draw)) v = beyond;
            } else if (axis < 2) {
                d[axis] = -d[axis];
            } else if (cross(d, axis, here.index, 1, draw)) {
                return weight;
            }
        }
    }
};

}  // namespace

int main() {
    Box box;
    std::string inside;
    std::cin >> inside >> box.pitch[0] >> box.pitch[1] >> box.pitch[2] >> box.n[0] >> box.n[1] >> box.n[2];
    box.faces = inside == "faces";
    std::size_t channels = 0, materials = 0, strips = 0, paths = 0;
    std::uint64_t seed = 0;
    std::cin >> channels >> materials >> strips >> paths >> seed;
    box.stuff.resize(materials);
    for (Stuff& stuff : box.stuff) {
        stuff.sigma_t.resize(channels), stuff.albedo.resize(channels);
        std::cin >> stuff.index >> stuff.g;
        for (std::size_t c = 0; c < channels; ++c) std::cin >> stuff.sigma_t[c] >> stuff.albedo[c];
    }
    box.voxels.resize(std::size_t(box.n[0]) * std::size_t(box.n[1]) * std::size_t(box.n[2]));
    for (int& v : box.voxels) std::cin >> v;
    if (!std::cin || (inside != "faces" && inside != "straight")) {
        std::cerr << "index_tracer: what is read is not as its head says\n";
        return 1;
    }
    std::cout << std::setprecision(8);
    const double width = box.n[0] * box.pitch[0];
    for (std::size_t s = 0; s < strips; ++s) {
        for (std::size_t c = 0; c < channels; ++c) {
            double sum = 0, squares = 0;
            for (std::size_t p = 0; p < paths; ++p) {
                Draw draw(((seed * 64 + s) * 64 + c) * 0x100000000ULL + p);
                const double w =
                    box.path(c, width * double(s) / double(strips), width * double(s + 1) / double(strips), draw);
                sum += w, squares += w * w;
            }
            const double mean = sum / double(paths);
            std::cout << mean << ' ' << std::sqrt(std::max(0.0, squares / double(paths) - mean * mean) / double(paths))
                      << (c + 1 < channels ? ' ' : '\n');
        }
    }
}
