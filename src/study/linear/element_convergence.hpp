#pragma once
// Whirl frequencies of a machine over the number of elements of its shaft, and how well its matrices are conditioned.

#include <vector>

#include "whirl/study/study.hpp"

namespace whirl::study {

struct ElementConvergenceOptions {
  std::string name;
  deck::Quantity speed;                                                   ///< [rad/s]
  std::vector<int> parts{1, 2, 4};                                        ///< into which every segment is cut
  std::vector<rotor::BeamElement> elements{rotor::BeamElement::rayleigh,  ///< side by side
                                           rotor::BeamElement::timoshenko_linear};
  int count = 10;         ///< modes, those of lowest frequency
  bool condition = true;  ///< condition numbers of the matrices
};
void describe(deck::Description<ElementConvergenceOptions>& d);

class ElementConvergence final : public StudyWith<ElementConvergenceOptions, "element_convergence"> {
public:
  void validate(const system::Machine& machine, const deck::Report& report) const override;
  [[nodiscard]] double memory(const system::Machine& machine, const LayoutOptions& layout) const override;
  [[nodiscard]] StudyResult run(Context& context) override;
  [[nodiscard]] io::Brief brief(const StudyResult& result, std::span<const io::StudySummary> before) const override;
};

}  // namespace whirl::study
