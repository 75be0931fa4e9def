// Points of a curve of bifurcations on other meshes of the films and of time, and the bars that follow.
//
// On another mesh the curve is another one. What separates the two is measured normal to the curve in the plane of the
// scaled parameters (p, q): the bifurcation there is solved for with (p, q) . t = (p_0, q_0) . t, t the direction of
// the curve at (p_0, q_0). That is regular wherever the curve itself is, also where it turns in one of the parameters
// and the move of the other one alone would have no bounds.

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <iterator>

#include "study/bars/summary_bars.hpp"
#include "study/locus/locus_follower.hpp"
#include "study/state_rows.hpp"
#include "whirl/core/error.hpp"
#include "whirl/deck/units.hpp"
#include "whirl/solve/newton/equilibrium.hpp"

namespace whirl::study {
namespace {

using core::check;

constexpr std::size_t fewest_bars = 3, most_bars = 10;  // of a curve
constexpr double approach = 2;  // from another mesh a point costs about twice as many iterations as the next one does
constexpr int most_secants = 10;
constexpr double farthest = 0.3;  // of the widths of the ranges, along the curve: what lies beyond is another point

// A member for the time of a scope.
class Borrowed {
public:
  explicit Borrowed(double& value) : value_(value), was_(value) {}
  ~Borrowed() { value_ = was_; }
  Borrowed(const Borrowed&) = delete;
  Borrowed& operator=(const Borrowed&) = delete;

private:
  double& value_;
  double was_;
};

// Of the curve through a point, towards increasing arclength as `row` measures it.
core::Vector tangent_at(const CurveProblem& there, Vec row) {
  there.problem->linearise(there.whole.get(), row);
  core::Vector rhs = core::duplicate(there.whole.get()), t = core::duplicate(there.whole.get());
  solve::parameter_row(*there.problem, rhs.get());
  (void)solve::solve_linear(*there.problem, rhs.get(), t.get(), "tangent_");
  return t;
}

}  // namespace

MeshLaw LocusFollower::law() const {
  MeshLaw law = law_of(context_.machine, context_.layout);
  if (curve_.cycles) {
    const solve::CycleOptions& o = curve_.cycles->options();
    law.time_order = order_in_time(context_.machine, 2 * o.degree - (o.points == solve::Points::radau ? 1 : 0));
  }
  return law;
}

std::vector<OtherMesh> LocusFollower::meshes() const {
  std::vector<OtherMesh> out;
  if (curve_.cycles) out = time_meshes(!merged(curve_.cycles->mesh()).empty(), context_.layout);
  if (system_->has_film_mesh())
    std::ranges::copy(film_meshes(context_.machine, context_.layout), std::back_inserter(out));
  return out;
}

CurvePoint LocusFollower::point_at(Vec whole) const {
  CurvePoint out;
  out.cycle = curve_.cycles ? curve_.cycle(whole)
                            : as_cycle(*system_, curve_.state(*system_, whole).get(),
                                       curve_.problem->first_parameter(whole) * first_scale_);
  out.inner = curve_.problem->inner(whole);
  out.second = solve::last_entry(curve_.problem->comm(), whole);
  return out;
}

// Without a mesh of time that coarse: nothing. The second parameter of this follower is left at that of the point.
std::optional<CurveProblem> LocusFollower::carried_to(const OtherMesh& mesh, const CurvePoint& given) {
  std::vector<double> times = given.cycle.mesh;
  if (mesh.axis == Axis::time)
    for (double left = 1 / mesh.spacing; left > 1; left /= 2) times = solve::doubled(times);
  if (mesh.axis == Axis::time && mesh.spacing > 1) times = merged(times);
  if (times.empty()) return {};
  second_value_ = given.second * second_scale_;
  auto system = make_system(given.cycle.parameter, mesh.factor);
  CurvePoint point = given;
  point.cycle = resampled(*system, *system_, std::move(point.cycle));
  std::complex<double> critical = 1;
  if (seed_.event == solve::Event::neimark_sacker)
    critical = std::polar(1.0, std::acos(std::clamp(given.inner(0), -1.0, 1.0)));
  // Beyond a fold there is no equilibrium at these parameters.
  if (seed_.event == solve::Event::hopf) {
    const core::Vector x = state_in(*system, point.cycle);
    (void)solve::find_equilibrium(*system, x.get(), continuation_.newton);
    point.cycle = as_cycle(*system, x.get(), given.cycle.parameter);
    critical = {0, given.inner(0)};
  }
  CurveProblem out = problem_at(point, critical, *system, mesh.factor, times);
  out.other = std::move(system);
  out.problem->prime(out.whole.get());
  return out;
}

// How far the curve on another mesh lies beside a point, normal to `along`, scaled.
std::vector<double> LocusFollower::beside_curve(const OtherMesh& mesh, const CurvePoint& point,
                                                const Eigen::Vector2d& along) {
  const Borrowed second(second_value_);
  return answer_of([&]() -> std::vector<double> {
    const auto there = carried_to(mesh, point);
    if (!there) return {};
    const Eigen::Vector2d here(point.cycle.parameter / first_scale_, point.second);
    core::Vector row = core::duplicate(there->whole.get());
    core::Vector part = there->problem->branch_part(row.get());
    check(VecSet(part.get(), 0.0));
    solve::set_last_entry(there->problem->comm(), part.get(), along(0));
    there->problem->join(part.get(), Eigen::VectorXd::Zero(point.inner.size()), along(1), row.get());
    if (!solve::newton(*there->problem, there->whole.get(), row.get(), along.dot(here), continuation_.newton).converged)
      return {};
    const Eigen::Vector2d moved = there->place(there->whole.get()) - here;
    return {along(0) * moved(1) - along(1) * moved(0)};
  });
}

// The place of a point of codimension two on a mesh, by the secant method on its test along the curve there.
std::vector<double> LocusFollower::zero_on(const OtherMesh& mesh, const CurvePoint& near, const std::string& type) {
  const Borrowed second(second_value_);
  return answer_of([&]() -> std::vector<double> {
    const auto there = carried_to(mesh, near);
    if (!there) return {};
    solve::AugmentedProblem& problem = *there->problem;
    core::Vector row = core::duplicate(there->whole.get());
    core::Vector t = solve::any_tangent(problem, there->whole.get());
    solve::weighted_row(problem, t.get(), row.get());
    double middle = 0;
    check(VecDot(row.get(), there->whole.get(), &middle));
    double s = 0, last_s = 0, last_value = 0;
    for (int k = 0; k < most_secants; ++k) {
      if (k > 0) check(VecAXPY(there->whole.get(), s - last_s, t.get()));
      if (!solve::newton(problem, there->whole.get(), row.get(), middle + s, continuation_.newton).converged) return {};
      t = tangent_at(*there, row.get());
      double value = unknown;
      if (type == meeting) value = solve::last_entry(problem.comm(), t.get());
      if (type == meeting_over_second) value = problem.first_parameter(t.get());
      for (const auto& test : problem.tests())
        if (type == test.name) value = test.value;
      const double next = k == 0 ? s + continuation_.max_step / 100 : s - value * (s - last_s) / (value - last_value);
      if (value == 0 || (k > 0 && std::abs(next - s) < continuation_.location_tolerance)) {
        if (value != 0) check(VecAXPY(there->whole.get(), next - s, t.get()));
        const Eigen::Vector2d found = there->place(there->whole.get());
        return {found(0), found(1)};
      }
      if (!(std::abs(next) < farthest)) return {};
      last_s = s;
      last_value = value;
      s = next;
    }
    return {};
  });
}

// Direction of the curve at a point of it, unit length, scaled.
std::vector<double> LocusFollower::direction_at(const CurvePoint& point) {
  const Borrowed second(second_value_);
  return answer_of([&]() -> std::vector<double> {
    const auto here = carried_to({}, point);
    const core::Vector t = solve::any_tangent(*here->problem, here->whole.get());
    const Eigen::Vector2d along = here->place(t.get()).normalized();
    return {along(0), along(1)};
  });
}

Bar LocusFollower::bar_beside(const std::string& name, const CurvePoint& point, const Eigen::Vector2d& along) {
  Bars bars({0.0}, law());
  for (const OtherMesh& mesh : meshes())
    bars.add(mesh.axis, mesh.spacing,
             pieces_->numbers(fmt::format("{} mesh {} {:.3f}", name, static_cast<int>(mesh.axis), mesh.spacing),
                              [&] { return beside_curve(mesh, point, along); }));
  Bar bar = bars[0];
  bar.location = tolerance_at({point.cycle.parameter / first_scale_, point.second});
  return bar;
}

// Newton's method leaves a residual, and no two solutions agree better.
double LocusFollower::tolerance_at(const Eigen::Vector2d& place) const {
  return continuation_.newton.tolerance * place.norm();
}

void LocusFollower::put_bars(io::CodimensionTwo& c, Vec whole, double location) {
  const CurvePoint point = point_at(whole);
  const std::string name = fmt::format("codimension two {}", context_.results.summary().codimension_two.size());
  const Eigen::Vector2d reported(point.cycle.parameter / first_scale_, point.second);
  Bar first, second;
  if (!law().estimated) {
    first = second = error_bar(0, {}, law());
  } else if (c.type == solve::generalised_flip || c.type == generalised_hopf) {
    // Along the curve another discretisation of the coefficient has told; what is left is how the curve itself moves.
    const auto along = pieces_->numbers(name, [&] { return direction_at(point); });
    const Eigen::Vector2d t = along.empty() ? Eigen::Vector2d(unknown, unknown) : Eigen::Vector2d(along[0], along[1]);
    const Bar bar = bar_beside(name, point, t);
    const auto share = [&](double part) {
      return Bar{part * bar.film_mesh, part * bar.time_mesh, part * bar.kinks, part * bar.location + location};
    };
    first = share(std::abs(t(1)));
    second = share(std::abs(t(0)));
  } else {
    const auto find = [&](const OtherMesh& mesh) {
      return pieces_->numbers(fmt::format("{} mesh {} {:.3f}", name, static_cast<int>(mesh.axis), mesh.spacing),
                              [&] { return zero_on(mesh, point, c.type); });
    };
    // The same way on the mesh of the curve, so that only meshes differ.
    std::vector<double> here = find({});
    if (here.empty()) here = {unknown, unknown};
    Bars bars(here, law());
    for (const OtherMesh& mesh : meshes()) bars.add(mesh.axis, mesh.spacing, find(mesh));
    const auto with_location = [&](std::size_t k) {
      Bar bar = bars[k];
      bar.location = std::abs(here[k] - reported(static_cast<Eigen::Index>(k))) + tolerance_at(reported);
      return bar;
    };
    first = with_location(0);
    second = with_location(1);
    second.location = std::max(second.location, location);
  }
  const double first_unit = first_scale_ / deck::number_to_si(1, first_range_.unit),
               second_unit = second_scale_ / deck::number_to_si(1, options_.second.range.unit);
  c.more["value_uncertainty"] = first.total() * first_unit;
  c.uncertainty = second.total() * second_unit;
  for (const auto& [part, value] : second.parts(curve_.cycles != nullptr))
    c.more["second_value_" + part] = value * second_unit;
}

namespace {

// Direction of the curve at each of its points, by the chord between its neighbours: unit length, scaled.
std::vector<Eigen::Vector2d> directions_of(const std::vector<Eigen::Vector2d>& places) {
  std::vector<Eigen::Vector2d> out;
  for (std::size_t k = 0; k < places.size(); ++k)
    out.push_back((places[std::min(k + 1, places.size() - 1)] - places[k > 0 ? k - 1 : 0]).normalized());
  return out;
}

}  // namespace

std::vector<RowBar> LocusFollower::bars_of(const std::vector<Row>& rows, std::size_t start) {
  std::vector<Eigen::Vector2d> places;
  for (const Row& row : rows) places.emplace_back(row.first / first_scale_, row.second / second_scale_);
  const std::vector<Eigen::Vector2d> along = directions_of(places);
  std::vector<RowBar> out(rows.size());
  if (rows.size() < 2) return out;
  std::vector<double> length(rows.size(), 0.0);
  for (std::size_t k = 1; k < rows.size(); ++k) length[k] = length[k - 1] + (places[k] - places[k - 1]).norm();

  std::vector<CurvePoint> points;
  const auto take = [&](const SpreadPoints& way, bool backwards) {
    for (CurvePoint& p : way.all()) {
      p.row = backwards ? start - p.row : start + p.row;
      p.arclength = length[p.row];
      points.push_back(std::move(p));
    }
  };
  take(done_spread_, false);
  take(spread_, true);
  std::sort(points.begin(), points.end(), [](const auto& a, const auto& b) { return a.row < b.row; });
  double cost = 0;
  for (const OtherMesh& mesh : meshes()) cost += approach / mesh.spacing;
  const double affordable = cost > 0 ? static_cast<double>(rows.size()) / cost : most_bars;
  points = evenly_spread(std::move(points),
                         static_cast<std::size_t>(std::clamp(affordable, double{fewest_bars}, double{most_bars})));

  std::size_t before = rows.size();
  for (const CurvePoint& p : points) {
    RowBar& bar = out[p.row];
    bar.normal = bar_beside(fmt::format("curve bar {}", p.row), p, along[p.row]).total();
    bar.computed = true;
    context_.results.progress(fmt::format("{}: bar of point {} of {}, {:.1f} s", context_.results.summary().name,
                                          p.row + 1, rows.size(), context_.results.seconds()));
    for (std::size_t k = before + 1; k < p.row; ++k) {
      const double part = (length[k] - length[before]) / (length[p.row] - length[before]);
      out[k].normal = (1 - part) * out[before].normal + part * bar.normal;
    }
    before = p.row;
  }
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const auto alone = [&](double share, double scale) {
      return std::abs(share) < least_share ? unknown : out[k].normal / std::abs(share) * scale;
    };
    out[k].first = alone(along[k](1), first_scale_);
    out[k].second = alone(along[k](0), second_scale_);
  }
  return out;
}

}  // namespace whirl::study
