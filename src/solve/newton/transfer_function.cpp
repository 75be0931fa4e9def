#include "whirl/solve/newton/transfer_function.hpp"

#include <algorithm>
#include <cmath>

#include "solve/newton/frequency_inverse.hpp"
#include "solve/newton/real_form.hpp"
#include "solve/newton/transfer_part.hpp"
#include "whirl/core/direct_solver.hpp"
#include "whirl/core/error.hpp"
#include "whirl/core/plan.hpp"
#include "whirl/core/shell.hpp"
#include "whirl/spectral/eigenvalues.hpp"

namespace whirl::solve {

using core::check;
using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;

namespace {

// `to` holds complex columns in real form: reals and imaginary parts of the rows in turn.
template <class F>
void with_columns(Mat m, F&& use) {
  PetscScalar* a = nullptr;
  PetscInt stride = 0, local = 0, columns = 0;
  check(MatGetLocalSize(m, &local, nullptr));
  check(MatGetSize(m, nullptr, &columns));
  check(MatDenseGetArray(m, &a));
  check(MatDenseGetLDA(m, &stride));
  // A column of pairs is a column of complex numbers; the stride is even or there is one column.
  for (PetscInt k = 0; k < columns; ++k)
    use(k, Eigen::Map<VectorXcd>(reinterpret_cast<Complex*>(a + k * stride), local / 2));
  check(MatDenseRestoreArray(m, &a));
}

}  // namespace

void TransferFunction::Coupled::solve(const MatrixXcd& columns, MatrixXcd& out) {
  with_columns(right.get(), [&](PetscInt k, auto to) { to = columns.col(k); });
  check(KSPMatSolve(solver.get(), right.get(), answers.get()));
  if (core::reason_of(solver.get()) < 0)
    throw core::NotConverged("the equations of a film are singular at this frequency");
  out.resize(columns.rows(), columns.cols());
  with_columns(answers.get(), [&](PetscInt k, auto from) { out.col(k) = from; });
}

MatrixXcd TransferFunction::Coupled::rates_times(const MatrixXcd& columns) const {
  core::Vector in, out;
  check(MatCreateVecs(b.get(), in.put(), out.put()));
  MatrixXcd product(columns.rows(), columns.cols());
  for (Index k = 0; k < columns.cols(); ++k)
    for (const bool real_part : {true, false}) {
      {
        const core::WriteArray v(in.get());
        for (Index i = 0; i < columns.rows(); ++i)
          v[static_cast<PetscInt>(i)] = real_part ? columns(i, k).real() : columns(i, k).imag();
      }
      check(MatMult(b.get(), in.get(), out.get()));
      const core::ReadArray v(out.get());
      for (Index i = 0; i < columns.rows(); ++i) {
        const double value = v[static_cast<PetscInt>(i)];
        product(i, k) = real_part ? Complex(value, 0) : Complex(product(i, k).real(), value);
      }
    }
  return product;
}

TransferFunction::TransferFunction(problem::System& system) : system_(system) {
  core::require(system.fields().size() > 1, "a transfer function needs parts");
  rest_ = core::make_vector(system.comm(), system.local_size(), PETSC_DETERMINE);
  state_scale_ = core::duplicate(rest_.get());
  row_scale_ = core::duplicate(rest_.get());
  x_ = core::duplicate(rest_.get());
  PetscInt begin = 0;
  check(VecGetOwnershipRange(rest_.get(), &begin, nullptr));
  std::vector<bool> taken(static_cast<std::size_t>(system.local_size()), false);
  const auto set = [&](const std::vector<PetscInt>& rows, core::IndexSet& is) {
    check(ISCreateGeneral(system.comm(), static_cast<PetscInt>(rows.size()), rows.data(), PETSC_COPY_VALUES, is.put()));
  };
  const std::vector<problem::Field> fields = problem::parts_of(system.fields());
  for (std::size_t f = 1; f < fields.size(); ++f) {
    auto part = std::make_unique<Coupled>();
    std::vector<PetscInt> rows;
    for (PetscInt i = fields[f].begin; i < fields[f].end; ++i) {
      rows.push_back(begin + i);
      taken[static_cast<std::size_t>(i)] = true;
    }
    part->first = fields[f].begin;
    part->count = fields[f].end - fields[f].begin;
    set(rows, part->rows);
    parts_.push_back(std::move(part));
    ports_.push_back({fields[f].name, {}, {}});
  }
  std::vector<PetscInt> rows;
  for (std::size_t i = 0; i < taken.size(); ++i)
    if (!taken[i]) rows.push_back(begin + static_cast<PetscInt>(i));
  set(rows, hub_rows_);
  PetscInt largest = 0;
  for (std::size_t i = 0; i < parts_.size(); ++i) largest = std::max(largest, states(i));
  if (auto inverse = system.make_part_inverse(); inverse && inverse->exact() != nullptr) {
    inverse_ = std::move(inverse);
  } else if (inverse && largest > core::plan::kept_states()) {
    iterated_ = std::make_unique<FrequencyInverse>(system, std::move(inverse));
  }
  core::IndexSet all;
  check(ISAllGather(hub_rows_.get(), all.put()));
  check(ISGetSize(all.get(), &hub_));
  const PetscInt* numbers = nullptr;
  check(ISGetIndices(all.get(), &numbers));
  hub_numbers_.assign(numbers, numbers + hub_);
  check(ISRestoreIndices(all.get(), &numbers));
}

TransferFunction::~TransferFunction() = default;

PetscInt TransferFunction::states(std::size_t i) const {
  PetscInt n = 0;
  check(ISGetSize(parts_[i]->rows.get(), &n));
  return n;
}

template <class F>
MatrixXcd TransferFunction::together(F&& columns) const {
  Index rows = 0, most = 0;
  std::vector<MatrixXcd> each;
  for (const auto& p : parts_) {
    each.push_back(columns(*p));
    rows += each.back().rows();
    most = std::max(most, each.back().cols());
  }
  MatrixXcd all = MatrixXcd::Zero(rows, most);
  Index row = 0;
  for (const MatrixXcd& m : each) {
    all.block(row, 0, m.rows(), m.cols()) = m;
    row += m.rows();
  }
  return all;
}

void TransferFunction::solve_together(const MatrixXcd& right, MatrixXcd Coupled::*to) {
  MatrixXcd x(right.rows(), right.cols());
  if (iterated_)
    iterated_->apply_at(right.data(), x.data(), right.rows(), static_cast<int>(right.cols()));
  else
    inverse_->exact()->apply_at(core::span_of(right), core::span_of(x));
  bool finite = x.allFinite();
  Index row = 0;
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    Coupled& p = *parts_[i];
    p.*to = x.block(row, 0, p.count, static_cast<Index>(ports_[i].seen.size()));
    row += p.count;
  }
  MPI_Allreduce(MPI_IN_PLACE, &finite, 1, MPI_CXX_BOOL, MPI_LAND, comm());
  if (!finite) throw core::NotConverged("the equations of a film are singular at this frequency");
}

void TransferFunction::factorise(Coupled& p, Complex lambda, PetscInt columns) const {
  if (!p.real) p.real = make_real_form(p.a.get());
  if (!p.right)
    for (core::Matrix* m : {&p.right, &p.answers})
      check(MatCreateDense(comm(), 2 * p.count, PETSC_DECIDE, PETSC_DETERMINE, columns, nullptr, m->put()));
  put_pencil(p.a.get(), p.b.get(), lambda, p.real.get(), [](PetscInt, RealRow&) {});
  check(MatAssemblyBegin(p.real.get(), MAT_FINAL_ASSEMBLY));
  check(MatAssemblyEnd(p.real.get(), MAT_FINAL_ASSEMBLY));
  if (!p.solver) p.solver = core::make_direct_solver(comm(), "parts_");
  check(KSPSetOperators(p.solver.get(), p.real.get(), p.real.get()));
}

// X = A^-1 G, X' = A^-1 (G' - A' X), H = F X, H' = F' X + F X'.
TransferFunction::Transfers TransferFunction::evaluate(Complex lambda, bool slopes) {
  const auto right = [lambda](const Coupled& p) -> MatrixXcd { return p.g0 + lambda * p.g1; };
  const auto change = [](const Coupled& p) -> MatrixXcd { return p.g1 - p.rates_times(p.x); };
  const auto solve_all = [&] {
    if (iterated_)
      iterated_->set_at(x_.get(), rest_.get(), lambda);
    else
      inverse_->exact()->set_at({0, x_.get(), rest_.get()}, lambda);
    solve_together(together(right), &Coupled::x);
    if (!slopes) return;
    if (iterated_) {
      const MatrixXcd g1 = together([](const Coupled& p) -> MatrixXcd { return p.g1.cast<Complex>(); });
      const MatrixXcd x = together([](const Coupled& p) -> MatrixXcd { return p.x; });
      solve_together(g1 - iterated_->rates_times(x), &Coupled::dx);
      return;
    }
    assemble();  // whose rates these take
    solve_together(together(change), &Coupled::dx);
  };
  try {
    if (eliminates_by_inverse()) solve_all();
  } catch (const core::NotConverged&) {
    if (!iterated_ || system_.size() > core::plan::whole_states()) throw;
    iterated_.reset();
  }
  if (!eliminates_by_inverse()) assemble();
  Transfers out;
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    Coupled& p = *parts_[i];
    const auto columns = static_cast<PetscInt>(ports_[i].seen.size());
    const auto forces = static_cast<Index>(ports_[i].forces.size());
    if (!eliminates_by_inverse()) {
      factorise(p, lambda, columns);
      p.solve(right(p), p.x);
      if (slopes) p.solve(change(p), p.dx);
    }
    const MatrixXcd f = (p.f0 + lambda * p.f1).transpose();
    Block block{f * p.x, {}};
    if (slopes)
      block.slope = p.f1.transpose().cast<Complex>() * p.x + f * p.dx;
    else
      p.dx.resize(0, 0);
    for (MatrixXcd* m : {&block.value, &block.slope})
      if (m->size() > 0)
        MPI_Allreduce(MPI_IN_PLACE, m->data(), static_cast<int>(forces * columns), MPI_C_DOUBLE_COMPLEX, MPI_SUM,
                      comm());
    out.push_back(std::move(block));
    if (states(i) > core::plan::kept_states()) {
      p.solver.reset();
      p.real.reset();
      p.right.reset();
      p.answers.reset();
    }
  }
  return out;
}

TransferFunction::Sparse TransferFunction::matrix(Complex lambda, const Transfers& parts, bool slope) const {
  std::vector<Eigen::Triplet<Complex>> entries;
  const auto add = [&](const Eigen::SparseMatrix<double>& m, Complex factor) {
    for (int c = 0; c < m.outerSize(); ++c)
      for (Eigen::SparseMatrix<double>::InnerIterator e(m, c); e; ++e)
        entries.emplace_back(static_cast<int>(e.row()), c, factor * e.value());
  };
  // Both in either case, so that the pattern is always the same.
  add(a_hub_, slope ? 0.0 : 1.0);
  add(b_hub_, slope ? 1.0 : lambda);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const MatrixXcd& h = slope ? parts[i].slope : parts[i].value;
    for (Index c = 0; c < h.cols(); ++c)
      for (Index r = 0; r < h.rows(); ++r)
        entries.emplace_back(static_cast<int>(ports_[i].forces[static_cast<std::size_t>(r)]),
                             static_cast<int>(ports_[i].seen[static_cast<std::size_t>(c)]), -h(r, c));
  }
  Sparse out(hub_, hub_);
  out.setFromTriplets(entries.begin(), entries.end());
  return out;
}

double TransferFunction::magnitude(Complex lambda, const Transfers& parts) const {
  double h = 0;
  for (const Block& b : parts) h += b.value.squaredNorm();
  return a_hub_.norm() + std::abs(lambda) * b_hub_.norm() + std::sqrt(h);
}

// The part adds -H to the hub's derivatives.
MatrixXcd TransferFunction::from_motion(std::size_t i, const Block& part, Complex lambda,
                                        const std::vector<PetscInt>& positions, const std::vector<PetscInt>& rates,
                                        const std::vector<PetscInt>& forces) const {
  const auto at = [](const std::vector<PetscInt>& all, PetscInt one) {
    const auto place = std::lower_bound(all.begin(), all.end(), one);
    return place != all.end() && *place == one ? place - all.begin() : -1;
  };
  MatrixXcd out = MatrixXcd::Zero(static_cast<Index>(forces.size()), static_cast<Index>(positions.size()));
  for (std::size_t r = 0; r < forces.size(); ++r)
    for (std::size_t c = 0; c < positions.size(); ++c)
      for (const bool rate : {false, true}) {
        const PetscInt state = rate ? rates[c] : positions[c];
        const Index row = at(ports_[i].forces, forces[r]), column = at(ports_[i].seen, state);
        if (row < 0 || column < 0) continue;
        const double si =
            hub_row_scale_[static_cast<std::size_t>(forces[r])] / hub_scale_[static_cast<std::size_t>(state)];
        out(static_cast<Index>(r), static_cast<Index>(c)) -=
            part.value(row, column) * si * (rate ? lambda : Complex(1));
      }
  return out;
}

std::vector<Complex> TransferFunction::whole(const std::vector<Complex>& local) const {
  std::vector<double> all[2];
  for (const bool real : {true, false}) {
    const core::Vector v = core::duplicate(rest_.get());
    {
      const core::WriteArray a(v.get());
      for (std::size_t i = 0; i < local.size(); ++i)
        a[static_cast<PetscInt>(i)] = real ? local[i].real() : local[i].imag();
    }
    all[real ? 0 : 1] = core::gather(v.get());
  }
  std::vector<Complex> out(all[0].size());
  for (std::size_t k = 0; k < out.size(); ++k) out[k] = {all[0][k], all[1][k]};
  return out;
}

std::vector<Complex> TransferFunction::state(const VectorXcd& z, Complex ahead) const {
  std::vector<Complex> mine(static_cast<std::size_t>(system_.local_size()));
  PetscInt begin = 0, end = 0;
  check(VecGetOwnershipRange(rest_.get(), &begin, &end));
  for (std::size_t k = 0; k < hub_numbers_.size(); ++k)
    if (const PetscInt i = hub_numbers_[k]; i >= begin && i < end)
      mine[static_cast<std::size_t>(i - begin)] = z(static_cast<Index>(k));
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    const Coupled& part = *parts_[p];
    VectorXcd seen(static_cast<Index>(ports_[p].seen.size()));
    for (Index k = 0; k < seen.size(); ++k) seen(k) = z(ports_[p].seen[static_cast<std::size_t>(k)]);
    VectorXcd x = part.x * seen;
    if (part.dx.size() > 0) x += ahead * (part.dx * seen);
    for (PetscInt i = 0; i < part.count; ++i) mine[static_cast<std::size_t>(part.first + i)] = -x(i);
  }
  return whole(mine);
}

std::vector<Complex> TransferFunction::state(std::size_t i, const std::vector<Complex>& shape) const {
  std::vector<Complex> mine(static_cast<std::size_t>(system_.local_size()));
  std::copy(shape.begin(), shape.end(), mine.begin() + parts_[i]->first);
  return whole(mine);
}

std::vector<TransferFunction::Pole> TransferFunction::poles(std::size_t i, double target, double radius) const {
  assemble();
  const Coupled& p = *parts_[i];
  std::vector<Pole> out;
  for (const spectral::LocalMode& m : spectral::modes_within(p.a.get(), p.b.get(), target, radius)) {
    const Eigen::Map<const VectorXcd> v(m.shape.data(), static_cast<Index>(m.shape.size()));
    const MatrixXcd f = p.f0 + m.lambda * p.f1;
    VectorXcd force = f.transpose() * v;
    std::vector<double> sizes{f.squaredNorm(), v.squaredNorm()};
    MPI_Allreduce(MPI_IN_PLACE, force.data(), static_cast<int>(force.size()), MPI_C_DOUBLE_COMPLEX, MPI_SUM, comm());
    MPI_Allreduce(MPI_IN_PLACE, sizes.data(), 2, MPI_DOUBLE, MPI_SUM, comm());
    Pole pole{m.lambda, force.norm() <= 1e-12 * std::sqrt(sizes[0] * sizes[1]), {}};
    if (pole.silent) pole.shape = m.shape;
    out.push_back(std::move(pole));
  }
  return out;
}

}  // namespace whirl::solve
