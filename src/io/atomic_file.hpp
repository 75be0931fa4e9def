#pragma once
// Files that are either the old or the new one, never a part.

#include <filesystem>
#include <functional>
#include <string>

namespace whirl::io {

/// Lets `write` make the file at a temporary path beside `path`, syncs it to disk and renames it to `path`.
///
/// Makes the folder if it is missing. If anything throws, the temporary file is removed and `path` is untouched.
void replace_file(const std::filesystem::path& path, const std::function<void(const std::filesystem::path&)>& write);

/// The same with given content.
void replace_file(const std::filesystem::path& path, const std::string& content);

}  // namespace whirl::io
