#pragma once
// Descriptions of options: one line per option drives reading, units, errors, the resolved deck, reference and schema.
//
//   struct Geometry { GeometryType type = GeometryType::partial_arc; double clearance = 0; ... };
//
//   void describe(deck::Description<Geometry>& d) {      // in the namespace of Geometry, found by its type
//     d.add("type", &Geometry::type, "shape of the bore");
//     d.add("clearance", &Geometry::clearance, "m", positive, "radial clearance", "004 table 2.2").required();
//     d.add("preload", &Geometry::preload, in(0, 1), "1 - c_b/c_p").only(&Geometry::type, {GeometryType::lemon_bore});
//     d.check([](const Geometry& g, const deck::Report& r) { if (...) r.fail("preload", "..."); });
//   }
//
// The defaults are those of a default-constructed struct.

#include <functional>
#include <initializer_list>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <typeinfo>
#include <utility>
#include <variant>
#include <vector>

#include "whirl/core/error.hpp"
#include "whirl/deck/node.hpp"
#include "whirl/deck/units.hpp"

namespace whirl::deck {

class Files;
class Structure;

/// Bounds of a number (SI); `open` ends are excluded.
struct Check {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool min_open = false;
  bool max_open = false;
  [[nodiscard]] bool holds(double value) const;
  /// "positive", "at least 0", "between 0 and 1"; empty if there are no bounds.
  [[nodiscard]] std::string text() const;
};
inline const Check any{};
inline const Check positive{.min = 0, .min_open = true};
inline const Check non_negative{.min = 0};
[[nodiscard]] inline Check at_least(double a) {
  return {.min = a};
}
/// a <= value <= b
[[nodiscard]] inline Check in(double a, double b) {
  return {.min = a, .max = b};
}
/// a < value < b
[[nodiscard]] inline Check between(double a, double b) {
  return {.min = a, .max = b, .min_open = true, .max_open = true};
}

/// One row of the string table of an enum. The table is `std::span<const deck::Name<E>> names(E)` in the namespace of
/// the enum; E's type finds it.
template <class E>
struct Name {
  E value;
  std::string_view name;
  std::string_view text;  ///< what the choice means
};

/// Facts about a leaf value.
struct Spec {
  std::string unit = "1";
  Check check;
  std::string letter{};  ///< stands before the number, which then has no unit: "G" of a balance grade G2.5
};

/// What reading needs beside the tree: where tables come from, where problems go.
struct Reading {
  const Files& files;
  Problems& problems;
};

/// A real option found by its path, for studies that vary it.
struct Access {
  double* value = nullptr;  ///< SI
  std::string unit;         ///< coherent SI unit
  bool continuable = false;
  Check check;
};

/// How values of one C++ type are read, written and described; `value` points at an object of that type.
class Codec {
public:
  Codec() = default;
  Codec(const Codec&) = delete;
  Codec& operator=(const Codec&) = delete;
  virtual ~Codec() = default;
  /// Reads `node` into `value`; problems are added, not thrown.
  virtual void read(const Node& node, void* value, Reading& reading) const = 0;
  /// The value in SI; a node of kind none is left out of the deck.
  [[nodiscard]] virtual Node write(const void* value) const = 0;
  /// JSON Schema of the value, as a tree; of a part of it (nothing is required) unless `whole`.
  [[nodiscard]] virtual Node schema(bool whole) const = 0;
  /// The value in words for the reference: "length in m", "one of a, b".
  [[nodiscard]] virtual std::string type() const = 0;
  /// Facts of the number that it reads, or of the numbers of a list or a range; null for all else.
  [[nodiscard]] virtual const Spec* spec() const { return nullptr; }
  /// Options below this one, null for leaves, and how a path gets to them (`NAME`, `1`), empty for structs.
  [[nodiscard]] virtual const Structure* structure() const { return nullptr; }
  [[nodiscard]] virtual std::string step() const { return {}; }
  /// Kinds of a choice list with their options, empty for all else.
  [[nodiscard]] virtual std::vector<std::pair<std::string, const Structure*>> kinds() const { return {}; }
  /// The real number at the rest of a path below `value`; value pointer null if there is none.
  [[nodiscard]] virtual Access find(void* value, std::span<const std::string> path) const;
};

/// The codec of a list of 2 or 4 numbers that takes a single one as well.
[[nodiscard]] std::shared_ptr<const Codec> isotropic_codec(const std::shared_ptr<const Codec>& list);

/// The codec of type T; specialised for every supported type.
template <class T, class = void>
struct CodecOf;

/// Another word that users write for an option: its value times `factor` is the option's (a diameter is two radii).
struct Alias {
  std::string key;
  double factor = 1;
};

/// One described option.
struct Option {
  std::string key;
  std::string text;
  std::string source;
  std::shared_ptr<const Codec> codec;     ///< shared with the structures that embed this one
  std::function<void*(void*)> member;     ///< address in its struct, null if that holds a kind without this option
  const std::type_info* value = nullptr;  ///< its type
  const void* preset = nullptr;           ///< the value if the deck is silent; lives as long as the structure
  bool required = false;
  bool continuable = false;
  std::string selector{};               ///< key of the option that decides whether this one applies, empty if always
  std::vector<std::string> selected{};  ///< values of the selector for which it applies
  std::vector<Alias> aliases{};
};

/// The options of one struct; type-erased. Several options may have the same key if the same selector tells them apart,
/// each for values of its own: a kind has its own `cells`.
class Structure {
public:
  using Checker = std::function<void(const void*, const Report&)>;

  std::vector<Option> options;
  std::vector<Checker> checks;
  std::shared_ptr<void> defaults;  ///< a default-constructed object

  void read(const Node& node, void* object, Reading& reading) const;
  [[nodiscard]] Node write(const void* object) const;
  [[nodiscard]] Node schema(bool whole) const;
  [[nodiscard]] Access find(void* object, std::span<const std::string> path) const;
  /// The first option with that key, null if there is none.
  [[nodiscard]] const Option* option(std::string_view key) const;
  /// The one of them that applies to `object`, else the first.
  [[nodiscard]] const Option* option_of(std::string_view key, const void* object) const;
  /// The option that `key` is another word for, null if none; `factor` gets its factor.
  [[nodiscard]] const Option* aliased(std::string_view key, double& factor) const;
  [[nodiscard]] std::vector<std::string> keys() const;
  /// True if `o` applies to `object` (its selector has one of the values asked for).
  [[nodiscard]] bool applies(const Option& o, const void* object) const;
};

/// The options of S, built once by S's describe().
template <class S>
const Structure& structure_of();

/// A kind of a choice list (`- static: {...}`): its name, what it is, its options and how an object of it is made.
template <class Base>
struct Kind {
  std::string name;
  std::string text;
  const Structure* options;
  std::function<std::unique_ptr<Base>()> make;
  std::function<void*(Base&)> object;  ///< address of the options struct inside an object of this kind
};

/// Collects the description of S; the argument of describe().
template <class S>
class Description {
public:
  explicit Description(Structure& s) : s_(s) {}

  /// The line of one option, for what only some options need.
  class Line {
  public:
    Line(Structure& s, std::size_t i) : s_(s), i_(i) {}
    /// The deck must give it.
    const Line& required() const {
      s_.options[i_].required = true;
      return *this;
    }
    /// Studies may vary it.
    const Line& continuable() const {
      s_.options[i_].continuable = true;
      return *this;
    }
    /// `key` is accepted for it as well; a number given there is `factor` times the option's.
    const Line& alias(std::string key, double factor = 1) const {
      s_.options[i_].aliases.push_back({std::move(key), factor});
      return *this;
    }
    /// One value is accepted for a list of fixed length: for both of a pair, for the diagonal xx, yy of xx, xy, yx, yy.
    const Line& isotropic() const {
      s_.options[i_].codec = isotropic_codec(s_.options[i_].codec);
      return *this;
    }
    /// Applies only where the choice `selector` (described before) has one of `values`.
    template <class E>
    const Line& only(E S::*selector, std::initializer_list<E> values) const;

  private:
    Structure& s_;
    std::size_t i_;
  };

  /// A number with a unit, or a container of such: coherent SI unit ("1" is dimensionless), bounds, text, source.
  template <class T>
  Line add(std::string key, T S::*member, std::string unit, const Check& check, std::string text,
           std::string source = {}) {
    return push(std::move(key), member, CodecOf<T>::make({std::move(unit), check}), std::move(text), std::move(source));
  }
  /// A dimensionless number with bounds.
  template <class T>
  Line add(std::string key, T S::*member, const Check& check, std::string text, std::string source = {}) {
    return push(std::move(key), member, CodecOf<T>::make({"1", check}), std::move(text), std::move(source));
  }
  /// Anything else: text, flags, choices, structs, lists and maps of them.
  template <class T>
  Line add(std::string key, T S::*member, std::string text, std::string source = {}) {
    return push(std::move(key), member, CodecOf<T>::make({}), std::move(text), std::move(source));
  }
  /// A table: a CSV file whose header cells are `key [unit]`, or a list of maps with the same keys.
  template <class R>
  Line table(std::string key, std::vector<R> S::*member, std::string text, std::string source = {});
  /// A table of which a single quantity is a short form: one row with only `scalar` set.
  /// `row` describes the rows.
  template <class R, class Row>
  Line table_or_scalar(std::string key, std::vector<R> S::*member, std::string scalar, const Row& row, std::string text,
                       std::string source = {});
  /// A map NAME -> struct kept in the order of the deck; the name goes into `name`.
  template <class R>
  Line named(std::string key, std::vector<R> S::*member, std::string R::*name, std::string text,
             std::string source = {});
  /// A list of single-key maps, the key choosing the kind.
  template <class B>
  Line choices(std::string key, std::vector<std::unique_ptr<B>> S::*member, const std::vector<Kind<B>>& kinds,
               std::string text, std::string source = {});
  /// One of several described structs, as a variant whose alternatives K name themselves by `K::key` and `K::text`. The
  /// option `key` of the deck chooses; the options of all stand beside it, each where its kind is chosen. The kind that
  /// a default-constructed S holds is the default.
  template <class... K>
  Line kinds(std::string key, std::variant<K...> S::*member, std::string text, std::string source = {});
  /// Takes over all options of a member struct as if they were described here.
  template <class T>
  void embed(T S::*member);
  /// The same for a base of S.
  template <class B>
  void inherit();
  /// A condition on several options; runs when all of them could be read.
  void check(std::function<void(const S&, const Report&)> f) {
    s_.checks.push_back(
        [f = std::move(f)](const void* object, const Report& r) { f(*static_cast<const S*>(object), r); });
  }

private:
  template <class T>
  Line push(std::string key, T S::*member, std::shared_ptr<const Codec> codec, std::string text, std::string source) {
    s_.options.push_back({std::move(key), std::move(text), std::move(source), std::move(codec),
                          [member](void* s) -> void* { return &(static_cast<S*>(s)->*member); }, &typeid(T),
                          &(static_cast<const S*>(s_.defaults.get())->*member)});
    return Line(s_, s_.options.size() - 1);
  }
  void take_over(const Structure& inner, const std::function<void*(void*)>& part);
  Structure& s_;
};

/// The option of `object` at `path` (`bearings.B2.geometry.clearance`, list items 1-based).
/// Throws core::InputError (without a place) with the nearest key if there is none or if it is not a real number.
template <class S>
[[nodiscard]] Access find_option(S& object, std::string_view path);

/// The options of `node` as an S with all problems added to `problems`; call `problems.raise()` before using it.
template <class S>
[[nodiscard]] S read(const Node& node, const Files& files, Problems& problems);

/// `object` as a deck: SI, every default written out.
template <class S>
[[nodiscard]] Node write(const S& object);

}  // namespace whirl::deck

#include "whirl/deck/codecs.hpp"
