// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/layers/volume_vdb.h"

#include "io/programs/module_function.h"

namespace voxtone::io {

void write_volume_vdb(const std::filesystem::path& file, const std::filesystem::path& numbers,
                      const StackDescription& stack, const std::filesystem::path& folder, Progress* progress) {
    using Write = void(const std::filesystem::path&, const std::filesystem::path&, const StackDescription&,
                       const std::filesystem::path&, Progress*);
    reinterpret_cast<Write*>(module_function("voxtone-vdb.so", "voxtone_write_resin_grids"))(file, numbers, stack,
                                                                                             folder, progress);
}

}  // namespace voxtone::io
