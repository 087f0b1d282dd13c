// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/part/artefact.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <memory>
#include <system_error>
#include <utility>

#include <fmt/core.h>

#include "base/error.h"
#include "io/disk/disk_space.h"
#include "io/disk/part_files.h"
#include "io/files/whole_file.h"
#include "io/files/xxh64.h"

namespace voxtone::slicer {

namespace {

constexpr std::size_t digest_size = sizeof(std::uint64_t);

bool begins_with(std::span<const std::byte> bytes, std::string_view text) {
    return bytes.size() >= text.size() && std::memcmp(bytes.data(), text.data(), text.size()) == 0;
}

std::uint64_t digest_at(std::span<const std::byte> bytes, std::size_t at) {
    std::uint64_t digest = 0;
    std::memcpy(&digest, bytes.data() + at, digest_size);
    return digest;
}

struct CloseArtefact {
    void operator()(std::FILE* file) const { std::fclose(file); }
};

}  // namespace

std::uint64_t digest_of_text(std::string_view text) {
    return io::xxh64({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

Artefact::Artefact(std::filesystem::path file, const ArtefactKind& kind)
    : file_(std::move(file)), kind_(kind), magic_(fmt::format("{} {}\n", kind.name, kind.version)) {}

bool Artefact::exists() const {
    std::error_code none;
    return std::filesystem::exists(file_, none);
}

std::vector<std::byte> Artefact::begin(std::size_t bytes) const {
    std::vector<std::byte> begin(bytes);
    std::ifstream in(file_, std::ios::binary);
    in.read(reinterpret_cast<char*>(begin.data()), std::streamsize(begin.size()));
    begin.resize(std::size_t(in.gcount()));
    return begin;
}

ArtefactKey Artefact::key_in(std::span<const std::byte> head) const {
    if (!begins_with(head, magic_)) {
        if (head.size() >= magic_.size() && begins_with(head, fmt::format("{} ", kind_.name)))
            throw InputError(fmt::format("{}: {}", file_.string(), kind_.outdated));
        fail_broken();
    }
    if (head.size() < magic_.size() + 2 * digest_size) fail_broken();
    return {digest_at(head, magic_.size()), digest_at(head, magic_.size() + digest_size)};
}

std::optional<ArtefactKey> Artefact::key() const {
    if (!exists()) return std::nullopt;
    return key_in(begin(magic_.size() + 2 * digest_size));
}

std::vector<std::byte> Artefact::first_values(std::size_t bytes) const {
    const std::size_t head = magic_.size() + 2 * digest_size;
    std::vector<std::byte> all = begin(head + bytes);
    if (all.size() < head + bytes || !begins_with(all, magic_)) return {};
    return {all.begin() + std::ptrdiff_t(head), all.end()};
}

Artefact::Content Artefact::read(std::span<const ArtefactKey> ours) const {
    constexpr std::uint64_t most = std::uint64_t{1} << 36;
    Content content{io::read_whole_file(file_, most), {}};
    const auto bytes = std::as_bytes(std::span(content.file));
    const std::size_t head = magic_.size() + 2 * digest_size;
    const ArtefactKey key = key_in(bytes.first(std::min(head, bytes.size())));
    if (bytes.size() < head + digest_size) fail_broken();
    const std::size_t end = bytes.size() - digest_size;
    if (io::xxh64(std::span(content.file).first(end)) != digest_at(bytes, end)) fail_broken();
    if (std::ranges::find(ours, key) == ours.end()) fail_foreign();
    content.values = bytes.first(end).subspan(head);
    return content;
}

void Artefact::write(const ArtefactKey& key, const Put& put) const {
    io::sweep_parts_of(file_);
    const std::filesystem::path part = io::part_path(file_);
    const std::unique_ptr<std::FILE, CloseArtefact> out(std::fopen(part.c_str(), "wbe"));
    if (!out) io::fail_to_write(file_, "cannot be created", errno);
    int fault = 0;
    const auto write = [&](const void* data, std::size_t more) {
        if (fault == 0 && std::fwrite(data, 1, more, out.get()) != more) fault = errno;
    };
    io::Xxh64 sum;
    io::PackedWriter to([&](const void* data, std::size_t more) {
        sum.update(data, more);
        write(data, more);
    });
    to.add(std::as_bytes(std::span(magic_)));
    to(key.opened, key.job);
    put(to);
    const std::uint64_t digest = sum.digest();
    write(&digest, digest_size);
    if (std::fflush(out.get()) != 0 && fault == 0) fault = errno;
    if (fault != 0) {
        std::error_code not_there;
        std::filesystem::remove(part, not_there);
        io::fail_to_write(file_, "could not be written", fault);
    }
    io::finish_part(file_);
}

void Artefact::fail_broken() const { throw FileError(fmt::format("{}: {}", file_.string(), kind_.broken)); }

void Artefact::fail_foreign() const { throw InputError(fmt::format("{}: {}", file_.string(), kind_.foreign)); }

}  // namespace voxtone::slicer
