// SPDX-License-Identifier: GPL-3.0-or-later
//
// Room for bytes outside of memory, for what will be wanted again but not soon. Whoever works knows what to put there;
// whoever starts the work knows where it may lie.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>

namespace voxtone::optics {

class ScratchSpace {
public:
    ScratchSpace() = default;
    ScratchSpace(const ScratchSpace&) = delete;
    ScratchSpace& operator=(const ScratchSpace&) = delete;
    virtual ~ScratchSpace() = default;
    /// At so many bytes from the beginning; what lies there is written over. Throws where there is no room.
    virtual void write(std::uint64_t at, std::span<const std::byte> bytes) = 0;
    /// Contract: all of them were written. From several threads at once, while nobody writes.
    virtual void read(std::uint64_t at, std::span<std::byte> bytes) const = 0;
};

/// Called once it turns out that some is needed.
using MakeScratch = std::function<std::unique_ptr<ScratchSpace>()>;

}  // namespace voxtone::optics
