// SPDX-License-Identifier: GPL-3.0-or-later
//
// A file without a name: nobody else sees it, and nothing is left of it however the program ends.
#pragma once

#include <filesystem>

#include "io/disk/open_file.h"
#include "optics/numerics/scratch_space.h"

namespace voxtone::io {

class ScratchFile final : public optics::ScratchSpace {
public:
    /// In a folder that is there. Throws FileError, TryAgain where the disk is full, as `write` does.
    explicit ScratchFile(const std::filesystem::path& folder);
    void write(std::uint64_t at, std::span<const std::byte> bytes) override;
    void read(std::uint64_t at, std::span<std::byte> bytes) const override;

private:
    std::filesystem::path folder_;
    OpenFile file_;
};

}  // namespace voxtone::io
