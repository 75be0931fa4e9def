#pragma once
// Error bars of the columns of a table, whose numbers come out on other meshes as well.

#include <string>
#include <vector>

#include "study/bars/error_bar.hpp"
#include "whirl/io/record.hpp"

namespace whirl::study {

/// The same table on one mesh after another, and bars beside those of its columns that change with the mesh.
class TableBars {
public:
  /// Of the columns of real numbers with these names that `table` has now; it outlives this.
  TableBars(io::Group& table, std::vector<std::string> names, const MeshLaw& law);
  /// The table on another mesh; a column that is missing there is unknown there.
  void add(Axis axis, double spacing, const io::Group& there);
  /// Puts NAME_uncertainty beside each column; nothing where no other mesh was added.
  void write();

private:
  io::Group& table_;
  std::vector<std::string> names_;
  std::vector<Bars> bars_;
  bool any_ = false;
};

}  // namespace whirl::study
