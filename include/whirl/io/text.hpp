#pragma once
// Text files beside the results.

#include <filesystem>
#include <string>

namespace whirl::io {

/// Writes `text` to `path` so that `path` always is a complete file. Call on one rank. core::Error if the disk refuses.
void write_text(const std::filesystem::path& path, const std::string& text);

}  // namespace whirl::io
