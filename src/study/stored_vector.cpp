#include "stored_vector.hpp"

#include <utility>

namespace whirl::study {

using core::check;
using Eigen::Index;
using Eigen::Map;
using Eigen::MatrixXd;

namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

constexpr const char* unit = "1";  // of scaled entries

// Where this rank's entries stand.
io::RowRange place_of(Vec v) {
  PetscInt begin = 0, size = 0;
  check(VecGetOwnershipRange(v, &begin, nullptr));
  check(VecGetSize(v, &size));
  return {static_cast<std::size_t>(begin), static_cast<std::size_t>(size)};
}

std::size_t rows_here(Vec v) {
  PetscInt local = 0;
  check(VecGetLocalSize(v, &local));
  return static_cast<std::size_t>(local);
}

}  // namespace

std::vector<double> entries_here(Vec v) {
  const core::ReadArray a(v);
  return {a.data(), a.data() + a.size()};
}

void put_vector(io::Group& group, const std::string& name, Vec v, bool shared, const std::string& description) {
  if (!shared) return group.put(name, core::gather(v), unit, description);
  std::vector<double> rows = entries_here(v);
  const std::size_t n = rows.size();
  group.put(name, io::Dataset{{n}, std::move(rows), unit, description, place_of(v)});
}

void take_vector(const io::Group& group, const std::string& name, Vec v) {
  const io::Dataset& data = group.dataset(name);
  if (data.share)
    core::fill(v, data.share->begin, std::get<std::vector<double>>(data.values));
  else
    core::fill(v, group.reals(name));
}

void put_columns(io::Group& group, const std::string& name, const MatrixXd& columns, const SharedRows& shared,
                 const std::string& unit, const std::string& description) {
  // A cycle that is none has no rows either; its ranks have their place nevertheless. One of equal ranks stores.
  const Vec like = shared.like;
  const std::size_t rows = like ? rows_here(like) : static_cast<std::size_t>(columns.rows()),
                    count = static_cast<std::size_t>(columns.cols());
  const bool stores = core::rank_of(shared.time) == 0;
  core::require(!stores || count == 0 || static_cast<std::size_t>(columns.rows()) == rows,
                "columns with the rows of this rank");
  std::vector<double> flat(rows * count);
  if (count > 0 && stores) Map<RowMajor>(flat.data(), columns.rows(), columns.cols()) = columns;
  io::Dataset data{{rows, count}, std::move(flat), unit, description};
  if (like) data.share = place_of(like);
  group.put(name, std::move(data));
}

MatrixXd take_columns(const io::Group& group, const std::string& name, const SharedRows& shared) {
  const Vec like = shared.like;
  const io::Dataset& data = group.dataset(name);
  core::require(like || !data.share, "shared columns want a vector with the rows of this rank");
  const auto& flat = std::get<std::vector<double>>(data.values);
  const Map<const RowMajor> rows(flat.data(), static_cast<Index>(data.shape.at(0)),
                                 static_cast<Index>(data.shape.at(1)));
  if (!like) return rows;
  auto here = static_cast<long>(rows_here(like));
  MPI_Bcast(&here, 1, MPI_LONG, 0, shared.time);
  MatrixXd out(here, rows.cols());
  const core::Vector v = core::duplicate(like);
  std::vector<double> column(data.shape.at(0));
  for (Index k = 0; k < rows.cols(); ++k) {
    Map<Eigen::VectorXd>(column.data(), rows.rows()) = rows.col(k);
    if (data.share)
      core::fill(v.get(), data.share->begin, column);
    else
      core::fill(v.get(), column);
    const core::ReadArray a(v.get());
    if (a.size() > 0) out.col(k) = Map<const Eigen::VectorXd>(a.data(), a.size());
  }
  MPI_Bcast(out.data(), static_cast<int>(out.size()), MPI_DOUBLE, 0, shared.time);
  return out;
}

}  // namespace whirl::study
