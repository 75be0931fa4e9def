#include "study/motion/short_time.hpp"

#include <array>
#include <cmath>
#include <complex>

namespace whirl::study {
namespace {

constexpr std::array<const char*, 2> axes{"x", "y"};

std::vector<double> signal(const AngleRecord& r, std::size_t place, std::size_t axis) {
  std::vector<double> out;
  for (std::size_t k = 2 * place + axis; k < r.samples.size(); k += 2 * r.names.size()) out.push_back(r.samples[k]);
  return out;
}

// Where the pieces stand.
void put_middles(io::Group& g, const AngleRecord& r, const transient::RecordPieces& pieces) {
  std::vector<double> revolution, speed, time;
  for (int k = 0; k < transient::count(pieces, r.revolutions()); ++k) {
    revolution.push_back(transient::middle(pieces, k));
    speed.push_back(r.speed(revolution.back()));
    time.push_back(r.time(revolution.back()));
  }
  g.put("revolution", revolution, "1", "in the middle of each piece, since the record began");
  g.put("speed", speed, r.speed_unit, "of the shaft there");
  g.put("time", time, "s", "there, since the record began");
  g.put("place", r.names, "what x and y are of");
}

}  // namespace

int AngleRecord::revolutions() const {
  return static_cast<int>(samples.size() / (2 * names.size())) / per_revolution;
}

void write_orders(io::Group& group, const AngleRecord& r, const OrderOptions& o) {
  const transient::RecordPieces pieces{o.revolutions, o.advance, o.window};
  const auto n = static_cast<std::size_t>(transient::count(pieces, r.revolutions()));
  if (n == 0) return;
  auto& g = group.child("orders");
  put_middles(g, r, pieces);
  g.put("order", o.track, "1", "frequency per speed of the shaft");
  const std::size_t orders = o.track.size(), places = r.names.size();
  for (std::size_t axis = 0; axis < 2; ++axis) {
    std::vector<double> amplitude(n * orders * places), phase(amplitude.size());
    for (std::size_t p = 0; p < places; ++p) {
      const std::vector<double> s = signal(r, p, axis);
      for (std::size_t j = 0; j < orders; ++j) {
        const auto track = transient::order_track({s, r.per_revolution}, o.track[j], pieces);
        for (std::size_t k = 0; k < n; ++k) {
          amplitude[(k * orders + j) * places + p] = std::abs(track[k]);
          phase[(k * orders + j) * places + p] = std::arg(track[k]);
        }
      }
    }
    const std::string name = axes[axis];
    g.put(name + "_amplitude", {n, orders, places}, amplitude, r.unit, "of " + name + ", 0-peak [piece][order][place]");
    g.put(name + "_phase", {n, orders, places}, phase, "rad",
          "of " + name + ", ahead of the order times the shaft angle [piece][order][place]");
  }
  g.label_each({io::labels_of(o.track, "order"), r.names});
}

void write_waterfall(io::Group& group, const AngleRecord& r, const WaterfallOptions& o) {
  const transient::RecordPieces pieces{o.revolutions, o.advance, o.window};
  const auto n = static_cast<std::size_t>(transient::count(pieces, r.revolutions()));
  if (n == 0) return;
  auto& g = group.child("waterfall");
  put_middles(g, r, pieces);
  const std::size_t places = r.names.size();
  std::size_t lines = 0;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    std::vector<double> amplitude;
    for (std::size_t p = 0; p < places; ++p) {
      const std::vector<double> s = signal(r, p, axis);
      const auto spectra = transient::waterfall({s, r.per_revolution}, o.highest, pieces);
      lines = spectra.front().size();
      amplitude.resize(n * lines * places);
      for (std::size_t k = 0; k < n; ++k)
        for (std::size_t l = 0; l < lines; ++l) amplitude[(k * lines + l) * places + p] = spectra[k][l];
    }
    g.put(axes[axis], {n, lines, places}, std::move(amplitude), r.unit,
          std::string("amplitude 0-peak of ") + axes[axis] + " [piece][line][place]; the first line is the mean");
  }
  std::vector<double> order;
  for (std::size_t l = 0; l < lines; ++l) order.push_back(static_cast<double>(l) / o.revolutions);
  g.put("order", order, "1", "of the lines: frequency per speed of the shaft");
  g.label_each({io::labels_of(order, "order"), r.names});
}

}  // namespace whirl::study
