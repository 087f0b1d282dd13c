// SPDX-License-Identifier: GPL-3.0-or-later
//
// An artefact: what a job has made and leaves on disk, so that a later run of it need not make it again. The kinds are
// a body (prepared_body.h), what its appearance loop came to (skin_file.h) and the state of a loop that was interrupted
// (loop_checkpoint.h); each says what its key is, reads and writes. The layers of a range lie in folders of their own
// (io/shards/shard_folder.h).
//
// The file: its kind and version, key, values, XXH64 of all before; in native byte order, as it is read where it was
// written; whole or not there. Digests are XXH64: nobody gains by a forged artefact, and they must cost nothing beside
// what is kept.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/files/packed_values.h"

namespace voxtone::slicer {

/// Whose it is: digests of what a job is known by before its model is read, so that another's is refused before time is
/// spent, and of all that decides what the artefact holds.
struct ArtefactKey {
    std::uint64_t opened = 0, job = 0;
    bool operator==(const ArtefactKey&) const = default;
};
[[nodiscard]] std::uint64_t digest_of_text(std::string_view text);

struct ArtefactKind {
    std::string_view name;  ///< "voxtone-skin"
    int version = 1;
    /// What is wrong with a file, why it matters and what to try, behind its name.
    std::string_view broken, foreign, outdated;
};

class Artefact {
public:
    /// `kind` lasts as long.
    Artefact(std::filesystem::path file, const ArtefactKind& kind);

    [[nodiscard]] const std::filesystem::path& path() const { return file_; }
    [[nodiscard]] bool exists() const;
    /// Nothing where there is none. Throws FileError for what is none of its kind, InputError for another version's.
    [[nodiscard]] std::optional<ArtefactKey> key() const;
    /// The first bytes of its values, without a look at what follows them; nothing where that cannot be had.
    [[nodiscard]] std::vector<std::byte> first_values(std::size_t bytes) const;

    struct Content {
        std::vector<std::uint8_t> file;
        std::span<const std::byte> values;  ///< in `file`
    };
    /// Throws FileError where it is not there or not whole, InputError where its key is none of `ours`.
    [[nodiscard]] Content read(std::span<const ArtefactKey> ours) const;

    /// Puts the values in their order, without a copy of all.
    using Put = std::function<void(io::PackedWriter& to)>;
    /// Throws FileError, TryAgain; what was there before stays then.
    void write(const ArtefactKey& key, const Put& put) const;

    /// FileError: its values do not fit together.
    [[noreturn]] void fail_broken() const;
    /// InputError: it is another job's.
    [[noreturn]] void fail_foreign() const;

private:
    [[nodiscard]] std::vector<std::byte> begin(std::size_t bytes) const;
    [[nodiscard]] ArtefactKey key_in(std::span<const std::byte> head) const;

    std::filesystem::path file_;
    const ArtefactKind& kind_;
    std::string magic_;
};

}  // namespace voxtone::slicer
