#include "film_part.hpp"

#include <algorithm>
#include <utility>

#include "whirl/core/entry_stream.hpp"
#include "whirl/core/error.hpp"

namespace whirl::system {

using core::check;

FilmPart::FilmPart(const Support& support, PetscInt first)
    : FilmPart(film::make_film(support.geometry, support.film, support.lubricant), first) {}

FilmPart::FilmPart(std::unique_ptr<film::Film> film, PetscInt first)
    : film_(std::move(film)), first_(first), count_(static_cast<PetscInt>(film_->states())) {}

std::unique_ptr<FilmPart> FilmPart::with(const Support& support) const {
  auto out = std::make_unique<FilmPart>(support, first_);
  core::require(out->count_ == count_, "a film on the same mesh");
  out->film_->start_from(*film_);
  out->row_ = row_;
  out->gathered_ = gathered_;
  out->here_ = here_;
  out->ports_ = ports_;
  out->begin_ = begin_;
  if (rows() > 0) out->share_ = out->film_->share(share_.begin, share_.end);
  // Solvers learn once which derivatives a film has.
  if (out->film_->constant_rates() != film_->constant_rates())
    throw core::DomainError("the damping of a liner can not come or go along a branch");
  return out;
}

void FilmPart::join(std::vector<PortEnds> ports, PetscInt coordinates) {
  ports_ = std::move(ports);
  begin_ = 2 * coordinates + first_;
}

PetscInt FilmPart::cut(PetscInt wanted) const {
  return first_ + film_->cut(static_cast<int>(wanted - first_));
}

void FilmPart::hold(PetscInt begin, PetscInt end, PetscInt row, std::size_t gathered, bool without_states) {
  const PetscInt from = std::max(first_, begin), to = std::min(this->end(), end);
  share_ = from < to ? film_->share(static_cast<int>(from - first_), static_cast<int>(to - first_)) : film::Share{};
  row_ = row + std::clamp<PetscInt>(first_ - begin, 0, end - begin);
  gathered_ = gathered;
  here_ = count_ > 0 ? rows() > 0 : without_states;
  asked_.reset();
}

void FilmPart::evaluate(const film::JournalMotion& motion, std::span<const double> own, std::span<const double> rates,
                        film::Need need) {
  const std::size_t n = share_.seen.size();
  const std::span<const double> s = own.subspan(gathered_, n), moving = rates.subspan(gathered_, n);
  if (asked_ && (asked_->need == need || need == film::Need::force) && asked_->motion == motion &&
      std::equal(s.begin(), s.end(), asked_->own.begin()) &&
      std::equal(moving.begin(), moving.end(), asked_->rates.begin()))
    return;
  std::optional<Asked> now = std::exchange(asked_, std::nullopt);
  film_->evaluate(motion, share_, s, moving, need, response_);
  if (n == 0) return;
  if (!now) now.emplace();
  now->motion = motion;
  now->own.assign(s.begin(), s.end());
  now->rates.assign(moving.begin(), moving.end());
  now->need = need;
  asked_ = std::move(now);
}

void FilmPart::evaluate(const film::JournalMotion& motion, const double* own, const double* rates, film::Need need,
                        film::StateResponse& response) const {
  const auto n = static_cast<std::size_t>(count_);
  film_->evaluate(motion, {own + first_, n}, {rates + first_, n}, need, response);
}

std::vector<double> FilmPart::unloaded(const film::JournalMotion& motion) const {
  std::vector<double> states(static_cast<std::size_t>(count_));
  film_->unloaded(motion, states);
  return states;
}

std::vector<double> FilmPart::relaxed(const film::JournalMotion& motion) const {
  std::vector<double> states = unloaded(motion);
  film::relax(*film_, motion, states);
  return states;
}

problem::Field FilmPart::field(const film::StateField& f) const {
  problem::Field out{.quantity = f.name, .unit = f.unit, .scale = f.scale};
  const auto row = [&](int state) { return row_ + std::clamp(state, share_.begin, share_.end) - share_.begin; };
  if (f.repeats == 1) {
    out.begin = row(f.begin);
    out.end = row(f.end);
    return out;
  }
  const auto runs_before = [&](int state) {
    return std::clamp((state - f.begin + f.stride - 1) / f.stride, 0, f.repeats);
  };
  const int first = runs_before(share_.begin), last = runs_before(share_.end);
  out.stride = f.stride;
  out.repeats = last - first;
  out.begin = row(f.begin + first * f.stride);
  out.end = out.begin + (last > first ? f.end - f.begin : 0);
  return out;
}

std::vector<problem::Field> FilmPart::fields(const std::string& name) const {
  std::vector<problem::Field> out;
  for (const film::StateField& f : film_->state_fields()) {
    out.push_back(field(f));
    out.back().name = name;
  }
  return out;
}

void FilmPart::scales(double* states, double* rows) const {
  for (const film::StateField& f : film_->state_fields())
    field(f).each([&](PetscInt i) {
      states[i - row_] = f.scale;
      rows[i - row_] = f.row_scale();
    });
}

void FilmPart::residual(const Instant& /*at*/, double* f) const {
  if (rows() > 0) std::copy(response_.residual.begin(), response_.residual.end(), f);
}

void FilmPart::speed_derivative(const Instant& /*at*/, double* f) const {
  if (rows() > 0) std::copy(response_.d_speed.begin(), response_.d_speed.end(), f);
}

template <class Entries>
void FilmPart::add(Entries& j, bool values, double alpha, double sigma) const {
  if (rows() == 0) return;
  const PetscInt begin = begin_ + share_.begin;
  const auto matrix = [&](const film::Places& places, const std::vector<double>& of, double factor) {
    film::for_entries(share_, places, values ? std::span<const double>(of) : std::span<const double>(),
                      [&](int row, int column, double value) { j.add(begin + row, begin_ + column, factor * value); });
  };
  matrix(share_.d_states, response_.d_states, alpha);
  matrix(share_.d_rates, response_.d_rates, sigma);
  const Eigen::Index count = rows(), n = std::ssize(ports_);
  for (Eigen::Index port = 0; port < n; ++port)
    for (const auto& [q, side] : ports_[static_cast<std::size_t>(port)])
      for (Eigen::Index k = 0; k < count; ++k) {
        const auto row = begin + static_cast<PetscInt>(k);
        const auto by = [&, side = side](Eigen::Index input) {
          return values ? alpha * side * response_.inputs(input, k) : 0.0;
        };
        double of_force = values ? -side * alpha * response_.forces(port, k) : 0.0;
        if (values && response_.force_rates.rows() > 0) of_force -= side * sigma * response_.force_rates(port, k);
        j.add(row, 2 * q, by(port));
        j.add(row, 2 * q + 1, by(n + port));
        j.add(2 * q, row, of_force);
      }
}

template void FilmPart::add(core::EntryStream& j, bool values, double alpha, double sigma) const;
template void FilmPart::add(problem::Entries& j, bool values, double alpha, double sigma) const;

}  // namespace whirl::system
