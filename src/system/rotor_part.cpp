#include "rotor_part.hpp"

#include <algorithm>
#include <cmath>

#include "whirl/core/error.hpp"
#include "whirl/film/film.hpp"
#include "whirl/rotor/shaft.hpp"

namespace whirl::system {

using core::check;

namespace {

// `m` of the rotor with a diagonal of zeros for the pedestals behind it; `local` rows on this rank.
core::Matrix with_pedestals(Mat m, PetscInt local, PetscInt n_rotor) {
  PetscInt begin = 0, end = 0;
  check(MatGetOwnershipRange(m, &begin, &end));
  std::vector<PetscInt> count(static_cast<std::size_t>(local), 1);
  for (PetscInt i = begin; i < end; ++i) {
    PetscInt k = 0;
    check(MatGetRow(m, i, &k, nullptr, nullptr));
    count[static_cast<std::size_t>(i - begin)] = k;
    check(MatRestoreRow(m, i, &k, nullptr, nullptr));
  }
  core::Matrix out = core::make_matrix(PetscObjectComm(reinterpret_cast<PetscObject>(m)), local, std::move(count));
  for (PetscInt i = begin; i < end; ++i) {
    PetscInt k = 0;
    const PetscInt* columns = nullptr;
    const PetscScalar* values = nullptr;
    check(MatGetRow(m, i, &k, &columns, &values));
    check(MatSetValues(out.get(), 1, &i, k, columns, values, INSERT_VALUES));
    check(MatRestoreRow(m, i, &k, &columns, &values));
  }
  for (PetscInt i = std::max(end, n_rotor); i < begin + local; ++i)
    check(MatSetValue(out.get(), i, i, 0.0, INSERT_VALUES));
  check(MatAssemblyBegin(out.get(), MAT_FINAL_ASSEMBLY));
  check(MatAssemblyEnd(out.get(), MAT_FINAL_ASSEMBLY));
  return out;
}

// All of `m` on the first rank.
core::Matrix on_first(Mat m) {
  MPI_Comm comm = PetscObjectComm(reinterpret_cast<PetscObject>(m));
  PetscInt n = 0;
  check(MatGetSize(m, &n, nullptr));
  core::IndexSet all;
  check(ISCreateStride(comm, core::rank_of(comm) == 0 ? n : 0, 0, 1, all.put()));
  core::Matrix out;
  check(MatCreateSubMatrix(m, all.get(), all.get(), MAT_INITIAL_MATRIX, out.put()));
  return out;
}

}  // namespace

RotorPart::RotorPart(MPI_Comm comm, const Train& train, bool on_first)
    : comm_(comm), train_(train), on_first_(on_first), rotor_(make_rotor(train.rotor)) {
  n_ = n_rotor_ = rotor_->size();
  for (const Support& s : train_.supports) {
    std::array<PetscInt, 2>& rows = pedestals_.emplace_back(std::array<PetscInt, 2>{-1, -1});
    if (!s.has_pedestal) continue;
    for (PetscInt& row : rows) row = n_++;
  }
  PetscInt begin = 0, end = 0;
  check(MatGetOwnershipRange(rotor_->matrices().mass.get(), &begin, &end));
  const int rank = core::rank_of(comm_);
  if (on_first_) {
    begin = rank == 0 ? 0 : n_rotor_;
    end = n_rotor_;
  }
  const int with_pedestals_on = on_first_ ? 0 : core::size_of(comm_) - 1;
  begin_ = rank > with_pedestals_on ? n_ : begin;
  end_ = rank >= with_pedestals_on ? n_ : end;
  make_matrices();
  load_ = load_of(*rotor_, weights_of(train_));
  unbalance_ = unbalance_of(*rotor_, train_.unbalance);
}

std::unique_ptr<rotor::Rotor> RotorPart::make_rotor(const rotor::Options& options) {
  ++made_;
  return std::make_unique<rotor::Rotor>(comm_, options);
}

void RotorPart::check_pattern(const rotor::Rotor& rotor) const {
  if (rotor.matrices().circulatory && !matrices_.circulatory)
    throw core::InputError("'rotor.internal_damping' varies from a positive value on, not from none");
}

void RotorPart::take(const Change& change, std::unique_ptr<rotor::Rotor> rotor) {
  if (rotor)
    rotor_ = std::move(rotor);
  else if (change.damping)
    rotor_->set_stiffness_damping(train_.rotor.stiffness_damping);
  if (change.shaft || change.damping)
    make_matrices();
  else if (change.pedestals)
    set_pedestals();
  if (change.load) load_ = load_of(*rotor_, weights_of(train_));
  if (change.unbalance) unbalance_ = unbalance_of(*rotor_, train_.unbalance);
}

RotorPart::Matrices RotorPart::matrices_of(const rotor::Rotor& rotor) const {
  const rotor::Matrices& m = rotor.matrices();
  const auto made = [&](Mat from) {
    const core::Matrix moved = on_first_ ? on_first(from) : core::Matrix();
    return with_pedestals(moved ? moved.get() : from, end_ - begin_, n_rotor_);
  };
  return {made(m.mass.get()), made(m.damping.get()), made(m.gyroscopic.get()), made(m.stiffness.get()),
          m.circulatory ? made(m.circulatory.get()) : core::Matrix()};
}

void RotorPart::make_matrices() {
  matrices_ = matrices_of(*rotor_);
  set_pedestals();
}

namespace {

// Calls put(row, mass, damping, stiffness) for the pedestals whose rows are in [begin, end): they stand on diagonals.
template <class Put>
void for_pedestals(const Train& train, const std::vector<std::array<PetscInt, 2>>& rows, PetscInt begin, PetscInt end,
                   const Put& put) {
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (std::size_t d = 0; d < 2; ++d) {
      const Support& s = train.supports[i];
      if (const PetscInt row = rows[i][d]; row >= begin && row < end) put(row, s.mass[d], s.damping[d], s.stiffness[d]);
    }
}

void assemble(std::initializer_list<Mat> all) {
  for (Mat m : all) {
    check(MatAssemblyBegin(m, MAT_FINAL_ASSEMBLY));
    check(MatAssemblyEnd(m, MAT_FINAL_ASSEMBLY));
  }
}

}  // namespace

void RotorPart::set_pedestals() {
  Mat m = matrices_.mass.get(), c = matrices_.damping.get(), k = matrices_.stiffness.get();
  for_pedestals(train_, pedestals_, begin_, end_, [&](PetscInt row, double mass, double damping, double stiffness) {
    check(MatSetValue(m, row, row, mass, INSERT_VALUES));
    check(MatSetValue(c, row, row, damping, INSERT_VALUES));
    check(MatSetValue(k, row, row, stiffness, INSERT_VALUES));
  });
  assemble({m, c, k});
}

void RotorPart::set_pedestals(Mat at_rest, Mat rates) const {
  for_pedestals(train_, pedestals_, begin_, end_, [&](PetscInt row, double mass, double damping, double stiffness) {
    check(MatSetValue(at_rest, 2 * row, 2 * row, stiffness, INSERT_VALUES));
    check(MatSetValue(at_rest, 2 * row, 2 * row + 1, damping, INSERT_VALUES));
    check(MatSetValue(rates, 2 * row, 2 * row + 1, mass, INSERT_VALUES));
  });
  assemble({at_rest, rates});
}

RotorPart::Weights RotorPart::weights_of(const Train& train) {
  Weights w{train.gravity, train.rotor.type == rotor::Options::Type::rigid ? train.rotor.load : 0.0, {}};
  for (const Support& s : train.supports) w.pedestals.push_back(s.has_pedestal ? train.gravity * s.mass[1] : 0.0);
  return w;
}

std::vector<double> RotorPart::load_of(const rotor::Rotor& rotor, const Weights& weights) const {
  std::vector<double> load(static_cast<std::size_t>(end_ - begin_), 0.0);
  const std::vector<double> g = core::gather(rotor.matrices().gravity.get());
  for (PetscInt i = begin_; i < std::min(end_, n_rotor_); ++i)
    load[static_cast<std::size_t>(i - begin_)] = weights.gravity * g[static_cast<std::size_t>(i)];
  const auto take = [&](PetscInt row, double weight) {
    if (weight != 0 && owns(row)) load[static_cast<std::size_t>(row - begin_)] -= weight;
  };
  take(rotor.coordinate(1, rotor::Freedom::y), weights.rotor_load);
  for (std::size_t i = 0; i < pedestals_.size(); ++i) take(pedestals_[i][1], weights.pedestals[i]);
  return load;
}

// U Omega^2 (cos, sin)(angle + phase) as cosine and sine parts, through T^T where the rotor is reduced.
RotorPart::Unbalances RotorPart::unbalance_of(const rotor::Rotor& rotor,
                                              const std::vector<UnbalanceMass>& masses) const {
  const rotor::Matrices& m = rotor.matrices();
  PetscInt rotor_here = 0;
  check(MatGetLocalSize(m.mass.get(), &rotor_here, nullptr));
  core::Vector full_c, full_s, c = core::make_vector(comm_, rotor_here, PETSC_DETERMINE), s = core::duplicate(c.get());
  const bool reduced = static_cast<bool>(m.basis);
  if (reduced) {
    check(MatCreateVecs(m.basis.get(), nullptr, full_c.put()));
    full_s = core::duplicate(full_c.get());
  }
  Vec tc = reduced ? full_c.get() : c.get(), ts = reduced ? full_s.get() : s.get();
  check(VecSet(tc, 0.0));
  check(VecSet(ts, 0.0));
  if (core::rank_of(comm_) == 0)
    for (const UnbalanceMass& u : masses) {
      const rotor::Freedom freedom = u.couple ? rotor::Freedom::slope_x : rotor::Freedom::x;
      const PetscInt x = reduced ? rotor::full_coordinate(u.node, freedom) : rotor.coordinate(u.node, freedom),
                     y = x + 1;
      check(VecSetValue(tc, x, u.amount * std::cos(u.phase), ADD_VALUES));
      check(VecSetValue(ts, x, -u.amount * std::sin(u.phase), ADD_VALUES));
      check(VecSetValue(tc, y, u.amount * std::sin(u.phase), ADD_VALUES));
      check(VecSetValue(ts, y, u.amount * std::cos(u.phase), ADD_VALUES));
    }
  for (Vec v : {tc, ts}) {
    check(VecAssemblyBegin(v));
    check(VecAssemblyEnd(v));
  }
  if (reduced) {
    check(MatMultTranspose(m.basis.get(), tc, c.get()));
    check(MatMultTranspose(m.basis.get(), ts, s.get()));
  }
  Unbalances out{core::gather(c.get()), core::gather(s.get())};
  out.cosine.resize(static_cast<std::size_t>(n_), 0.0);
  out.sine.resize(static_cast<std::size_t>(n_), 0.0);
  return out;
}

std::vector<problem::Field> RotorPart::fields(const std::string& name) const {
  return {{name, 0, rows()}};
}

// Displacements are measured in clearances, rates in clearances times a typical whirl frequency, forces in parts of the
// weight.
void RotorPart::scales(double* s, double* r) const {
  double clearance = 0;
  int films = 0;
  for (const Support& support : train_.supports)
    if (support.geometry.clearance > 0) {
      clearance += support.geometry.clearance;
      ++films;
    }
  clearance = films > 0 ? clearance / films : 1e-4;
  const double mass = rotor::total_mass(train_.rotor),
               force = std::max(mass * std::abs(train_.gravity) + std::abs(train_.rotor.load),
                                mass * clearance * film::typical_frequency * film::typical_frequency) /
                       std::max<double>(1.0, static_cast<double>(train_.supports.size()));
  for (PetscInt i = 0; i < end_ - begin_; ++i) {
    const PetscInt g = begin_ + i;
    double length = clearance, load = force;
    if (g < n_rotor_) {
      const std::optional<rotor::Freedom> freedom = rotor_->freedom(g);
      if (!freedom && rotor_->reduced()) {  // mass-normalised modes
        length = clearance * std::sqrt(mass);
        load = force / std::sqrt(mass);
      } else if (!freedom || rotor::is_slope(*freedom)) {  // inner freedoms of elements are angles or curvatures
        load = force * 0.1;                                // clearance per metre, moments on a lever of 0.1 m
      }
    }
    s[2 * i] = length;
    s[2 * i + 1] = length * film::typical_frequency;
    r[2 * i + 1] = length * film::typical_frequency;
    r[2 * i] = load;
  }
}

// The centre of unbalance moves along (cos, sin)(angle): its acceleration has a part towards the axis and one along the
// turn.
std::array<double, 2> RotorPart::unbalance_factors(const Moment& at) {
  if (!at.forcing) return {};
  const double c = std::cos(at.angle), s = std::sin(at.angle), inward = at.speed * at.speed;
  return {inward * c + at.acceleration * s, inward * s - at.acceleration * c};
}

core::Vector RotorPart::products(const Matrices& m, const Moment& at) const {
  // q, v and their rates as vectors of coordinates.
  core::Vector q = core::make_vector(comm_, end_ - begin_, n_), v = core::duplicate(q.get()),
               a = core::duplicate(q.get()), sum = core::duplicate(q.get());
  {
    const core::ReadArray xa(at.x), da(at.xdot);
    const core::WriteArray qa(q.get()), va(v.get()), aa(a.get());
    for (PetscInt i = 0; i < qa.size(); ++i) {
      qa[i] = xa[2 * i];
      va[i] = xa[2 * i + 1];
      aa[i] = da[2 * i + 1];
    }
  }
  check(MatMult(m.stiffness.get(), q.get(), sum.get()));
  check(MatMultAdd(m.damping.get(), v.get(), sum.get(), sum.get()));
  check(MatMultAdd(m.mass.get(), a.get(), sum.get(), sum.get()));
  check(MatMult(m.gyroscopic.get(), v.get(), a.get()));
  if (m.circulatory) check(MatMultAdd(m.circulatory.get(), q.get(), a.get(), a.get()));
  check(VecAXPY(sum.get(), at.speed, a.get()));
  return sum;
}

void RotorPart::residual(const Moment& at, double* f) const {
  const core::Vector sum = products(matrices_, at);
  const core::ReadArray xa(at.x), da(at.xdot), sa(sum.get());
  const auto [c, s] = unbalance_factors(at);
  for (PetscInt i = 0; i < sa.size(); ++i) {
    const auto g = static_cast<std::size_t>(begin_ + i);
    f[2 * i + 1] = da[2 * i] - xa[2 * i + 1];
    f[2 * i] = sa[i] - load_[static_cast<std::size_t>(i)] - c * unbalance_.cosine[g] - s * unbalance_.sine[g];
  }
}

void RotorPart::speed_derivative(const Moment& at, double* f) const {
  core::Vector v = core::make_vector(comm_, end_ - begin_, n_), sum = core::duplicate(v.get());
  {
    const core::ReadArray xa(at.x);
    const core::WriteArray va(v.get());
    for (PetscInt i = 0; i < va.size(); ++i) va[i] = xa[2 * i + 1];
  }
  check(MatMult(matrices_.gyroscopic.get(), v.get(), sum.get()));
  if (matrices_.circulatory) {
    const core::Vector q = core::duplicate(v.get());
    {
      const core::ReadArray xa(at.x);
      const core::WriteArray qa(q.get());
      for (PetscInt i = 0; i < qa.size(); ++i) qa[i] = xa[2 * i];
    }
    check(MatMultAdd(matrices_.circulatory.get(), q.get(), sum.get(), sum.get()));
  }
  const core::ReadArray sa(sum.get());
  const double force = at.forcing ? 2 * at.speed : 0.0, c = force * std::cos(at.angle), s = force * std::sin(at.angle);
  for (PetscInt i = 0; i < sa.size(); ++i) {
    const auto g = static_cast<std::size_t>(begin_ + i);
    f[2 * i + 1] = 0;
    f[2 * i] = sa[i] - c * unbalance_.cosine[g] - s * unbalance_.sine[g];
  }
}

void RotorPart::count_entries(std::span<PetscInt> count) const {
  for (PetscInt i = 0; i < end_ - begin_; ++i) {
    PetscInt total = 12;
    for (const core::Matrix* m :
         {&matrices_.mass, &matrices_.damping, &matrices_.stiffness, &matrices_.gyroscopic, &matrices_.circulatory}) {
      if (!*m) continue;
      PetscInt k = 0;
      check(MatGetRow(m->get(), begin_ + i, &k, nullptr, nullptr));
      total += 2 * k;
      check(MatRestoreRow(m->get(), begin_ + i, &k, nullptr, nullptr));
    }
    count[static_cast<std::size_t>(2 * i)] += total;
    count[static_cast<std::size_t>(2 * i + 1)] += 2;
  }
}

void RotorPart::add(Mat j, double at_rest, double gyroscopic, double rates) const {
  std::vector<PetscInt> columns_to;
  std::vector<PetscScalar> scaled;
  const auto add = [&](Mat m, PetscInt rate, double factor) {
    for (PetscInt i = begin_; i < end_; ++i) {
      PetscInt k = 0;
      const PetscInt* columns = nullptr;
      const PetscScalar* values = nullptr;
      check(MatGetRow(m, i, &k, &columns, &values));
      columns_to.assign(columns, columns + k);
      scaled.assign(values, values + k);
      for (PetscInt e = 0; e < k; ++e) {
        columns_to[static_cast<std::size_t>(e)] = 2 * columns_to[static_cast<std::size_t>(e)] + rate;
        scaled[static_cast<std::size_t>(e)] *= factor;
      }
      const PetscInt row = 2 * i;
      check(MatSetValues(j, 1, &row, k, columns_to.data(), scaled.data(), ADD_VALUES));
      check(MatRestoreRow(m, i, &k, &columns, &values));
    }
  };
  add(matrices_.stiffness.get(), 0, at_rest);
  add(matrices_.damping.get(), 1, at_rest);
  add(matrices_.gyroscopic.get(), 1, gyroscopic);
  if (matrices_.circulatory) add(matrices_.circulatory.get(), 0, gyroscopic);
  add(matrices_.mass.get(), 1, rates);
  if (loss_ != std::array<double, 2>{}) add_loss(j, at_rest);
  for (PetscInt i = begin_; i < end_; ++i) {
    check(MatSetValue(j, 2 * i + 1, 2 * i, rates, ADD_VALUES));
    check(MatSetValue(j, 2 * i + 1, 2 * i + 1, -at_rest, ADD_VALUES));
  }
}

// Of the rotor alone: pedestals behind it have no loss.
void RotorPart::add_loss(Mat j, double at_rest) const {
  for (PetscInt i = begin_; i < std::min(end_, n_rotor_); ++i) {
    PetscInt n = 0;
    const PetscInt* columns = nullptr;
    const PetscScalar* values = nullptr;
    check(MatGetRow(matrices_.stiffness.get(), i, &n, &columns, &values));
    for (PetscInt e = 0; e < n; ++e) {
      const double k = at_rest * values[e];
      check(MatSetValue(j, 2 * i, 2 * columns[e] + 1, loss_[0] * k, ADD_VALUES));
      // The other plane: +K y in rows of x, -K x in rows of y.
      check(MatSetValue(j, 2 * i, 2 * (columns[e] ^ 1), (i % 2 == 0 ? 1 : -1) * loss_[1] * k, ADD_VALUES));
    }
    check(MatRestoreRow(matrices_.stiffness.get(), i, &n, &columns, &values));
  }
}

}  // namespace whirl::system
