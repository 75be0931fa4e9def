#pragma once
// Tables of results as text that every spreadsheet reads.

#include <filesystem>
#include <string>
#include <vector>

#include <functional>

#include "whirl/io/record.hpp"

namespace whirl::io {

struct CsvFile {
  std::string name;  ///< of the table: the path of its group, with '.' for '/'
  std::string text;  ///< one line of headers `key [unit]` (`key` alone without a unit), then one line a row
  std::string file;  ///< the name as that of a file, `NAME.csv` (plain_name); `NAME_2.csv` where another table has it
};

/// The tables in a tree of results, as CSV.
///
/// A group is a table if its datasets share their first extent, the rows; where it has datasets of two or three axes,
/// those give the rows, and datasets of one axis with another length stay out. Columns of the other axes bear the
/// labels of the dataset, `x.B1 [m]` and `amplitude.order 2.B1 [m]`, or numbers from 1 where it has none. Numbers are
/// as short as they can be without loss, `nan` where there is none. Left out: groups with the attribute `restart` and
/// all below them, groups with datasets of three axes without labels or of more axes, tables of more than a million
/// cells, and datasets that fit no table.
[[nodiscard]] std::vector<CsvFile> csv_tables(const Group& tree);
/// The same, one after another.
void each_csv_table(const Group& tree, const std::function<void(const CsvFile&)>& visit);

/// Writes one of them; atomic, makes the folder if it is missing.
void write_csv(const std::filesystem::path& path, const CsvFile& table);

}  // namespace whirl::io
