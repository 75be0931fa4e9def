#include <algorithm>
#include <map>

#include "blocks.hpp"
#include "change.hpp"
#include "film_part.hpp"
#include "rest.hpp"
#include "rotor_part.hpp"
#include "settling.hpp"
#include "slope.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/core/count.hpp"
#include "whirl/core/error.hpp"
#include "whirl/rotor/alignment.hpp"
#include "whirl/rotor/shaft.hpp"
#include "whirl/system/rotor_system.hpp"

// How a train becomes matrices and films: what is made once, and what is made anew where the train changes.

namespace whirl::system {

using core::check;

namespace {

// Bearings and elements that hold the shaft, one at a node: two bearings there hold it at the mean of their elevations.
std::vector<rotor::RigidSupport> rigid_supports(const Train& train) {
  std::map<int, std::pair<double, int>> at;  // node: sum of the elevations, count
  for (const Support& s : train.supports) {
    at[s.node].first += s.elevation;
    ++at[s.node].second;
  }
  for (const Element& e : train.elements)
    if (holds_shaft(e)) ++at[e.node].second;
  std::vector<rotor::RigidSupport> out;
  for (const auto& [node, sum] : at) out.push_back({node, sum.first / sum.second});
  return out;
}

}  // namespace

void RotorSystem::build() {
  bearings_.resize(train_.supports.size());
  core::agree(comm_, [&] {
    std::int64_t states = 0;  // refused before the memory for them is taken
    for (const Support& s : train_.supports) states += film::facts(s.film, s.geometry).states;
    (void)core::count_of(states, "own states of films");
    for (std::size_t i = 0; i < bearings_.size(); ++i) {
      bearings_[i].part = std::make_unique<FilmPart>(train_.supports[i], n_own_);
      n_own_ = bearings_[i].part->end();
      ++films_made_;
    }
  });
  hub_ = std::make_unique<RotorPart>(comm_, train_, first_holds_rotor());
  n_ = hub_->coordinates();
  for (std::size_t i = 0; i < bearings_.size(); ++i) {
    Bearing& b = bearings_[i];
    b.pedestal = hub_->pedestal(i);
    std::vector<PortEnds> ports;
    for (const film::Port port : b.part->film().ports()) {
      const auto freedom = static_cast<rotor::Freedom>(port);
      const auto d = static_cast<std::size_t>(freedom);
      b.journal[d] = rotor().coordinate(train_.supports[i].node, freedom);
      if (b.journal[d] < 0)
        throw core::InputError(rotor::is_slope(freedom)
                                   ? "a film tilts, but the slopes of its node are no coordinates of the rotor"
                                   : "a bearing's node is not a master node of the reduced rotor");
      ports.push_back({{b.journal[d], 1.0}});
      if (d < 2 && b.pedestal[d] >= 0) ports.back().emplace_back(b.pedestal[d], -1.0);
    }
    b.part->join(std::move(ports), n_);
  }
  axes_ = axes_of(train_);
  if (Rest::needed(train_)) rest_ = std::make_unique<Rest>(*this);
  share_out_own_states();

  // Which entries of the state the films see: positions and velocities at their ports, and own states.
  for (const Bearing& b : bearings_)
    for (const PortEnds& port : b.part->ports())
      for (const auto& [q, side] : port)
        for (PetscInt rate = 0; rate < 2; ++rate) wanted_.push_back(2 * q + rate);
  journal_inputs_ = wanted_.size();
  for (const Bearing& b : bearings_)
    for (const int k : b.part->share().seen) wanted_.push_back(2 * n_ + b.part->first() + k);
  core::Vector state = core::make_vector(comm_, local_size(), PETSC_DETERMINE);
  core::IndexSet from;
  check(ISCreateGeneral(PETSC_COMM_SELF, static_cast<PetscInt>(wanted_.size()), wanted_.data(), PETSC_COPY_VALUES,
                        from.put()));
  inputs_ = core::make_vector(PETSC_COMM_SELF, static_cast<PetscInt>(wanted_.size()), PETSC_DETERMINE);
  check(VecScatterCreate(state.get(), from.get(), inputs_.get(), nullptr, gather_inputs_.put()));
}

// What may refuse its values comes before anything changes.
void RotorSystem::set_train(Train train) {
  const TrainChange change = change_between(train_, train);
  std::unique_ptr<rotor::Rotor> rotor = change.shaft ? hub_->make_rotor(train.rotor) : nullptr;
  if (rotor) hub_->check_pattern(*rotor);
  std::vector<std::unique_ptr<FilmPart>> films = parts_at(train, change.films);
  if (change.axes) axes_ = axes_of(train);
  train_ = std::move(train);
  for (std::size_t k = 0; k < films.size(); ++k) bearings_[change.films[k]].part = std::move(films[k]);
  hub_->take(change, std::move(rotor));
  const bool matrices = change.shaft || change.damping;
  if (blocks_ && matrices) blocks_->rebuild();
  if (rest_) rest_->follow_train();
  slope_.reset();
}

void RotorSystem::prepare() {
  if (!hub_->follow(speed_)) return;
  if (lossy_) set_loss(loss_);
  if (blocks_) blocks_->rebuild();
}

void RotorSystem::prepare_loads(bool derivative) {
  prepare();
  if (!rest_) return;
  if (rest_->find()) hub_->set_rest(hub_->motions(rest_->hub().data()));
  if (derivative) hub_->set_rest_rate(hub_->motions(rest_->hub_rate().data()));
}

std::vector<std::unique_ptr<FilmPart>> RotorSystem::parts_at(const Train& train,
                                                             const std::vector<std::size_t>& bearings) {
  std::vector<std::unique_ptr<FilmPart>> out;
  core::agree(comm_, [&] {
    for (const std::size_t b : bearings) {
      out.push_back(bearings_[b].part->with(train.supports[b]));
      ++films_made_;
    }
  });
  return out;
}

// Bearings are bored in line with the shaft as it lies on them at rest, unless the deck says how they stand.
std::vector<std::array<double, 2>> RotorSystem::axes_of(const Train& train) const {
  std::vector<std::array<double, 2>> out(bearings_.size());
  std::vector<double> line, across(static_cast<std::size_t>(rotor::n_nodes(train.rotor)), 0.0);
  for (std::size_t i = 0; i < bearings_.size(); ++i) {
    if (!bearings_[i].tilts()) continue;
    const Support& support = train.supports[i];
    if (support.slope) {
      out[i] = *support.slope;
      continue;
    }
    if (line.empty()) {
      std::vector<rotor::RigidSupport> supports;
      supports = rigid_supports(train);
      line = rotor::rigid_static(comm_, train.rotor, supports, train.gravity).slope;
      for (rotor::RigidSupport& s : supports) s.elevation = 0;
      if (train.gravity_x != 0) across = rotor::rigid_static(comm_, train.rotor, supports, -train.gravity_x).slope;
    }
    const auto at = static_cast<std::size_t>(support.node - 1);
    out[i] = {across[at], line[at]};
  }
  return out;
}

// Own states stand behind all pairs, film by film, in near equal shares of all.
void RotorSystem::share_out_own_states() {
  const int rank = core::rank_of(comm_), size = core::size_of(comm_);
  const auto cut = [&](int r) -> PetscInt {
    const PetscInt wanted = core::begin_of_share(n_own_, r, size);
    for (const Bearing& b : bearings_)
      if (wanted < b.part->end()) return b.part->cut(wanted);
    return n_own_;
  };
  const PetscInt begin = cut(rank), end = cut(rank + 1);
  own_here_ = end - begin;
  std::size_t gathered = 0;
  for (std::size_t i = 0; i < bearings_.size(); ++i) {
    FilmPart& part = *bearings_[i].part;
    part.hold(begin, end, hub_->rows(), gathered, static_cast<int>(i) % size == rank);
    gathered += part.share().seen.size();
  }
}

}  // namespace whirl::system
