#pragma once
// What is kept of a motion, how it is judged, and how it goes into results and checkpoints.

#include <string>
#include <vector>

#include "study/motion/motion.hpp"
#include "study/motion/section.hpp"
#include "whirl/io/record.hpp"
#include "whirl/io/summary.hpp"
#include "whirl/system/plant.hpp"
#include "whirl/transient/analysis/classify.hpp"
#include "whirl/transient/analysis/exponents.hpp"

namespace whirl::study {

/// Samples of what is shown (journals) and growth of deviations, replicated on all ranks; of states at the end of each
/// revolution the entries of this rank. What reads them is collective on the ranks of the states.
class MotionRecord {
public:
  /// States are laid out as `like`, which outlives this.
  /// `forced`: by an unbalance, or the system by itself. `driven`: by external forces that change meanwhile.
  MotionRecord(const MotionOptions& options, system::ShownPlaces places, bool forced, Vec like, bool driven = false);

  /// A sample at a state; `scaled` is it over its scales. Not collective.
  void sample(const std::vector<system::PlaceState>& shown, Vec scaled);
  /// The last sample closes a revolution; `growth` of the deviations over it, empty if none were carried. Samples of a
  /// revolution that is never closed, because it ended in contact, count for nothing.
  void close(const std::vector<double>& growth, double duration);
  /// A crossing of the section, `time` [s] since the present revolution began. Not collective.
  void cross(double time, const std::vector<system::PlaceState>& shown, Vec scaled);
  /// What the section is, in words.
  void set_section(std::string text) { section_text_ = std::move(text); }
  /// What grows about the place where the motion rests, or about the equilibrium, in words; empty: nothing.
  void set_growth(std::string words) { grows_ = std::move(words); }
  /// Calls back with place, x and y of every sample.
  template <class See>
  void for_samples(const See& see) const {
    for (std::size_t k = 0; k < samples_.size(); k += 2)
      see(k / 2 % places_.names.size(), samples_[k], samples_[k + 1]);
  }
  [[nodiscard]] int revolutions() const { return static_cast<int>(points_.size()); }

  /// The verdict so far. Collective.
  [[nodiscard]] transient::Verdict verdict() const;
  /// Tables into `group`, numbers and verdict into the summary. Collective.
  void write(io::Group& group, io::StudySummary& summary) const;

  /// Where all ranks share one machine (Layout::shared) they share the states in `group`. Collective.
  void save(io::Group& group, bool shared) const;
  void load(const io::Group& group);

private:
  [[nodiscard]] transient::Evidence evidence() const;
  [[nodiscard]] std::vector<double> signal(std::size_t bearing, std::size_t direction) const;
  void write_orbit(io::Group& group) const;
  void write_points(io::Group& group) const;
  void write_spectrum(io::Group& group, io::StudySummary& summary) const;
  void write_full_spectrum(io::Group& group, transient::Window window) const;
  void write_exponents(io::Group& group, io::StudySummary& summary) const;
  void write_section(io::Group& group, io::StudySummary& summary, const transient::Verdict& verdict) const;
  void write_rotation(io::Group& group, io::StudySummary& summary, const transient::Verdict& verdict) const;
  void write_short_time(io::Group& group) const;
  [[nodiscard]] std::vector<std::array<double, 2>> returning_points(std::size_t place) const;
  [[nodiscard]] std::array<double, 2> whirl_tone(std::size_t place, double rotation, double interval) const;

  const MotionOptions& options_;
  bool forced_, driven_;
  system::ShownPlaces places_;
  Vec like_;
  double period_;                // of a revolution [s]
  std::vector<double> samples_;  // [sample][place][x, y]
  std::vector<double> ends_;     // [revolution][place][x, y, vx, vy]
  std::vector<double> last_;     // the same of the last sample
  // Sums of distances: those of states that hardly move would leave rounding of the states themselves.
  std::vector<double> origin_;  // the first scaled state; empty: none yet
  std::vector<double> sum_;     // of the scaled states of all samples, less the origin
  double squares_ = 0;          // of their norms; what of them stands here
  struct Open {
    std::vector<double> samples, sum;
    double squares = 0;
  };
  Open open_;                                // the same of the revolution that is not closed yet
  std::vector<double> last_state_;           // the last scaled state
  std::vector<std::vector<double>> points_;  // scaled states at the ends of revolutions
  transient::Exponents exponents_;
  SectionRecord section_;
  std::string section_text_;  // empty: there is none
  std::string grows_;
};

}  // namespace whirl::study
