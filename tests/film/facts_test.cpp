// What others may ask of a film without knowing its kind.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <set>

#include "film/cases.hpp"
#include "whirl/core/error.hpp"
#include "whirl/deck/load.hpp"
#include "whirl/deck/output.hpp"
#include "whirl/film/contract/describe.hpp"
#include "whirl/film/contract/film.hpp"

namespace whirl::film::testing {
namespace {

TEST(Facts, SmoothnessOfEveryFilm) {
  const auto smoothness = [](const Options& o) { return facts(o).smoothness; };
  Reynolds o;
  EXPECT_EQ(smoothness(o).derivatives, 1);
  EXPECT_FALSE(smoothness(o).smooth());
  EXPECT_FALSE(smoothness(o).reason.empty());
  o.cavitation = Reynolds::Cavitation::none;
  EXPECT_TRUE(smoothness(o).smooth());
  o.cavitation = Reynolds::Cavitation::mass_conserving;
  EXPECT_EQ(smoothness(o).derivatives, 0);
  EXPECT_TRUE(smoothness(Short{}).smooth());
  CompliantShort liner;
  EXPECT_EQ(smoothness(liner).derivatives, 1);
  liner.quadrature = Compliant::Quadrature::simpson;
  EXPECT_EQ(smoothness(liner).derivatives, 0);
}

TEST(Facts, TiltingFilms) {
  for (const Options& o : {Options(Reynolds{}), Options(Gas{})}) {
    ASSERT_FALSE(facts(o).tilts);
    const std::optional<Options> tilted = tilting(o);
    ASSERT_TRUE(tilted);
    EXPECT_TRUE(facts(*tilted).tilts);
    EXPECT_TRUE(same_kind(*tilted, o));
  }
  EXPECT_FALSE(tilting(Short{}));
  EXPECT_FALSE(tilting(CompliantShort{}));
}

TEST(Facts, OfEveryKind) {
  const Facts linear = facts(Linear{}), closed = facts(LongInlet{}), reynolds = facts(Reynolds{});
  EXPECT_TRUE(linear.coefficients);
  EXPECT_FALSE(closed.coefficients || closed.gives_way || closed.own_states);
  EXPECT_EQ(closed.cells, (std::array{0, 0}));
  EXPECT_EQ(closed.circle_only.option, "type");
  EXPECT_EQ(reynolds.cells, (std::array{60, 16}));
  EXPECT_TRUE(reynolds.circle_only.option.empty());
  EXPECT_FALSE(reynolds.own_states || reynolds.gives_way || reynolds.tilts);

  Reynolds special;
  special.tilt = true;
  special.grooves = {{0.0, 0.0}};
  EXPECT_TRUE(facts(special).tilts);
  EXPECT_EQ(facts(special).circle_only.option, "grooves");
  special.grooves.clear();
  special.inlet.type = Inlet::Type::line;
  EXPECT_EQ(facts(special).circle_only.option, "inlet");
  special.cavitation = Reynolds::Cavitation::mass_conserving;
  EXPECT_FALSE(facts(special).own_states);
  special.states = Reynolds::States::dynamic;
  EXPECT_TRUE(facts(special).own_states);
  EXPECT_EQ(facts(special, arc()).states, 60 * 16);
  EXPECT_EQ(facts(special, lemon()).states, 2 * 60 * 16);

  CompliantFinite finite;
  finite.cells = {20, 8};
  finite.liner_damping = 1e-3;
  finite.contact = Contact{1e-6, 1e8};
  finite.differences = Compliant::Differences::upwind;
  const Facts soft = facts(finite);
  EXPECT_TRUE(soft.gives_way && soft.own_states && soft.force_by_rates && soft.asperities);
  EXPECT_EQ(soft.mesh_order, 1);
  EXPECT_EQ(soft.states, 160);
  EXPECT_EQ(soft.cells, (std::array{20, 8}));
  const Facts around = facts(CompliantLong{});
  EXPECT_EQ(around.cells, (std::array{60, 0}));
  EXPECT_EQ(around.states, 60);
  EXPECT_FALSE(around.force_by_rates || around.asperities);
  EXPECT_EQ(around.mesh_order, 1);  // the default has no waves of the mesh
  finite.differences = Compliant::Differences::central;
  EXPECT_EQ(facts(finite).mesh_order, 2);
}

// The film that the deck calls `key`, complete or not.
Options called(std::string_view key) {
  deck::Problems problems;
  return deck::read<Options>(deck::parse_yaml(fmt::format("type: {}", key), "d.yaml"), deck::Files(MPI_COMM_SELF),
                             problems);
}

template <class... K>
void expect_registered(const std::variant<K...>* /*list*/) {
  EXPECT_EQ((std::set<std::string_view>{K::key...}.size()), sizeof...(K)) << "two kinds have one name";
  for (const std::string_view text : {K::text...}) EXPECT_GE(text.size(), 8U);
  const auto one = [](const Options& kind, std::string_view key, const deck::Structure& options) {
    EXPECT_TRUE(same_kind(called(key), kind)) << key;
    EXPECT_TRUE(deck::undocumented(options).empty()) << key;
    const Facts f = facts(kind);
    EXPECT_EQ(f.own_states, f.states > 0) << key;
    EXPECT_EQ(f.cells[0] > 0, facts(refined(kind, {2, 2})).cells[0] > f.cells[0]) << key;
  };
  (one(K{}, K::key, deck::structure_of<K>()), ...);
}

TEST(Facts, EveryKindOfTheListIsOneOfTheDeck) {
  expect_registered(static_cast<const Kinds*>(nullptr));
  EXPECT_TRUE(same_kind(Options(), Reynolds{})) << "where the deck chooses none";
}

TEST(Facts, FinerAndCoarserFilms) {
  const auto cells = [](const Options& o, double a, double b) { return facts(refined(o, {a, b})).cells; };
  EXPECT_EQ(cells(Reynolds{}, 0.5, 1), (std::array{30, 16}));
  EXPECT_EQ(cells(Reynolds{}, 0.75, 0.1), (std::array{45, 4}));
  CompliantFinite simpson;
  simpson.quadrature = Compliant::Quadrature::simpson;
  EXPECT_EQ(cells(simpson, 0.75, 2), (std::array{46, 32})) << "an even number for Simpson's rule";
  EXPECT_EQ(cells(simpson, 1, 1), (std::array{60, 16}));
  EXPECT_EQ(cells(Short{}, 2, 2), (std::array{0, 0}));
}

TEST(Facts, OptionsAreThoseOfTheirKind) {
  Options o = CompliantLong{};
  EXPECT_TRUE(same_kind(o, CompliantLong{}));
  EXPECT_FALSE(same_kind(o, CompliantShort{}));
  as<Compliant>(o).compliance = 0.25;
  EXPECT_EQ(find<CompliantLong>(o)->compliance, 0.25);
  EXPECT_EQ(find<CompliantShort>(o), nullptr);
  EXPECT_THROW((void)as<Reynolds>(o), core::Bug);
  EXPECT_NE(find<Reynolds>(Options()), nullptr) << "the default";
}

}  // namespace
}  // namespace whirl::film::testing
