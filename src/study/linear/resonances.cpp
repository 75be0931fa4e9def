#include "study/linear/resonances.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "study/bars/unresolved.hpp"
#include "study/linear/dip.hpp"
#include "study/linear/response_peaks.hpp"

namespace whirl::study {
namespace {

using Complex = std::complex<double>;

constexpr double near_enough = 1.5;   // widths: a resonance between two speeds is seen with 0.8 of its height
constexpr double located_part = 0.1;  // of the width
constexpr double top_within = 2;      // widths from a resonance to its peak
constexpr int most_looks = 4;         // at a modulus between three speeds
constexpr double meets_within = 2;    // widths from the modulus to the speed

double width_of(Complex lambda, double speed, double least) {
  return std::max(std::abs(lambda.real()), least * speed);
}

bool is_undamped(Complex lambda, const ResonanceSearch& search) {
  return search.lossless && std::abs(lambda.real()) < no_damping * std::abs(lambda);
}

// A real eigenvalue does not vibrate, whether it falls away or grows.
bool has_peak(Complex lambda) {
  return std::abs(lambda.real()) < no_peak * std::abs(lambda);
}

// The eigenvalue of one rank by modulus at two neighbouring speeds, on either side of them.
struct Bracket {
  double a, b;  // speeds
  Complex at_a, at_b;
  double f_a, f_b;  // modulus less the speed
  double w_a, w_b;  // widths
  [[nodiscard]] bool left() const { return std::abs(f_a) <= std::abs(f_b); }
  [[nodiscard]] double secant() const { return a + f_a / (f_a - f_b) * (b - a); }
  [[nodiscard]] double width() const { return left() ? w_a : w_b; }
  [[nodiscard]] bool located() const {
    return std::min({std::abs(f_a), std::abs(f_b), b - a}) <= located_part * width();
  }
  // Not so where the spectrum jumps, as one does that lacks eigenvalues: there the bracket has a change of sign alone.
  [[nodiscard]] bool meets() const { return std::min(std::abs(f_a), std::abs(f_b)) <= meets_within * width(); }
};

std::size_t below(const std::vector<Complex>& by_modulus, double speed) {
  return static_cast<std::size_t>(std::ranges::count_if(by_modulus, [&](Complex v) { return std::abs(v) < speed; }));
}

// All of them that vibrate at one of their ends, each pair once.
std::vector<Bracket> brackets_of(const Spectra& spectra, const ResonanceSearch& search) {
  std::vector<Bracket> out;
  for (auto low = spectra.begin(); low != spectra.end() && low->first < search.limit; ++low) {
    const auto high = std::next(low);
    if (high == spectra.end()) break;
    const auto &at_a = low->second, &at_b = high->second;
    const std::size_t n_a = below(at_a, low->first), n_b = below(at_b, high->first);
    for (std::size_t m = std::min(n_a, n_b); m < std::min({std::max(n_a, n_b), at_a.size(), at_b.size()}); ++m) {
      const Bracket x{low->first,
                      high->first,
                      at_a[m],
                      at_b[m],
                      std::abs(at_a[m]) - low->first,
                      std::abs(at_b[m]) - high->first,
                      width_of(at_a[m], low->first, search.least_width),
                      width_of(at_b[m], high->first, search.least_width)};
      const bool again = !out.empty() && out.back().a == x.a && out.back().f_a == x.f_a && out.back().f_b == x.f_b;
      if (!again && (has_peak(x.at_a) || has_peak(x.at_b))) out.push_back(x);
    }
  }
  return out;
}

// Whether the response shows what is enclosed.
bool seen(const Bracket& x, const std::vector<double>& computed, const std::vector<double>& tops) {
  const auto is_top = [&](double speed, double f, double width) {
    return std::abs(f) <= top_within * width && std::ranges::find(tops, speed) != tops.end();
  };
  if (is_top(x.a, x.f_a, x.w_a) || is_top(x.b, x.f_b, x.w_b)) return true;
  const double least = std::min(x.w_a, x.w_b);
  auto from = std::ranges::upper_bound(computed, x.a), to = std::ranges::lower_bound(computed, x.b);
  if (from == computed.begin() || to == computed.end()) return true;  // beyond what was computed
  for (--from; from != to; ++from)
    if (*std::next(from) - *from > near_enough * least) return false;
  return true;
}

// Whether the samples around another one of about the same width show this one too.
bool is_one_of(const std::vector<Resonance>& all, const Resonance& r) {
  constexpr double alike = 3;
  return std::ranges::any_of(all, [&](const Resonance& other) {
    const auto [least, widest] = std::minmax(r.width, other.width);
    return std::abs(r.speed - other.speed) < least && widest < alike * least;
  });
}

// Places between three neighbouring spectra at which f of a vibration may cross zero and return.
template <class F>
std::vector<double> dips_of(const Spectra& spectra, const ResonanceSearch& search, const F& f) {
  std::vector<double> out;
  if (spectra.size() < 3) return out;
  for (auto a = spectra.begin(), b = std::next(a), c = std::next(b); c != spectra.end() && b->first < search.limit;
       ++a, ++b, ++c)
    for (std::size_t m = 0; m < std::min({a->second.size(), b->second.size(), c->second.size()}); ++m) {
      if (!(b->second[m].imag() > 0) || !has_peak(b->second[m]) || std::abs(b->second[m]) > search.limit) continue;
      const auto dip = dip_of({a->first, b->first, c->first},
                              {f(a->second[m], a->first), f(b->second[m], b->first), f(c->second[m], c->first)});
      if (dip) out.push_back(*dip);
    }
  return out;
}

}  // namespace

ResonanceSearch search_of(const rotor::Options& rotor, std::size_t most) {
  ResonanceSearch out{resolved_to(rotor), most};
  out.lossless = rotor.loss_factor == 0;
  out.least_width = std::max(out.least_width, 0.1 * rotor.loss_factor / 2);
  return out;
}

bool shows(const std::vector<double>& computed, double at, double width) {
  const auto next = std::ranges::lower_bound(computed, at);
  if (next == computed.begin() || next == computed.end()) return true;
  return *next - *std::prev(next) <= near_enough * width;
}

std::vector<Resonance> narrow_resonances(const std::vector<Complex>& eigenvalues, const std::vector<double>& computed,
                                         const ResonanceSearch& search) {
  std::vector<Resonance> out;
  for (const Complex v : eigenvalues) {
    const double at = std::abs(v), width = width_of(v, at, search.least_width);
    if (v.imag() > 0 && has_peak(v) && at < search.limit && !shows(computed, at, width) && !is_one_of(out, {at, width}))
      out.push_back({at, width, is_undamped(v, search)});
  }
  std::ranges::sort(out, {}, &Resonance::speed);
  return out;
}

std::vector<Resonance> undamped_resonances(const std::vector<Complex>& eigenvalues, double from, double to,
                                           const ResonanceSearch& search) {
  std::vector<Resonance> out;
  for (const Complex v : eigenvalues) {
    const double at = std::abs(v);
    const bool inside = from <= at && at <= to && at < search.limit;
    if (inside && v.imag() > 0 && is_undamped(v, search)) out.push_back({at, search.least_width * at, true});
  }
  std::ranges::sort(out, {}, &Resonance::speed);
  const auto same = [](const Resonance& a, const Resonance& b) { return b.speed - a.speed < least_step * b.speed; };
  out.erase(std::unique(out.begin(), out.end(), same), out.end());
  return out;
}

bool undamped_at(const Spectra& known, double speed, const ResonanceSearch& search) {
  constexpr double near = 2e-3;  // of the speed
  const auto apart = [&](double other) { return std::abs(other - speed); };
  const auto spectrum = std::ranges::min_element(known, {}, [&](const auto& s) { return apart(s.first); });
  if (spectrum == known.end() || apart(spectrum->first) > near * speed) return false;
  double least = near * speed;
  bool undamped = false;
  for (const Complex v : spectrum->second)
    if (v.imag() > 0 && apart(std::abs(v)) <= least) least = apart(std::abs(v)), undamped = is_undamped(v, search);
  return undamped;
}

bool resonance_near(const std::vector<Complex>& eigenvalues, double speed, double below, double above) {
  return std::ranges::any_of(eigenvalues, [&](Complex v) {
    const double apart = (std::abs(v) - speed) / speed;
    return v.imag() > 0 && has_peak(v) && apart >= -below && apart <= above;
  });
}

std::vector<double> where_growth_may_hide(const Spectra& known, const ResonanceSearch& search) {
  constexpr double rounding = 1e-8;
  return dips_of(known, search,
                 [](Complex v, double) { return std::abs(v.real()) > rounding * std::abs(v) ? v.real() : 0; });
}

std::vector<double> around(const Resonance& r) {
  return {r.speed - 1.1 * r.width, r.speed + 0.1 * r.width, r.speed + 1.2 * r.width};
}

HiddenResonances hidden_resonances(Spectra& known, const std::vector<double>& computed, const std::vector<double>& tops,
                                   const ResonanceSearch& search,
                                   const std::function<void(const std::vector<double>& speeds)>& more) {
  const auto sort = [&] {
    for (auto& [speed, values] : known)
      std::ranges::stable_sort(values, {}, [](Complex v) { return std::pair(std::abs(v), v.real()); });
  };
  sort();
  HiddenResonances out;
  std::size_t most = search.most;
  for (int pass = 0;; ++pass) {
    std::vector<double> ask;
    for (const Bracket& x : brackets_of(known, search)) {
      if (x.located() || seen(x, computed, tops)) continue;
      // Secants of a modulus that bends or jumps may move one end only: each third step halves what they leave.
      const bool halve = pass % 3 == 2;
      const double secant = x.secant();
      ask.push_back(halve || !(secant > x.a && secant < x.b) ? (x.a + x.b) / 2 : secant);
    }
    std::vector<double> speeds;
    for (const auto& [speed, values] : known) speeds.push_back(speed);
    // A few looks tell whether a modulus that nears the speed meets it.
    if (pass < most_looks && ask.size() < most)
      for (const double dip : dips_of(known, search, [](Complex v, double speed) { return std::abs(v) - speed; }))
        if (ask.size() < most) ask.push_back(dip);
    ask = worth_asking(std::move(ask), speeds);
    if (ask.empty()) break;
    if (ask.size() > most) {
      out.gave_up = true;
      break;
    }
    most -= ask.size();
    more(ask);
    sort();
  }
  for (const Bracket& x : brackets_of(known, search)) {
    if (seen(x, computed, tops)) continue;
    const Complex lambda = x.left() ? x.at_a : x.at_b;
    if (!has_peak(lambda)) continue;
    if (!x.located()) {
      out.gave_up = true;
      continue;
    }
    if (!x.meets()) continue;
    const double speed = std::clamp(x.secant(), x.a, x.b);
    if (speed >= search.limit || is_one_of(out.found, {speed, x.width()})) continue;
    out.found.push_back({speed, x.width(), is_undamped(lambda, search)});
  }
  std::ranges::sort(out.found, {}, &Resonance::speed);
  return out;
}

}  // namespace whirl::study
