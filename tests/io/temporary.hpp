#pragma once
// A folder of its own for each test and rank, removed at the end.

#include <stdlib.h>

#include <filesystem>
#include <string>

namespace whirl::test {

class Temporary {
public:
  Temporary() {
    std::string pattern = (std::filesystem::temp_directory_path() / "whirl-test-XXXXXX").string();
    path_ = mkdtemp(pattern.data());
  }
  Temporary(const Temporary&) = delete;
  Temporary& operator=(const Temporary&) = delete;
  ~Temporary() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  [[nodiscard]] std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

private:
  std::filesystem::path path_;
};

}  // namespace whirl::test
