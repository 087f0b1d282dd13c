// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/edge/dictionary_file.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <fmt/format.h>

#include "base/error.h"
#include "io/files/deflate.h"
#include "io/files/json_object.h"
#include "io/files/json_writer.h"
#include "io/files/whole_file.h"
#include "io/files/xxh64.h"

namespace voxtone::calibration {
namespace {

constexpr std::uint64_t most_dictionary_bytes = std::uint64_t{1} << 30;
constexpr std::size_t record_head = 16;  // run, length, digest

std::size_t kernel_size() { return optics::distance_bins().size(); }
// Per node: scales of P and K, from_camera, from_base, noise as floats; then both kernels.
std::size_t record_size() { return albedo_nodes * (5 * sizeof(float) + 2 * kernel_size() * sizeof(std::uint16_t)); }

template <class Number>
void put(std::vector<std::byte>& bytes, Number number) {
    const auto* raw = reinterpret_cast<const std::byte*>(&number);
    bytes.insert(bytes.end(), raw, raw + sizeof number);
}

template <class Number>
Number take(const std::byte*& at) {
    Number number;
    std::memcpy(&number, at, sizeof number);
    at += sizeof number;
    return number;
}

void put_kernel(std::vector<std::byte>& bytes, const Eigen::VectorXd& kernel, double scale) {
    for (const double v : kernel)
        put(bytes, static_cast<std::uint16_t>(scale > 0 ? std::lround(std::clamp(v / scale, 0.0, 1.0) * 65535) : 0));
}

Eigen::VectorXd take_kernel(const std::byte*& at, double scale) {
    Eigen::VectorXd kernel(static_cast<Eigen::Index>(kernel_size()));
    for (double& v : kernel) v = take<std::uint16_t>(at) * scale / 65535;
    return kernel;
}

std::vector<std::byte> plain_bytes(const EdgeRecord& record) {
    std::vector<std::byte> bytes;
    bytes.reserve(record_size());
    for (std::size_t k = 0; k < albedo_nodes; ++k) {
        const optics::EdgeKernels& kernels = record.kernels[k];
        const double P = kernels.P.maxCoeff(), K = kernels.K.maxCoeff();
        for (const double v : {P, K, kernels.from_camera, kernels.from_base, record.noise[k]})
            put(bytes, static_cast<float>(v));
        put_kernel(bytes, kernels.P, P);
        put_kernel(bytes, kernels.K, K);
    }
    return bytes;
}

EdgeRecord record_of(const std::vector<std::byte>& bytes) {
    EdgeRecord record;
    const std::byte* at = bytes.data();
    for (std::size_t k = 0; k < albedo_nodes; ++k) {
        const double P = take<float>(at), K = take<float>(at);
        optics::EdgeKernels kernels;
        kernels.from_camera = take<float>(at);
        kernels.from_base = take<float>(at);
        record.noise.push_back(take<float>(at));
        kernels.P = take_kernel(at, P);
        kernels.K = take_kernel(at, K);
        record.kernels.push_back(std::move(kernels));
    }
    return record;
}

std::uint64_t digest(const std::uint8_t* data, std::size_t size) { return io::xxh64({data, size}); }

EdgeDictionary parse_header(std::string_view line, const std::string& source) {
    const io::JsonObject root = io::JsonObject::parse(line, source);
    root.allow_only({"format", "version", "setup", "thickness_mm", "g", "sigma_t_per_mm", "paths", "seed"});
    if (root.text("format") != "voxtone-edge-dictionary") root.fail("format", "expected \"voxtone-edge-dictionary\"");
    static_cast<void>(root.integer("version", 1, 1));
    EdgeDictionary dictionary;
    dictionary.setup = parse_edge_setup(root.text("setup"), source + ": setup");
    dictionary.grid.thickness_mm = root.numbers("thickness_mm", 0, 0.05, 10);
    dictionary.grid.g = root.numbers("g", 0, -0.95, 0.95);
    dictionary.grid.sigma_t = root.numbers("sigma_t_per_mm", 0, 0.01, 200);
    dictionary.grid.paths = static_cast<std::uint32_t>(root.integer("paths", 1024, 0xFFFFFFFFu));
    dictionary.grid.seed = root.integer("seed", 0, ~std::uint64_t{0});
    validate(dictionary.grid);
    if (dictionary.grid.runs() > 1000000) root.fail("g", "the grid has more than a million runs");
    dictionary.records.resize(dictionary.grid.runs());
    return dictionary;
}

}  // namespace

std::vector<std::uint8_t> dictionary_header(const EdgeSetup& setup, const EdgeGrid& grid) {
    io::JsonWriter json;
    json.begin_object().add("format", "voxtone-edge-dictionary").add("version", 1);
    json.add("setup", edge_setup_text(setup)).add("thickness_mm", grid.thickness_mm).add("g", grid.g);
    json.add("sigma_t_per_mm", grid.sigma_t).add("paths", grid.paths).add("seed", grid.seed).end_object();
    const std::string text = json.text() + "\n";
    return {text.begin(), text.end()};
}

std::vector<std::uint8_t> dictionary_record(std::size_t run, const EdgeRecord& record) {
    const std::vector<std::byte> small = io::deflated(plain_bytes(record), 9);
    std::vector<std::uint8_t> bytes(record_head + small.size());
    const auto index = static_cast<std::uint32_t>(run), size = static_cast<std::uint32_t>(small.size());
    std::memcpy(bytes.data() + record_head, small.data(), small.size());
    const std::uint64_t sum = digest(bytes.data() + record_head, small.size()) ^ index;
    std::memcpy(bytes.data(), &index, 4);
    std::memcpy(bytes.data() + 4, &size, 4);
    std::memcpy(bytes.data() + 8, &sum, 8);
    return bytes;
}

EdgeDictionary read_dictionary(const std::filesystem::path& file, bool cut_off) {
    const std::vector<std::uint8_t> bytes = io::read_whole_file(file, most_dictionary_bytes);
    const auto end_of_line = std::ranges::find(bytes, std::uint8_t{'\n'});
    if (end_of_line == bytes.end() || bytes.empty() || bytes.front() != '{')
        throw InputError(
            fmt::format("{} is no dictionary of edge profiles; make one with `voxtone calibrate edge "
                        "dictionary`.",
                        file.string()));
    std::size_t at = static_cast<std::size_t>(end_of_line - bytes.begin()) + 1;
    EdgeDictionary dictionary = parse_header({reinterpret_cast<const char*>(bytes.data()), at - 1}, file.string());
    const auto broken = [&](const char* why) {
        return InputError(fmt::format("{}: {} at byte {}: the file is damaged; make it again, or copy it again.",
                                      file.string(), why, at));
    };
    while (at < bytes.size()) {
        std::uint32_t run = 0, size = 0;
        std::uint64_t sum = 0;
        const bool whole_head = bytes.size() - at >= record_head;
        if (whole_head) {
            std::memcpy(&run, bytes.data() + at, 4);
            std::memcpy(&size, bytes.data() + at + 4, 4);
            std::memcpy(&sum, bytes.data() + at + 8, 8);
        }
        if (!whole_head || size > bytes.size() - at - record_head) {
            if (cut_off) break;
            throw broken("a record is cut off");
        }
        if (run >= dictionary.records.size() || (digest(bytes.data() + at + record_head, size) ^ run) != sum) {
            if (cut_off) break;
            throw broken("a record does not match its checksum");
        }
        const auto* data = reinterpret_cast<const std::byte*>(bytes.data() + at + record_head);
        dictionary.records[run] = record_of(io::inflated({data, size}, record_size()));
        at += record_head + size;
    }
    return dictionary;
}

std::vector<std::uint8_t> dictionary_bytes(const EdgeDictionary& dictionary) {
    std::vector<std::uint8_t> bytes = dictionary_header(dictionary.setup, dictionary.grid);
    for (std::size_t run = 0; run < dictionary.records.size(); ++run) {
        if (dictionary.records[run].kernels.empty()) continue;
        const std::vector<std::uint8_t> record = dictionary_record(run, dictionary.records[run]);
        bytes.insert(bytes.end(), record.begin(), record.end());
    }
    return bytes;
}

std::vector<std::size_t> missing_runs(const EdgeDictionary& dictionary) {
    std::vector<std::size_t> missing;
    for (std::size_t run = 0; run < dictionary.records.size(); ++run)
        if (dictionary.records[run].kernels.empty()) missing.push_back(run);
    return missing;
}

}  // namespace voxtone::calibration
