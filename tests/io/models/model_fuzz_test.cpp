// SPDX-License-Identifier: GPL-3.0-or-later
//
// Hostile files: every truncation of every file of the samples, and many with wrong bytes. Each gives a model or an
// InputError (or FileError), in bounded time; nothing else.
#include <catch2/catch.hpp>

#include "base/error.h"
#include "base/random.h"
#include "compressed_samples.h"
#include "io/codecs/read_here.h"
#include "io/models/model_reader.h"
#include "model_samples.h"
#include "tests/io/files/in_child.h"

using namespace voxtone;
using namespace voxtone::io;
using namespace voxtone::test;

namespace {

/// And those that want the libraries' encoders.
std::vector<Files> samples() {
    std::vector<Files> all = every_sample();
    all.push_back({{"draco.glb", draco_glb({ball(4)})}, {"t.png", four_colours()}});
    all.push_back({{"sequential.glb", draco_glb({ball(3)}, {11, true})}, {"t.png", four_colours()}});
    all.push_back({{"meshopt.glb", meshopt_glb(ball(4))}, {"t.png", four_colours()}});
    all.push_back({{"a.zip", zip({{"source/" + all[0][0].first, all[0][0].second},
                                  {"source/" + all[0][1].first, all[0][1].second},
                                  {"textures/" + all[0][2].first, all[0][2].second}})}});
    return all;
}

struct Tally {
    int models = 0, refused = 0, crashed = 0;
    std::string first_crash;
};

/// Reads the files with every change in turn, `batch` changes to a child process: what must not reach the parent is the
/// crash. Where a child dies, its changes are tried one by one, so that one crash costs one change.
void try_changes(const Folder& folder, const Files& files, std::size_t first, std::size_t last, std::size_t batch,
                 const std::function<Files(std::size_t)>& change, Tally& tally) {
    const std::string name = files.front().first;
    for (std::size_t begin = first; begin < last; begin += batch) {
        const std::size_t end = std::min(begin + batch, last);
        try {
            const std::vector<std::byte> outcome = in_child([&] {
                std::vector<std::byte> results;
                ReadOptions options;
                options.max_pixels = 1 << 20;
                for (std::size_t i = begin; i < end; ++i) {
                    try {
                        (void)read_model_here(folder.write(change(i)), options);
                        results.push_back(std::byte{1});
                    } catch (const InputError&) {
                        results.push_back(std::byte{0});
                    } catch (const FileError&) {
                        results.push_back(std::byte{0});
                    }
                }
                return results;
            });
            for (const std::byte result : outcome) ++(result == std::byte{1} ? tally.models : tally.refused);
        } catch (const ChildDied& error) {
            if (end - begin > 1) {
                try_changes(folder, files, begin, end, 1, change, tally);
                continue;
            }
            ++tally.crashed;
            if (tally.first_crash.empty()) tally.first_crash = "change " + std::to_string(begin) + ": " + error.what();
        }
    }
}

}  // namespace

TEST_CASE("every truncation of small models gives a model or a clear error") {
    const Folder folder;
    for (const Files& files : samples()) {
        (void)read_model(folder.write(files));  // whole, it is fine
        for (std::size_t f = 0; f < files.size(); ++f) {
            Tally tally;
            const std::string whole = files[f].second;
            try_changes(
                folder, files, 0, whole.size(), 64,
                [&](std::size_t length) {
                    Files cut = files;
                    cut[f].second = whole.substr(0, length);
                    return cut;
                },
                tally);
            INFO(files[0].first << " with " << files[f].first << " cut: " << tally.models << " read, " << tally.refused
                                << " refused, " << tally.crashed << " crashed; " << tally.first_crash);
            CHECK(tally.crashed == 0);
        }
    }
}

TEST_CASE("every truncation of the model part in a 3MF package") {
    const Folder folder;
    const std::string part =
        R"(<?xml version="1.0"?><!-- c --><model unit="inch"><resources><colorgroup id="1"><color color="#FF000080"/></colorgroup>)"
        R"(<multiproperties id="5" pids="1 1" blendmethods="multiply"><multi pindices="0 0"/></multiproperties>)"
        R"(<object id="2" pid="5" pindex="0">)" +
        threemf_tetrahedron(1, {R"(pid="1" p1="0" p2="0" p3="0")"}) +
        R"(</object></resources><build><item objectid="2" transform="1 0 0 0 1 0 0 0 1 0 0 1e3"/></build></model>)";
    const Files files{{"a.3mf", zip({{"3D/3dmodel.model", part}})}};
    CHECK(read_model(folder.write(files)).mesh.triangles.size() == 4);
    Tally tally;
    try_changes(
        folder, files, 0, part.size(), 64,
        [&](std::size_t length) {
            return Files{{"a.3mf", zip({{"3D/3dmodel.model", part.substr(0, length)}})}};
        },
        tally);
    CHECK(std::size_t(tally.refused) == part.size());
    CHECK(tally.models == 0);
}

TEST_CASE("wrong bytes in small models") {
    const Folder folder;
    constexpr std::size_t changes = 60;  // tools/fuzz tries a million
    for (const Files& files : samples())
        for (std::size_t f = 0; f < files.size(); ++f) {
            Tally tally;
            try_changes(
                folder, files, 0, changes, 50,
                [&](std::size_t i) {
                    RandomStream random(11, i, static_cast<std::uint32_t>(f));
                    Files wrong = files;
                    std::string& text = wrong[f].second;
                    const std::size_t count = 1 + random.bits() % 4;
                    for (std::size_t k = 0; k < count; ++k) {
                        // a random byte, or one that numbers and sizes are made of
                        constexpr std::string_view interesting(
                            "\0\xff\x7f\x80"
                            "9-e#\"<>{}/ \n",
                            16);
                        text[random.bits() % text.size()] = random.bits() % 2
                                                                ? interesting[random.bits() % interesting.size()]
                                                                : static_cast<char>(random.bits() & 255);
                    }
                    return wrong;
                },
                tally);
            INFO(files[0].first << " with wrong bytes in " << files[f].first << ": " << tally.models << " read, "
                                << tally.refused << " refused, " << tally.crashed << " crashed; " << tally.first_crash);
            CHECK(tally.crashed == 0);
        }
}
