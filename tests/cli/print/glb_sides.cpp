// SPDX-License-Identifier: GPL-3.0-or-later
#include "glb_sides.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "tests/cli/run_program.h"

namespace voxtone::test {

namespace {

using Json = nlohmann::json;
using Vector = std::array<double, 3>;

std::uint32_t word(const std::string& bytes, std::size_t at) {
    std::uint32_t value = 0;
    if (at + 4 > bytes.size()) throw std::runtime_error("the GLB is cut short");
    std::memcpy(&value, bytes.data() + at, 4);
    return value;
}

struct Glb {
    Json json;
    std::string binary;
};

Glb chunks(const std::string& bytes) {
    if (!bytes.starts_with("glTF") || word(bytes, 4) != 2 || word(bytes, 8) != bytes.size())
        throw std::runtime_error("this is no GLB of version 2");
    Glb glb;
    for (std::size_t at = 12; at + 8 <= bytes.size(); at += 8 + word(bytes, at)) {
        const std::string chunk = bytes.substr(at + 8, word(bytes, at));
        const std::uint32_t type = word(bytes, at + 4);
        if (type == 0x4E4F534A) glb.json = Json::parse(chunk);
        if (type == 0x004E4942) glb.binary = chunk;
    }
    return glb;
}

double component(const std::string& binary, std::size_t at, int type) {
    const auto read = [&](auto value) {
        if (at + sizeof value > binary.size()) throw std::runtime_error("an accessor leaves the GLB");
        std::memcpy(&value, binary.data() + at, sizeof value);
        return static_cast<double>(value);
    };
    switch (type) {
        case 5121:
            return read(std::uint8_t{}) / 255;
        case 5123:
            return read(std::uint16_t{}) / 65535;
        case 5125:
            return read(std::uint32_t{});
        case 5126:
            return read(float{});
        default:
            throw std::runtime_error("an accessor of a type that is not for this");
    }
}

/// Rows of numbers; integers as shares of the largest but for indices of 32 bits.
std::vector<std::vector<double>> accessor(const Glb& glb, std::size_t index) {
    const Json& a = glb.json.at("accessors").at(index);
    const Json& view = glb.json.at("bufferViews").at(a.at("bufferView").get<std::size_t>());
    const std::string type = a.at("type");
    const std::size_t components = type == "SCALAR" ? 1 : static_cast<std::size_t>(type.back() - '0');
    const int kind = a.at("componentType");
    const std::size_t bytes = kind == 5121 ? 1 : kind == 5123 ? 2 : 4;
    const std::size_t stride = view.value("byteStride", components * bytes);
    const std::size_t first = view.value("byteOffset", std::size_t{0}) + a.value("byteOffset", std::size_t{0});
    std::vector<std::vector<double>> rows(a.at("count").get<std::size_t>());
    for (std::size_t i = 0; i < rows.size(); ++i)
        for (std::size_t c = 0; c < components; ++c)
            rows[i].push_back(component(glb.binary, first + i * stride + c * bytes, kind));
    return rows;
}

double srgb_code(double linear) {
    return 255 * (linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055);
}

struct Triangle {
    std::array<Vector, 3> corner;
    Vector code{};  ///< mean of its corners
};

std::vector<Triangle> triangles(const Glb& glb) {
    std::vector<Triangle> all;
    for (const Json& mesh : glb.json.at("meshes"))
        for (const Json& primitive : mesh.at("primitives")) {
            const Json& attributes = primitive.at("attributes");
            const auto place = accessor(glb, attributes.at("POSITION").get<std::size_t>());
            const auto colour = accessor(glb, attributes.at("COLOR_0").get<std::size_t>());
            const std::size_t indices = primitive.at("indices").get<std::size_t>();
            if (glb.json.at("accessors").at(indices).at("componentType") != 5125)
                throw std::runtime_error("indices of another type than 32 bits");
            const auto index = accessor(glb, indices);
            for (std::size_t i = 0; i + 2 < index.size(); i += 3) {
                Triangle& triangle = all.emplace_back();
                for (std::size_t c = 0; c < 3; ++c) {
                    const auto v = static_cast<std::size_t>(index[i + c][0]);
                    const std::vector<double>& p = place.at(v);
                    triangle.corner[c] = {1000 * p[0], -1000 * p[2], 1000 * p[1]};
                    for (std::size_t k = 0; k < 3; ++k) triangle.code[k] += srgb_code(colour.at(v)[k]) / 3;
                }
            }
        }
    return all;
}

/// Twice the area, along the normal.
Vector area_vector(const Triangle& t) {
    Vector a{}, b{};
    for (std::size_t k = 0; k < 3; ++k) {
        a[k] = t.corner[1][k] - t.corner[0][k];
        b[k] = t.corner[2][k] - t.corner[0][k];
    }
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

int weighted_median(std::vector<std::pair<double, double>> values) {
    std::sort(values.begin(), values.end());
    double whole = 0, sum = 0;
    for (const auto& [value, weight] : values) whole += weight;
    for (const auto& [value, weight] : values)
        if ((sum += weight) >= whole / 2) return static_cast<int>(std::lround(value));
    return -1;
}

}  // namespace

GlbSides glb_sides(const std::filesystem::path& file) {
    const std::vector<Triangle> all = triangles(chunks(read_file(file)));
    Vector least{}, most{};
    least.fill(std::numeric_limits<double>::max());
    most.fill(std::numeric_limits<double>::lowest());
    for (const Triangle& t : all)
        for (const Vector& p : t.corner)
            for (std::size_t k = 0; k < 3; ++k) {
                least[k] = std::min(least[k], p[k]);
                most[k] = std::max(most[k], p[k]);
            }
    GlbSides result;
    for (std::size_t k = 0; k < 3; ++k) result.size_mm[k] = most[k] - least[k];
    std::map<std::string, std::array<std::vector<std::pair<double, double>>, 3>> seen;
    for (const Triangle& t : all) {
        const Vector normal = area_vector(t);
        const double area = std::hypot(normal[0], normal[1], normal[2]);
        for (std::size_t k = 0; k < 3; ++k) {
            if (!(std::abs(normal[k]) > 0.9 * area)) continue;
            const bool up = normal[k] > 0;
            const double middle = (t.corner[0][k] + t.corner[1][k] + t.corner[2][k]) / 3;
            const double away = up ? most[k] - middle : middle - least[k];
            if (away > 0.02 * result.size_mm[k]) continue;
            for (std::size_t c = 0; c < 3; ++c)
                seen[std::string(up ? "+" : "-") + "xyz"[k]][c].emplace_back(t.code[c], area);
        }
    }
    for (auto& [side, values] : seen)
        for (std::size_t c = 0; c < 3; ++c) result.sides[side][c] = weighted_median(std::move(values[c]));
    return result;
}

}  // namespace voxtone::test
